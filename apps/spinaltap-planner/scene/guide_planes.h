#pragma once

#include <array>
#include <memory>

#include "apps/spinaltap-planner/opened_bone.h"
#include "apps/spinaltap-planner/scene/vtk_names.h"
#include "apps/spinaltap-planner/view_state.h"

namespace spinaltap {

/// Slices of the CT in 3D, where the three planes cross, each in a frame of its plane's colour.
class GuidePlanes {
 public:
  explicit GuidePlanes(vtkRenderer& renderer);
  ~GuidePlanes();
  GuidePlanes(const GuidePlanes&) = delete;
  GuidePlanes& operator=(const GuidePlanes&) = delete;

  /// Draws those that are shown; null: no bone, so none.
  void prepare(const std::shared_ptr<const OpenedBone>& bone, const ViewState& state, double pixel_ratio);

 private:
  struct Guide;

  std::array<std::unique_ptr<Guide>, 3> guides_;
};

}  // namespace spinaltap
