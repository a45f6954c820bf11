#pragma once

#include <memory>

#include "core/engine/drill_engine.h"
#include "vdb/engine/voxel_bone.h"

namespace spinaltap {

struct VoxelEngineOptions {
  /// Steps with much work go to TBB's threads too. Off: a step stays on its own thread, as real time asks.
  bool shares_work = true;
};

/// Mills voxels: any tool, on any way. A step goes down the bone's tree, past every node and leaf that the tool cannot
/// have reached since it was last looked at, to words of 64 voxels; see docs/voxel-engine.md. The voxels die in place;
/// the bone must outlive the engine. Throws Error on a bad bit or material.
std::unique_ptr<DrillEngine> make_voxel_engine(VoxelBone& bone, const DrillBit& bit, const Material& material,
                                               const VoxelEngineOptions& options = {});

namespace detail {
struct WordKernels;

/// The same with a set of instructions of one's own choice; the other takes the machine's fastest.
std::unique_ptr<DrillEngine> make_voxel_engine(VoxelBone& bone, const DrillBit& bit, const Material& material,
                                               const VoxelEngineOptions& options, const WordKernels& kernels);
}  // namespace detail

}  // namespace spinaltap
