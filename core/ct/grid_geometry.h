#pragma once

#include <array>
#include <cstddef>

#include "core/base/geometry.h"

namespace spinaltap {

/// Where the voxels of a regular grid lie. Index (i, j, k) counts columns, rows and slices; voxel centres sit on
/// integer indices; i runs fastest in memory.
struct GridGeometry {
  std::array<int, 3> size{0, 0, 0};    ///< columns, rows, slices
  Vec3 origin_mm = Vec3::Zero();       ///< centre of voxel (0, 0, 0), patient LPS
  Vec3 spacing_mm = Vec3::Ones();      ///< step of i, j and k
  Mat3 directions = Mat3::Identity();  ///< column c: unit vector in patient LPS along which index c grows

  /// Of all of the grid.
  std::size_t voxel_count() const {
    return static_cast<std::size_t>(size[0]) * static_cast<std::size_t>(size[1]) * static_cast<std::size_t>(size[2]);
  }
  /// Place of a voxel, which must be in the grid, in arrays with i fastest.
  std::size_t offset(int i, int j, int k) const {
    return (static_cast<std::size_t>(k) * static_cast<std::size_t>(size[1]) + static_cast<std::size_t>(j)) *
               static_cast<std::size_t>(size[0]) +
           static_cast<std::size_t>(i);
  }
  /// Whether there is such a voxel.
  bool contains(int i, int j, int k) const {
    return i >= 0 && j >= 0 && k >= 0 && i < size[0] && j < size[1] && k < size[2];
  }

  /// Matrix from index steps to patient mm: directions times spacing.
  Mat3 index_to_patient_matrix() const { return directions * spacing_mm.asDiagonal(); }
  // Always inline: a user's compiler with fused products must not bring its own in place of the library's.
  [[gnu::always_inline]] Vec3 to_patient(const Vec3& p_index) const {
    return origin_mm + directions * p_index.cwiseProduct(spacing_mm);
  }
  Vec3 to_index(const Vec3& p_patient) const;
  double smallest_spacing_mm() const { return spacing_mm.minCoeff(); }
};

/// Rejects sizes below 1 or over `max_voxels`, spacing that is not above zero, values that are not finite, and axes
/// that are not unit vectors at right angles within 1e-3. `what` names the grid in the message.
void check_geometry(const GridGeometry& geometry, const char* what, std::size_t max_voxels = std::size_t{1} << 31);

/// Which of a NIfTI file's two transforms says where its voxels lie.
enum class NiftiAffine {
  automatic,  ///< the one that is sure; an error where neither is
  sform,
  qform,
};

}  // namespace spinaltap
