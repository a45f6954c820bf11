#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/base/geometry.h"

namespace spinaltap {

/// Voxels of a grid that are active, and the box of their indices (low to high, both in it; all 0 where there are
/// none).
struct ActiveVoxels {
  std::uint64_t count = 0;
  std::array<int, 3> low{};
  std::array<int, 3> high{};
  bool operator==(const ActiveVoxels&) const = default;
};

/// A voxel whose two values differ.
struct VoxelDifference {
  std::array<int, 3> index{};
  Vec3 position_mm = Vec3::Zero();  ///< of its centre, patient LPS, by the first file's transform
  float a = 0.0F;
  float b = 0.0F;
};

/// How two grids of one name differ. Values are in the grid's own unit. The norms are over the voxels that are active
/// in either grid; an inactive voxel has the value that the grid stores for it.
struct GridDifference {
  std::string name;
  bool in_a = false;  ///< the first file has it; where only one has, nothing below `b` says more
  bool in_b = false;
  ActiveVoxels a;
  ActiveVoxels b;
  std::uint64_t only_in_a = 0;  ///< active in one only
  std::uint64_t only_in_b = 0;
  bool same_transform = true;
  bool same_background = true;

  std::uint64_t compared = 0;            ///< voxels active in either
  std::uint64_t different = 0;           ///< of these, by more than the tolerance, or not a number
  std::uint64_t inactive_different = 0;  ///< the same of voxels active in neither: outside in one, inside in the other
  double l1 = 0.0;                       ///< mean of |a - b|, without voxels that are not numbers
  double l2 = 0.0;                       ///< root of the mean of (a - b)²
  double linf = 0.0;                     ///< largest |a - b|
  std::optional<VoxelDifference> first;  ///< of `different`, by x, then y, then z
  std::vector<std::string> metadata;     ///< names of metadata that differ, sorted; not counted as a difference

  /// Whether the grids are the same within the tolerance that they were compared with.
  bool same = false;
};

struct DiffOptions {
  /// Values may differ by this much, in the grid's unit. At 0 the same voxels must be active as well.
  double tolerance = 0.0;
};

/// Compares the float grids of two .vdb files by name, in the order of the names; of grids of one name the first with
/// the first, the second with the second. Bit-identical at any thread count. Throws Error where a file is missing,
/// damaged or holds no float grid, and on a tolerance that is negative or no number.
std::vector<GridDifference> diff_grids(const std::filesystem::path& a, const std::filesystem::path& b,
                                       const DiffOptions& options = {});

}  // namespace spinaltap
