#pragma once

#include <map>
#include <span>
#include <string>

#include "core/base/progress.h"
#include "core/base/scalar_field.h"
#include "core/ct/ct_volume.h"
#include "core/phantom/solid.h"
#include "vdb/bake/bake_options.h"
#include "vdb/grid/bone_model.h"

namespace spinaltap {

struct BakeReport {
  std::size_t evaluations = 0;     ///< of the field, one a point asked
  std::size_t dropped_pieces = 0;  ///< parts of the zero set apart from the largest, not in the model
};

/// Bakes the zero set of a field into a signed distance grid, and a CT into a grid of densities.
///
/// The field is evaluated, with its gradient, only in a thin band that starts at `seeds_mm` (points on or near the zero
/// set) and follows it; there the distance is value / |gradient|, beyond it is swept on (OpenVDB's fast sweeping). Of
/// several pieces the largest is kept. `metadata` go into the model as they are.
/// Throws Error when no zero set is found near the seeds.
BoneModel bake_bone(const ScalarField& field, std::span<const Vec3> seeds_mm, const CtVolume& ct,
                    const BakeOptions& options, const std::map<std::string, std::string>& metadata,
                    BakeReport* report = nullptr, const Progress& progress = {});

/// Bakes the ground truth of a phantom in the same form: its distance, and its own CT numbers, without blur or noise,
/// on a grid of the same voxel; `surroundings_hu` beside it. `metadata` are added to the model's own.
BoneModel bake_solid(const Solid& solid, const BakeOptions& options, double surroundings_hu,
                     const Progress& progress = {}, const std::map<std::string, std::string>& metadata = {});

}  // namespace spinaltap
