#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "core/base/geometry.h"
#include "core/ct/detail/nifti_place.h"

namespace spinaltap {

/// A NIfTI file of one volume (.nii, .nii.gz; NIfTI-1 or -2, either byte order): its header is read and checked when it
/// is made, its values on demand.
class NiftiVolume {
 public:
  /// Throws Error for what is not a NIfTI file with header and voxels in one, holds more than one volume, claims more
  /// voxels than the file can hold, or does not surely say where they lie (place_nifti()).
  explicit NiftiVolume(const std::filesystem::path& file, NiftiAffine affine = NiftiAffine::automatic);

  const std::array<int, 3>& size() const { return size_; }
  std::size_t voxel_count() const;
  /// Index steps to mm, patient LPS (NIfTI's frame is RAS: x and y turn round). Steps of any length and angle.
  const Mat3& index_to_patient() const { return place_.steps_mm; }
  /// Centre of voxel (0, 0, 0), patient LPS.
  const Vec3& origin_mm() const { return place_.origin_mm; }
  /// What speaks against that place, a line each.
  const std::vector<std::string>& warnings() const { return place_.warnings; }

  /// Calls `take` with the values from first to last, some at a time, scaled by scl_slope and scl_inter; not a number
  /// where the file has none. Throws Error where the file ends early or goes on behind the values.
  void read_values(const std::function<void(std::span<const double>)>& take) const;

  /// What stands between the header and the values: the bytes of each extension, whatever its code. None where the
  /// file says that there are none, or their sizes make no sense.
  std::vector<std::string> read_extensions() const;

 private:
  std::filesystem::path file_;
  std::array<int, 3> size_{};
  NiftiPlace place_;
  int type_ = 0;         ///< NIfTI's number of the stored type
  int value_bytes_ = 0;  ///< of one stored value
  bool is_swapped_ = false;
  std::int64_t values_at_ = 0;  ///< bytes from the (inflated) file's start
  double slope_ = 1.0;
  double intercept_ = 0.0;
};

}  // namespace spinaltap
