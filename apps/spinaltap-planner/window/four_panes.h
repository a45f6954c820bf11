#pragma once

#include <QWidget>
#include <array>
#include <optional>
#include <span>
#include <utility>

#include "apps/spinaltap-planner/plan_document.h"
#include "apps/spinaltap-planner/view_state.h"
#include "vdb/remaining/surface_block.h"

class QSplitter;

namespace spinaltap {

class SceneView;
class SliceView;

/// Axial, 3D, coronal and sagittal, with splitters between them; or one of them alone.
class FourPanes : public QWidget {
  Q_OBJECT
 public:
  FourPanes(PlanDocument& document, ViewState& state, QWidget* parent = nullptr);

  SceneView& scene() { return *scene_; }
  /// "axial", "coronal", "sagittal" or "3d"; null on other names.
  QWidget* pane(const QString& name) const;
  /// One pane alone; an empty name: all four.
  void show_only(const QString& name);
  /// Shows a box (patient LPS, mm) on the slices as large as they allow.
  void fit_slices_to(const Box3& shown_mm);
  void set_bit(const std::optional<std::pair<DrillBit, Pose>>& bit);
  /// Blocks of the bone's surface that drilling changed.
  void update_surface(std::span<const SurfaceUpdate> updates);

 private:
  std::array<SliceView*, 3> slices_{};
  SceneView* scene_ = nullptr;
  QSplitter* columns_ = nullptr;
};

}  // namespace spinaltap
