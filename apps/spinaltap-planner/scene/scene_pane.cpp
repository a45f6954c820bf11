#include "apps/spinaltap-planner/scene/scene_pane.h"

#include <QPainter>
#include <utility>

namespace spinaltap {

ScenePane::ScenePane(QWidget* parent) : QWidget(parent) { setAttribute(Qt::WA_OpaquePaintEvent); }

void ScenePane::show_frame(QImage frame) {
  frame_ = std::move(frame);
  update();
}

void ScenePane::paintEvent(QPaintEvent* /*event*/) {
  QPainter painter(this);
  if (frame_.isNull()) {
    painter.fillRect(rect(), Qt::black);
  } else {
    painter.drawImage(rect(), frame_);
  }
}

}  // namespace spinaltap
