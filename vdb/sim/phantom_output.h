#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/base/progress.h"
#include "core/phantom/scanner.h"
#include "core/phantom/solid.h"
#include "core/phantom/spine.h"
#include "core/phantom/surroundings.h"
#include "core/phantom/vertebra_ground_truth.h"
#include "vdb/sim/bone.h"

namespace spinaltap {

struct PhantomOptions {
  ScanOptions scan;
  double ground_truth_voxel_mm = 0.25;
};

/// Scans a phantom and writes, whole or not at all, a folder with ct/ (DICOM), ground_truth.vdb (distance and CT
/// numbers), ground_truth.json (how it was scanned and, for a vertebra, its pedicles) and, for a vertebra, plan.json (a
/// path through each).
void write_phantom(const Solid& solid, const std::optional<VertebraGroundTruth>& ground_truth,
                   const PhantomOptions& options, const std::filesystem::path& folder, const Progress& progress = {});

/// A bone to try things on, without a CT: the shipped vertebra by its own formula, and a path through each pedicle.
struct PhantomBone {
  Bone bone;
  std::vector<DrillPath> paths;  ///< left, right
};
/// `voxel_mm`: of its grids. Takes a second at 0.5 mm. Throws Error where the shipped file is not found.
PhantomBone phantom_bone(double voxel_mm = 0.5, const Progress& progress = {});

/// Scans a spine and writes, whole or not at all, a folder with ct/ (DICOM), ground_truth_labels.nii.gz (which voxel
/// belongs to which level, on the CT's grid) and ground_truth.json (how it was scanned; for a spine made from
/// SpineOptions each level's pedicles, body, endplates and tips, and the discs). `surroundings`: null for the even ones
/// of `scan`.
void write_spine_phantom(const Spine& spine, const Surroundings* surroundings, const ScanOptions& scan,
                         const std::filesystem::path& folder, const Progress& progress = {});

}  // namespace spinaltap
