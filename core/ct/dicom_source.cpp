#include "core/ct/dicom_source.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "core/base/error.h"
#include "core/ct/detail/dicom_elements.h"
#include "core/ct/detail/dicom_scan.h"
#include "core/ct/detail/dicom_values.h"
#include "core/ct/detail/volume_file.h"

namespace spinaltap {
namespace {

namespace fs = std::filesystem;

struct FileUids {
  std::string study, series, frame_of_reference, sop_class, sop_instance;
};

FileUids uids_of(const fs::path& file) {
  FileUids uids;
  DicomElementWalker walker;
  if (!walker.open(file)) return uids;
  for (DicomElement element; walker.next(element) && element.tag < 0x00280000;) {
    std::string* to = nullptr;
    if (element.tag == 0x00020010) {
      walker.set_transfer_syntax(dicom_text(walker.value(element)));
      continue;
    }
    if (element.tag == 0x00080016) to = &uids.sop_class;
    if (element.tag == 0x00080018) to = &uids.sop_instance;
    if (element.tag == 0x0020000d) to = &uids.study;
    if (element.tag == 0x0020000e) to = &uids.series;
    if (element.tag == 0x00200052) to = &uids.frame_of_reference;
    if (to == nullptr) {
      walker.skip(element);
    } else {
      *to = dicom_text(walker.value(element));
    }
  }
  return uids;
}

/// Which slice of the grid a picture lies in.
std::optional<std::size_t> slice_of(const DicomHeader& header, const GridGeometry& geometry) {
  constexpr double kSameDirection = 0.999;  // cosine
  constexpr double kSamePlace = 0.25;       // slices
  if (header.position_mm.size() != 3 || header.orientation.size() != 6) return std::nullopt;
  const auto vector = [](const std::vector<double>& from, std::size_t at) {
    return Vec3(from[at], from[at + 1], from[at + 2]);
  };
  const Vec3 normal = vector(header.orientation, 0).cross(vector(header.orientation, 3));
  if (!(std::abs(normal.dot(geometry.directions.col(2))) > kSameDirection)) return std::nullopt;
  const double k = geometry.to_index(vector(header.position_mm, 0)).z();
  const double nearest = std::round(k);
  if (!(std::abs(k - nearest) < kSamePlace) || nearest < 0.0 || nearest >= geometry.size[2]) return std::nullopt;
  return static_cast<std::size_t>(nearest);
}

}  // namespace

DicomSource find_dicom_source(const fs::path& path, const std::string& series, int stack, const GridGeometry& geometry,
                              const Progress& progress) {
  const auto slices = static_cast<std::size_t>(geometry.size[2]);
  DicomSource best;
  best.slices.resize(slices);
  if (detail::volume_format_of(path) != detail::VolumeFormat::kNone) return best;
  std::size_t max = 0;
  for (const ScannedSeries& scanned : scan_dicom(path, progress)) {
    const bool is_wanted =
        (series.empty() || scanned.info.uid == series || std::to_string(scanned.info.number) == series) &&
        (stack == 0 || scanned.info.stack == stack);
    if (!is_wanted) continue;
    std::vector<const DicomHeader*> images(slices, nullptr);
    std::size_t found = 0;
    for (const DicomHeader& header : scanned.headers) {
      const std::optional<std::size_t> slice = slice_of(header, geometry);
      if (!slice || images[*slice] != nullptr) continue;
      images[*slice] = &header;
      ++found;
    }
    if (found <= max) continue;
    max = found;
    best = DicomSource();
    best.slices.resize(slices);
    std::map<fs::path, FileUids> known;
    for (std::size_t k = 0; k < slices; ++k) {
      if (images[k] == nullptr) continue;
      const auto [at, is_new] = known.try_emplace(images[k]->file);
      if (is_new) at->second = uids_of(images[k]->file);
      const FileUids& uids = at->second;
      if (best.study_uid.empty()) {
        best.study_uid = uids.study;
        best.series_uid = uids.series;
        best.frame_of_reference_uid = uids.frame_of_reference;
      }
      if (uids.sop_instance.empty() || uids.sop_class.empty()) continue;
      best.slices[k] =
          DicomSource::Image{uids.sop_class, uids.sop_instance, images[k]->frames > 1 ? images[k]->frame + 1 : 0};
    }
  }
  return best;
}

}  // namespace spinaltap
