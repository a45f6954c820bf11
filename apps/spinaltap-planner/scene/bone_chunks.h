#pragma once

#include <vtkSmartPointer.h>

#include <array>
#include <map>
#include <memory>
#include <optional>
#include <span>

#include "vdb/grid/bone_model.h"
#include "vdb/remaining/surface_block.h"

#include "apps/spinaltap-planner/scene/vtk_names.h"

namespace spinaltap {

/// The bone in 3D: its blocks, some hundred neighbours in one actor, so that there are few to draw and an update brings
/// only those to the graphics card that it touches.
class BoneChunks {
 public:
  explicit BoneChunks(vtkRenderer& renderer);
  ~BoneChunks();
  BoneChunks(const BoneChunks&) = delete;
  BoneChunks& operator=(const BoneChunks&) = delete;

  /// Another bone, without any surface yet; null: none.
  void set_bone(const BoneModel* bone);
  void update(std::span<const SurfaceUpdate> updates);
  void set_opacity(double opacity);

  bool is_glass() const { return opacity_ < 1.0; }

  /// Makes what changed ready to be drawn. False: nothing did.
  bool prepare();

 private:
  struct Chunk;

  vtkRenderer& renderer_;
  std::optional<BoneModel> bone_;  ///< before it was drilled
  double opacity_ = 1.0;
  double drawn_opacity_ = -1.0;  ///< before the first
  std::map<std::array<int, 3>, std::unique_ptr<Chunk>> chunks_;
};

}  // namespace spinaltap
