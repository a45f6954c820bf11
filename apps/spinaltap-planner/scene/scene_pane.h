#pragma once

#include <QImage>
#include <QWidget>

namespace spinaltap {

/// Shows the last frame of the 3D scene. Qt paints it as any picture: a window that OpenGL draws into would have Qt
/// compose all panes anew, by OpenGL too, whenever one of them changes.
class ScenePane : public QWidget {
 public:
  explicit ScenePane(QWidget* parent = nullptr);

  /// Of device pixels, which may be more than those of the pane.
  const QImage& frame() const { return frame_; }
  void show_frame(QImage frame);

 protected:
  void paintEvent(QPaintEvent* event) override;

 private:
  QImage frame_;
};

}  // namespace spinaltap
