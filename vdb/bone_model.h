#pragma once

#include <filesystem>
#include <map>
#include <memory>
#include <span>
#include <string>

#include "core/base/geometry.h"

namespace spinaltap {

namespace detail {
struct BoneGrids;
}

/// A baked bone: a signed distance grid `sdf` (mm, negative inside, a narrow band of 3 voxels around the surface) and a
/// grid `hu` of CT numbers within the bone and a margin, both in patient LPS, mm. Copies share the grids, which nothing
/// changes.
class BoneModel {
 public:
  /// Takes over grids that baking made.
  explicit BoneModel(std::shared_ptr<const detail::BoneGrids> grids);

  /// Distance (mm, clamped to the band) and CT number (HU) at patient positions (mm), tri-linear. All spans have one
  /// length; an empty `hu` is not filled. Safe from many threads at once.
  void sample(std::span<const Vec3> points_mm, std::span<float> distance_mm, std::span<float> hu) const;

  /// Width of the band on each side of the surface: distances are clamped to it, mm.
  double band_mm() const;
  double voxel_mm() const;
  /// Box around the bone's surface, patient LPS, mm.
  Box3 bounds_mm() const;
  std::size_t active_voxels() const;
  /// What was baked and how: "source_hash", "method", ... as text.
  const std::map<std::string, std::string>& facts() const;

  const detail::BoneGrids& grids() const { return *grids_; }

 private:
  std::shared_ptr<const detail::BoneGrids> grids_;
};

/// Writes `bone.vdb` with the grids `sdf` and `hu` to `path`, which must be a staged (temporary) name. The same model
/// gives the same bytes. Throws Error when the disk is full.
void write_bone(const BoneModel& bone, const std::filesystem::path& path);

/// Reads what write_bone wrote. Throws Error on a missing or damaged file, and on one without the two grids.
BoneModel read_bone(const std::filesystem::path& path);

}  // namespace spinaltap
