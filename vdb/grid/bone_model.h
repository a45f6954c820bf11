#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <span>
#include <string>

#include "core/base/geometry.h"
#include "core/ct/ct_volume.h"
#include "core/ct/hu_to_density.h"
#include "core/ct/level.h"

namespace spinaltap {

class ScalarField;

namespace detail {
struct BoneGrids;
struct BoneSamplers;
}  // namespace detail

/// How values between voxels come about; docs/bone-vdb.md has the errors of both.
enum class Interpolation {
  linear,     ///< tri-linear between the eight voxels around
  quadratic,  ///< tri-quadratic: parabolas through the nearest voxel and its neighbours, exact for quadratics
};

/// A baked bone: a signed distance grid `sdf` (mm, negative inside, a narrow band of 3 voxels around the surface) and a
/// grid `hu` of CT numbers within the bone and a margin, both in patient LPS, mm. Copies share the grids, which nothing
/// changes.
///
/// Samplers take patient positions (LPS, mm), fill spans of the same length, leave empty ones alone, and may be called
/// from many threads at once. Beyond a grid's box, and where a position is not a number, they find the grid's
/// background: outside, +band_mm(), -1024 HU, no gradient.
class BoneModel {
 public:
  /// Takes over grids that baking made, and lists their blocks for the samplers. Throws Error where a grid is spread so
  /// thinly over its box that it cannot be a bone.
  explicit BoneModel(std::shared_ptr<const detail::BoneGrids> grids);

  /// Distance (mm) and CT number (HU), tri-linear; `hu` may be empty.
  void sample(std::span<const Vec3> points_mm, std::span<float> distance_mm, std::span<float> hu) const;

  /// Distance to the surface (mm, negative inside) and its gradient (mm per mm, outward; may be empty).
  ///
  /// The grid is clamped at band_mm(), 3 voxels, and so is what a stencil finds there. Tri-linear values come from true
  /// distances up to 1.2 voxels from the surface (2 along an axis). Tri-quadratic stencils are wider: outermost
  /// corners, of little weight, are clamped from 0.4 voxels on, which costs under 0.01 voxel and 0.01 of the slope up
  /// to 1 voxel from the surface, 0.1 and 0.15 up to 2. Then the gradient fades, to zero at 5.6 voxels.
  void distance(std::span<const Vec3> points_mm, std::span<float> distance_mm, std::span<Vec3> gradients,
                Interpolation interpolation = Interpolation::linear) const;

  /// CT number (HU) and its gradient (HU per mm; may be empty). Within a voxel of where the grid ends, the background
  /// mixes in.
  void hu(std::span<const Vec3> points_mm, std::span<float> hu, std::span<Vec3> gradients_hu_per_mm,
          Interpolation interpolation = Interpolation::linear) const;

  /// Unit normals, outward: the direction of the tri-quadratic gradient. Zero where that is below 0.1 mm per mm, so
  /// beyond the band and half-way between the walls of a thin plate.
  void normals(std::span<const Vec3> points_mm, std::span<Vec3> normals) const;

  /// 1 inside the bone, 0 outside: the sign of the tri-linear distance. It differs from the true surface's at most
  /// voxel² (|k1| + |k2|) / 8 away from it, k1 and k2 being the surface's curvatures, and the grid's own error further.
  void inside(std::span<const Vec3> points_mm, std::span<std::uint8_t> inside) const;

  /// Width of the band on each side of the surface: distances are clamped to it, mm.
  double band_mm() const;
  /// Edge of a voxel of its grids.
  double voxel_mm() const;
  /// Box around the bone's surface, patient LPS, mm.
  Box3 bounds_mm() const;
  /// Of the distance grid.
  std::size_t active_voxels() const;
  /// What was baked and how: "source_hash", "method", ... as text.
  const std::map<std::string, std::string>& metadata() const;

  const detail::BoneGrids& grids() const { return *grids_; }
  const detail::BoneSamplers& samplers() const { return *samplers_; }

 private:
  std::shared_ptr<const detail::BoneGrids> grids_;
  std::shared_ptr<const detail::BoneSamplers> samplers_;
};

/// Whether something was taken from the bone by HoleCutter. Such a bone keeps what it was before and the hole
/// beside its `sdf`, as level sets of their own: surfaces that are made of both have a sharp rim.
bool is_drilled(const BoneModel& bone);

/// The bone as it was before it was drilled; the bone itself where it was not.
BoneModel before_drilling(const BoneModel& bone);

/// Writes `bone.vdb` with the grids `sdf` and `hu`, and `before` and `hole` of a drilled bone, to `path`, which must be
/// a staged (temporary) name. The same model gives the same bytes. Throws Error when the disk is full.
void write_bone(const BoneModel& bone, const std::filesystem::path& path);

/// Reads what write_bone wrote, or a bone of what write_spine wrote (spine_file.h). A `level` other than kNone chooses
/// the bone of several, and must be that of a file with one, as its metadata "level" has it; without it a file of
/// several must hold one only. Throws Error on a missing or damaged file, on one without `sdf` or `hu`, on one with
/// only one of `before` and `hole`, and where the level is not that, not there, or not chosen (the message lists those
/// there are).
BoneModel read_bone(const std::filesystem::path& path, Level level = Level::kNone);

/// Density (g/cm³) at patient positions (LPS, mm), by a density calibration from the bone's tri-linear CT numbers. Both
/// spans have one length. Where the grid holds no CT number, beyond the bone and its margin, it is that of air: 0 by
/// any usual calibration.
void bone_density(const BoneModel& bone, const HuToDensity& line, std::span<const Vec3> points_mm,
                  std::span<float> density_g_cm3);

/// The CT that a baked bone keeps, resampled (tri-linear) around its surface for slices: -1024 HU where it keeps none.
CtVolume ct_of_bone(const BoneModel& bone, double voxel_mm = 0.4);

}  // namespace spinaltap
