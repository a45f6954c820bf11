#include "core/ct/detail/label_file.h"

#include <tbb/parallel_for.h>

#include <cmath>

#include "core/base/error.h"
#include "core/base/text_writer.h"
#include "core/ct/detail/dicom_labels.h"
#include "core/ct/detail/volume_file.h"

namespace spinaltap::detail {

namespace fs = std::filesystem;

std::size_t LabelFile::voxel_count() const {
  return static_cast<std::size_t>(size[0]) * static_cast<std::size_t>(size[1]) * static_cast<std::size_t>(size[2]);
}

namespace {

LabelFile read_volume_labels(const fs::path& file, VolumeFormat format,
                             const std::function<void(const LabelFile&)>& begin, const TakeLabels& take) {
  const VolumeFile volume = open_volume_file(file, format);
  LabelFile labels;
  labels.size = volume.size;
  labels.index_to_patient = volume.index_to_patient;
  labels.origin_mm = volume.origin_mm;
  if (begin) begin(labels);
  volume.read_values(take);
  labels.names = volume.read_label_names();
  return labels;
}

}  // namespace

LabelFile read_label_file(const fs::path& file, const GridGeometry& ct, const LabelFileOptions& options,
                          const std::function<void(const LabelFile&)>& begin, const TakeLabels& take) {
  std::error_code error;
  if (!fs::exists(file, error)) fail_as(ErrorKind::file, "no such file: ", file.string());
  if (!fs::is_regular_file(file, error)) fail("expected a label map, found something else: ", file.string());
  switch (dicom_kind_of(file)) {
    case DicomKind::kSegmentation:
    case DicomKind::kLabelMapSegmentation:
      return read_dicom_segmentation(file, options.only, begin, take);
    case DicomKind::kStructureSet:
      return read_dicom_contours(file, ct, options.only, begin, take);
    case DicomKind::kSurfaceSegmentation:
      fail("expected a DICOM segmentation of voxels, found one of surfaces: ", file.string(),
           " (save it from 3D Slicer as a label map)");
    case DicomKind::kOther:
      fail("expected a DICOM segmentation (SEG) or structure set (RTSTRUCT) as a label map, found another DICOM file: ",
           file.string());
    case DicomKind::kNone:
      break;
  }
  const VolumeFormat format = volume_format_of(file);
  if (format == VolumeFormat::kNifti) return read_nifti_labels(file, options.affine, begin, take);
  if (format == VolumeFormat::kNone) {
    fail(
        "expected a label map as NIfTI (.nii, .nii.gz), NRRD (.nrrd, .nhdr, .seg.nrrd), MetaImage (.mha, .mhd) or "
        "DICOM (SEG, RTSTRUCT), found ",
        file.string());
  }
  return read_volume_labels(file, format, begin, take);
}

std::optional<long long> label_in(double value) {
  constexpr double kRounding = 1e-3;
  constexpr double kMax = 1e15;  // false also for what is not a number
  if (!(std::abs(value) < kMax) || std::abs(value - std::round(value)) > kRounding) return std::nullopt;
  return std::llround(value);
}

void for_each_nearest(const LabelFile& file, const GridGeometry& grid,
                      const std::function<void(std::size_t, std::size_t)>& visit) {
  GridGeometry of_file;  // for its offsets
  of_file.size = file.size;
  const Mat3 to_file = file.index_to_patient.inverse();
  const Mat3 step = to_file * grid.index_to_patient_matrix();
  const Vec3 start = to_file * (grid.origin_mm - file.origin_mm);
  tbb::parallel_for(0, grid.size[2], [&](int k) {
    for (int j = 0; j < grid.size[1]; ++j) {
      for (int i = 0; i < grid.size[0]; ++i) {
        const Vec3 p_file = start + step * Vec3(i, j, k);
        const Eigen::Array3d nearest = (p_file.array() + 0.5).floor();
        const auto inside_axis = [&](int axis) {
          return nearest[axis] >= 0.0 && nearest[axis] < file.size[static_cast<std::size_t>(axis)];
        };
        if (!inside_axis(0) || !inside_axis(1) || !inside_axis(2)) continue;
        visit(grid.offset(i, j, k),
              of_file.offset(static_cast<int>(nearest[0]), static_cast<int>(nearest[1]), static_cast<int>(nearest[2])));
      }
    }
  });
}

std::string list_for_people(const std::set<long long>& labels) {
  constexpr int kMax = 40;
  if (labels.empty()) return "none";
  TextWriter text;
  int count = 0;
  for (const long long label : labels) {
    if (++count > kMax) {
      text << ", ... (" << labels.size() << " in all)";
      break;
    }
    text << (count > 1 ? ", " : "") << label;
  }
  return text.str();
}

}  // namespace spinaltap::detail
