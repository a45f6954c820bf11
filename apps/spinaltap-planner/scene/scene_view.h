#pragma once

#include <QImage>
#include <QPointF>
#include <QString>
#include <QWidget>
#include <memory>
#include <optional>
#include <span>
#include <utility>

#include "apps/spinaltap-planner/plan_document.h"
#include "apps/spinaltap-planner/view_state.h"
#include "core/tool/drill_bit.h"
#include "vdb/remaining/surface_block.h"

namespace spinaltap {

/// The 3D pane: bone, paths, bit and slices, drawn by OpenGL, on a processor too. Whatever changes is drawn at the next
/// turn of the event loop, all of it in one frame.
class SceneView : public QWidget {
  Q_OBJECT
 public:
  SceneView(PlanDocument& document, ViewState& state, QWidget* parent = nullptr);
  ~SceneView() override;

  /// Blocks of the bone's surface that drilling changed (null surface: none left there).
  void update_surface(std::span<const SurfaceUpdate> updates);
  /// The bit while it drills, when paths' ends cannot be moved; nothing: the path's own bit is drawn, its tip at the
  /// target.
  void set_bit(const std::optional<std::pair<DrillBit, Pose>>& bit);

  /// "behind", "front", "left", "right", "above", "below", as named_view() has them, all of the bone in the pane; or
  /// "hole": near the chosen path's entry. Nothing without a bone, nor "hole" without a path.
  void look_from(const QString& name);
  /// All of the bone, from where the eye is.
  void show_all();

  /// What the pane now shows, drawn anew where something changed.
  QImage picture();
  /// Where a place (patient LPS, mm) is drawn, in pixels of this widget.
  QPointF to_pixel(const Vec3& p_mm) const;
  /// How many frames were drawn.
  int frames() const;

 protected:
  void showEvent(QShowEvent* event) override;
  void resizeEvent(QResizeEvent* event) override;

 private:
  struct Scene;
  std::unique_ptr<Scene> scene_;
};

}  // namespace spinaltap
