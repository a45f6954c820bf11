#pragma once

#include <array>
#include <cstddef>
#include <filesystem>
#include <functional>
#include <map>
#include <span>
#include <string>

#include "core/base/geometry.h"
#include "core/base/progress.h"
#include "core/ct/ct_volume.h"

namespace spinaltap::detail {

/// Is given a volume's values from first to last, some at a time; not a number where the file has none.
using TakeValues = std::function<void(std::span<const double>)>;

/// A regular volume of one number a voxel as an image format's file gives it, CT or label map. Where the voxels lie is
/// read and checked when it is opened; the values are read on demand.
struct VolumeFile {
  std::string format;  ///< "NRRD", for messages
  std::array<int, 3> size{0, 0, 0};
  Mat3 index_to_patient = Mat3::Identity();  ///< mm, LPS; steps of any length and angle
  Vec3 origin_mm = Vec3::Zero();             ///< centre of voxel (0, 0, 0), LPS
  /// Throws Error where the file ends early or holds more than its header says.
  std::function<void(const TakeValues&)> read_values;
  /// What the file calls its labels, in its own words; empty where the format has no names.
  std::function<std::map<long long, std::string>()> read_label_names;

  std::size_t voxel_count() const;
};

/// The formats of one file (or a header and its data) for one volume.
enum class VolumeFormat { kNone, kNifti, kNrrd, kMetaImage };

/// By what the file begins with; NIfTI, which may be packed, by its name (.nii, .nii.gz). kNone also for folders and
/// what cannot be opened.
VolumeFormat volume_format_of(const std::filesystem::path& file);

// One file each. They throw Error for what is damaged, holds another number of axes or values a voxel, claims more
// voxels than its bytes can hold, or does not say where they lie.

/// NRRD (teem.sourceforge.net/nrrd/format.html), with attached or detached data: .nrrd, .nhdr.
VolumeFile open_nrrd(const std::filesystem::path& file);
/// MetaImage (itk.org/Wiki/MetaIO/Documentation): .mha, .mhd.
VolumeFile open_meta_image(const std::filesystem::path& file);
/// One of the two.
VolumeFile open_volume_file(const std::filesystem::path& file, VolumeFormat format);

/// Rejects sizes below 1 or of too many voxels in all, steps that are not finite, and such as give voxels no volume.
void check_placed(const VolumeFile& volume, const std::filesystem::path& file);

/// The volume as a CT: values are HU, rounded, clamped to 16 bit; what is not a number becomes air. The axes change
/// places until i, j and k run as nearly to the left, to the back and to the head as they can, so that a CT converted
/// from axial DICOM gets its slices back. A stack that leans (a tilted gantry's, kept as shear of the third axis) is
/// resampled onto an orthogonal grid (resample_stack()). Throws Error for one slice alone, and for any other shear.
CtVolume ct_of_volume(const VolumeFile& volume, const std::filesystem::path& file, const Progress& progress);

}  // namespace spinaltap::detail
