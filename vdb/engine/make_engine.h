#pragma once

#include <memory>
#include <span>

#include "core/engine/drill_engine.h"

namespace spinaltap {

/// For any motion and any tool: keeps a volume's occupied points in the leaves of a VDB tree, passes over those that
/// the bit cannot have reached since they were last looked at, classifies the others' boxes against the swept bit, and
/// drops what is empty. Removes the same points as all engines; the volume must outlive it.
std::unique_ptr<DrillEngine> make_leaf_engine(PointVolume& volume, const DrillBit& bit, const Material& material);

/// One engine for several volumes, which may overlap: bone that lies in several counts once, in the first of them,
/// since drop_shared_points() is called (call it before to learn how many points that killed). A point is removed where
/// an engine of its own volume would; work and thrust are those of all. Throws Error without volumes, and as
/// drop_shared_points() does.
std::unique_ptr<DrillEngine> make_leaf_engine(std::span<PointVolume* const> volumes, const DrillBit& bit,
                                              const Material& material);

/// The engine of a kind for points, also of those that stand on a VDB tree. Throws Error for EngineKind::voxel
/// and EngineKind::automatic.
std::unique_ptr<DrillEngine> make_engine(EngineKind kind, PointVolume& volume, const DrillBit& bit,
                                         const Material& material);

}  // namespace spinaltap
