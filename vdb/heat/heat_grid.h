#pragma once

#include <array>
#include <cstddef>
#include <filesystem>
#include <memory>
#include <vector>

#include "core/base/geometry.h"
#include "core/ct/grid_geometry.h"
#include "core/tool/bit_profile.h"
#include "vdb/heat/heat_medium.h"

namespace spinaltap {

struct HeatGridOptions {
  double voxel_mm = 0.2;
  /// Where the centre of voxel (0, 0, 0) is, patient LPS, and the directions of the grid's axes, in columns: unit,
  /// at right angles, right-handed. Along a hole its wall is even.
  Vec3 origin_mm = Vec3::Zero();
  Mat3 axes = Mat3::Identity();
  double wall_transfer_w_mm2_k = 0.0;  ///< from the wall of the hole to water; 0: dry
  double water_rise_k = 0.0;           ///< the water's temperature, above the bone's first
  /// Rises that count as too hot: for how long each voxel has them is kept. By default 47 and 50 °C from 37 °C.
  std::array<double, 2> hot_rise_k{10.0, 13.0};
};

/// Where heat is, J.
struct HeatBalance {
  double given_j = 0.0;   ///< that found bone
  double missed_j = 0.0;  ///< that found none
  double in_bone_j = 0.0;
  double drilled_j = 0.0;  ///< that went with drilled voxels
  double water_j = 0.0;    ///< that the wall gave to the water
};

/// The warmest place that a voxel of bone that is still there has been.
struct HottestVoxel {
  double rise_k = 0.0;
  Vec3 at_mm = Vec3::Zero();  ///< patient LPS
};

/// The warmest that bone has been, voxel by voxel, in the box of all that heat came near.
struct HeatVolume {
  GridGeometry geometry;
  std::vector<float> max_rise_k;  ///< 0 where there is no bone
};

/// Conduction of heat in bone while it is drilled, by finite volumes in time steps as long as they are stable
/// (explicit). Voxels lie in blocks of 8 x 8 x 8, the leaves of an OpenVDB tree; a block is there from when heat comes
/// near it, so that the grid is as large as what is warm. What is outside lets no heat through, and neither does air;
/// between two tissues conductivities are averaged harmonically. All rises are above the temperature that the bone had
/// at first.
///
/// Each voxel's next value follows from the last values alone: the same bits at any number of threads.
class HeatGrid {
 public:
  /// Throws Error on options that make no sense. The medium must outlive it.
  HeatGrid(const HeatMedium& medium, const HeatGridOptions& options);
  ~HeatGrid();
  HeatGrid(HeatGrid&&) noexcept;

  /// Heat at a place, shared out to the eight voxels around; missed where none of them is bone.
  void heat_point(const Vec3& at_mm, double heat_j);
  /// Heat along a ring about `axis` (unit), on the wall of a hole of `radius_mm`: evenly around, to the bone there is
  /// at a quarter of a voxel behind the wall.
  void heat_ring(const Vec3& centre_mm, const Vec3& axis, double radius_mm, double heat_j);
  /// Takes the voxels out whose centres the bit holds. Their heat goes with them.
  void drill(const BitProfile& bit, const Pose& pose);
  /// Lets heat flow.
  void advance(double dt_s);

  double time_s() const;
  const std::array<double, 2>& hot_rise_k() const;
  HeatBalance balance() const;
  std::size_t voxels() const;
  /// Rise at the voxel around a place, now and at most; 0 where there is none.
  double rise_k(const Vec3& at_mm) const;
  double max_rise_k(const Vec3& at_mm) const;
  /// Of the bone that is there, the warmest now.
  double warmest_k() const;
  /// Of the bone that is there, the warmest so far; at least `from_wall_mm` outside the cylinder that the widest place
  /// of the last bit would drill along its axis.
  HottestVoxel hottest(double from_wall_mm = 0.0) const;
  /// Volume of bone that was hotter than HeatGridOptions::hot_rise_k[which] for at least `seconds` in all, mm³.
  double hot_volume_mm3(std::size_t which, double seconds) const;

  /// Throws Error where no heat came.
  HeatVolume volume() const;
  /// Writes grids "max_temperature" (°C, `first_c` being the bone's first) and "seconds_hot_0", "seconds_hot_1" to a
  /// staged .vdb. The same drilling gives the same bytes. Throws Error when the disk is full.
  void write(const std::filesystem::path& path, double first_c) const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace spinaltap
