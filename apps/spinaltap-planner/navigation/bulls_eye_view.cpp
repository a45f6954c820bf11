#include "apps/spinaltap-planner/navigation/bulls_eye_view.h"

#include <QKeyEvent>
#include <QMouseEvent>
#include <QPainter>
#include <QWheelEvent>
#include <algorithm>
#include <array>
#include <cmath>

#include "apps/spinaltap-planner/colours.h"
#include "apps/spinaltap-planner/slices/haloed.h"
#include "apps/spinaltap-planner/slices/pane_marks.h"
#include "apps/spinaltap-planner/window/mouse_place.h"
#include "core/session/device/open_device.h"
#include "core/tool/path_curve.h"

namespace spinaltap {
namespace {

constexpr double kBullsEyeMm = 30.0;    // a pedicle, and the canal beside it
constexpr double kMmPerMousePx = 0.05;  // finer than the picture: a hand is steadier than a mouse
constexpr double kRadPerMousePx = 0.002;
constexpr double kMmPerNotch = 0.25;
constexpr double kKeysMmS = 2.0;
constexpr double kKeysRadS = 0.1;
constexpr double kFast = 4.0;

}  // namespace

BullsEyeView::BullsEyeView(PlanDocument& document, ViewState& state, QWidget* parent)
    : QWidget(parent), document_(document), state_(state) {
  setAccessibleName(tr("View down the bit"));
  setFocusPolicy(Qt::StrongFocus);
  setAttribute(Qt::WA_OpaquePaintEvent);
  setContextMenuPolicy(Qt::PreventContextMenu);  // the right button leans the tool over
  setSizePolicy(QSizePolicy::Expanding, QSizePolicy::Expanding);
  setWhatsThis(
      tr("The CT across the bit at its tip. Rings: distance from the bit's axis. Round: the plan's entry, square: its "
         "target, as seen along the bit; on the path both are in the middle.\n"
         "Keyboard and mouse as the hand: left drag moves, right drag leans over, wheel or W and S push and draw back, "
         "arrows move, A, D, Q and E lean over, Space: spindle, Escape: end."));
  connect(&state, &ViewState::window_changed, this, [this] { update(); });
}

void BullsEyeView::show_tool(const std::optional<NavigationFigures>& figures, const std::optional<DrillPath>& path) {
  const bool makes_sense =
      figures && path && figures->pose.tip_mm.allFinite() && std::abs(figures->pose.axis.norm() - 1.0) < 0.01;
  figures_ = makes_sense ? figures : std::nullopt;
  path_ = makes_sense ? path : std::nullopt;
  update();
}

void BullsEyeView::set_device(std::shared_ptr<DesktopDevice> device) {
  held_.clear();
  device_ = std::move(device);
}

std::optional<PanePlane> BullsEyeView::plane() const {
  if (!figures_) return std::nullopt;
  DrillPath along;
  along.entry_mm = figures_->pose.tip_mm;
  along.target_mm = along.entry_mm + 10.0 * figures_->pose.axis;
  return plane_down_path(along, 0.0);
}

SliceFrame BullsEyeView::frame(const PanePlane& plane) const {
  return pane_frame(plane, {Eigen::Vector2d::Zero(), mm_per_pixel()}, {width(), height(), devicePixelRatioF()});
}

double BullsEyeView::mm_per_pixel() const { return kBullsEyeMm / std::max(1, std::min(width(), height())); }

QPointF BullsEyeView::place_of(const Vec3& p_mm) const {
  const std::optional<PanePlane> shown = plane();
  if (!shown) return {0.5 * width(), 0.5 * height()};
  return place_in_pane(frame(*shown), devicePixelRatioF(), p_mm);
}

void BullsEyeView::paintEvent(QPaintEvent* /*event*/) {
  QPainter painter(this);
  const std::optional<PanePlane> shown = plane();
  if (!shown || !document_.opened() || document_.opened()->ct.hu.empty()) {
    paint_empty_pane(painter, size(), tr("Down the bit"), QColor(kDrillRgb),
                     tr("Choose who moves the tool, and press Start"));
    return;
  }
  const SliceFrame frame_now = frame(*shown);
  const std::vector<DrillPath> none;
  const PaneScene scene{frame_now, devicePixelRatioF(), figures_->pose.tip_mm, none, -1, {}, {}, no_walls_};
  painter.drawImage(QRectF(QPointF(0.0, 0.0), scene.size()), image_.of(document_.opened(), frame_now, state_.window()));
  painter.setRenderHint(QPainter::Antialiasing);
  LabelPlacer labels({Eigen::Vector2d::Zero(), Eigen::Vector2d(width(), height())});
  paint_pane_words(painter, scene, tr("Down the bit, at its tip"), QColor(kDrillRgb), state_.window(), labels);
  paint_marks(painter, frame_now);
  if (figures_->is_lost) {
    set_text_size(painter, 15.0, true);
    const QPointF above(0.5 * width(), 0.2 * height());
    draw_haloed_text(painter, above, TextAnchor::middle, tr("TOOL NOT SEEN"), alarm_colour(Alarm::bad));
  }
  painter.setRenderHint(QPainter::Antialiasing, false);
  paint_pane_edge(painter, size(), alarm_colour(figures_->is_lost ? Alarm::bad : figures_->worst()), true);
}

void BullsEyeView::paint_marks(QPainter& painter, const SliceFrame& shown) const {
  const double px_mm = 1.0 / mm_per_pixel();
  const QPointF middle = place_in_pane(shown, devicePixelRatioF(), figures_->pose.tip_mm);
  painter.setBrush(Qt::NoBrush);
  const auto ring = [&](double radius_mm, const QPen& pen) {
    painter.setPen(QPen(QColor(0, 0, 0, 150), pen.widthF() + 2.0));
    painter.drawEllipse(middle, radius_mm * px_mm, radius_mm * px_mm);
    painter.setPen(pen);
    painter.drawEllipse(middle, radius_mm * px_mm, radius_mm * px_mm);
  };
  set_text_size(painter, 8.5, false);
  const QColor quiet(0xf2, 0xf2, 0xf2, 190);
  for (const double radius_mm : {2.0, 5.0, 10.0}) {
    ring(radius_mm, QPen(quiet, 1.0));
    const QPointF at = middle + radius_mm * px_mm * QPointF(0.7071, 0.7071);
    draw_haloed_text(painter, at + QPointF(4.0, 6.0), TextAnchor::left, tr("%1 mm").arg(radius_mm), quiet);
  }
  // The bit: its width, and its axis.
  const double bit_mm = 0.5 * path_->bit.diameter_mm;
  ring(bit_mm, QPen(QColor(kDrillRgb), 2.0));
  constexpr double kTickPx = 7.0;
  for (const QPointF& way : {QPointF(1.0, 0.0), QPointF(0.0, 1.0)}) {
    draw_haloed_line(painter, middle - kTickPx * way, middle + kTickPx * way, QPen(QColor(kDrillRgb), 1.5));
  }
  // The plan, as seen along the bit.
  const PathCurve curve(*path_);
  std::vector<QLineF> way;
  const std::vector<Vec3> places_mm = curve.places_mm(0.5);
  for (std::size_t n = 1; n < places_mm.size(); ++n) {
    way.emplace_back(place_in_pane(shown, devicePixelRatioF(), places_mm[n - 1]),
                     place_in_pane(shown, devicePixelRatioF(), places_mm[n]));
  }
  draw_haloed_lines(painter, way, QPen(QColor(kTextRgb), 1.5));
  const QPointF entry = place_in_pane(shown, devicePixelRatioF(), path_->entry_mm);
  const QPointF target = place_in_pane(shown, devicePixelRatioF(), path_->target_mm);
  constexpr double kMarkPx = 7.0;
  const QRectF square(target.x() - kMarkPx, target.y() - kMarkPx, 2.0 * kMarkPx, 2.0 * kMarkPx);
  painter.setPen(QPen(QColor(0, 0, 0, 170), 5.0));
  painter.drawEllipse(entry, kMarkPx + 2.0, kMarkPx + 2.0);
  painter.drawRect(square);
  painter.setPen(QPen(QColor(kEntryRgb), 2.5));
  painter.drawEllipse(entry, kMarkPx + 2.0, kMarkPx + 2.0);
  painter.setPen(QPen(QColor(kTargetRgb), 2.5));
  painter.drawRect(square);
  // Names, where the two are apart: on the side that is away from the other.
  if (QLineF(entry, target).length() < 4.0 * kMarkPx) return;
  set_text_size(painter, 9.5, true);
  const double side = entry.y() < target.y() ? -1.0 : 1.0;
  draw_haloed_text(painter, entry + QPointF(0.0, side * 20.0), TextAnchor::middle, tr("entry"), QColor(kEntryRgb));
  draw_haloed_text(painter, target - QPointF(0.0, side * 20.0), TextAnchor::middle, tr("target"), QColor(kTargetRgb));
}

void BullsEyeView::mousePressEvent(QMouseEvent* event) { mouse_ = mouse_in_widget(*event); }

void BullsEyeView::mouseMoveEvent(QMouseEvent* event) {
  const QPointF way = mouse_in_widget(*event) - mouse_;
  mouse_ = mouse_in_widget(*event);
  if (!device_) return;
  if (event->buttons().testFlag(Qt::LeftButton)) device_->move({kMmPerMousePx * way.x(), kMmPerMousePx * way.y(), 0.0});
  if (event->buttons().testFlag(Qt::RightButton)) {
    device_->lean({kRadPerMousePx * way.x(), kRadPerMousePx * way.y()});
  }
}

void BullsEyeView::wheelEvent(QWheelEvent* event) {
  constexpr double kPerNotch = 120.0;
  if (device_) device_->move({0.0, 0.0, kMmPerNotch * event->angleDelta().y() / kPerNotch});
  event->accept();
}

void BullsEyeView::go_as_keys_say(bool is_fast) {
  const auto pair = [this](int less, int more) {
    return static_cast<double>(held_.contains(more)) - static_cast<double>(held_.contains(less));
  };
  const double times = is_fast ? kFast : 1.0;
  device_->go(times * kKeysMmS *
                  Vec3(pair(Qt::Key_Left, Qt::Key_Right), pair(Qt::Key_Up, Qt::Key_Down), pair(Qt::Key_S, Qt::Key_W)),
              times * kKeysRadS * Eigen::Vector2d(pair(Qt::Key_A, Qt::Key_D), pair(Qt::Key_Q, Qt::Key_E)));
}

void BullsEyeView::keyPressEvent(QKeyEvent* event) {
  static constexpr std::array kGo{Qt::Key_Left, Qt::Key_Right, Qt::Key_Up, Qt::Key_Down, Qt::Key_W,
                                  Qt::Key_S,    Qt::Key_A,     Qt::Key_D,  Qt::Key_Q,    Qt::Key_E};
  if (!device_) return QWidget::keyPressEvent(event);
  if (event->key() == Qt::Key_Space) {
    if (!event->isAutoRepeat()) device_->press(device_->buttons() ^ (1U << kSpindleButton));
  } else if (event->key() == Qt::Key_Escape) {
    device_->press(device_->buttons() | (1U << kEndButton));
  } else if (std::find(kGo.begin(), kGo.end(), event->key()) != kGo.end()) {
    held_.insert(event->key());
    go_as_keys_say(event->modifiers().testFlag(Qt::ShiftModifier));
  } else {
    QWidget::keyPressEvent(event);
  }
}

void BullsEyeView::keyReleaseEvent(QKeyEvent* event) {
  if (!device_ || event->isAutoRepeat()) return QWidget::keyReleaseEvent(event);
  held_.remove(event->key());
  go_as_keys_say(event->modifiers().testFlag(Qt::ShiftModifier));
}

/// Whoever looks away lets go of the keys, and nobody hears of it.
void BullsEyeView::focusOutEvent(QFocusEvent* event) {
  held_.clear();
  if (device_) device_->go(Vec3::Zero(), Eigen::Vector2d::Zero());
  QWidget::focusOutEvent(event);
}

}  // namespace spinaltap
