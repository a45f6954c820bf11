#include "core/ct/dicom_read.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/base/error.h"
#include "core/base/text_writer.h"
#include "core/ct/detail/dicom_agreement.h"
#include "core/ct/detail/dicom_parallel.h"
#include "core/ct/detail/dicom_scan.h"
#include "core/ct/detail/dicom_slice.h"
#include "core/ct/detail/dicom_stack.h"
#include "core/ct/detail/dicom_witnesses.h"
#include "core/ct/hu_check.h"
#include "core/ct/label_frame.h"
#include "core/ct/made_up_slices.h"

namespace spinaltap {
namespace {

/// "1 = 1.2.3 (CT, 512 x 512, 70 files); 2 = ..."
std::string list_for_people(const std::vector<ScannedSeries>& all) {
  constexpr std::ptrdiff_t kMost = 20;
  TextWriter text;
  for (const ScannedSeries& series : all) {
    const SeriesInfo& info = series.info;
    if (&series - all.data() == kMost) {
      text << "; and " << all.size() - static_cast<std::size_t>(kMost) << " more";
      break;
    }
    text << (info.number == all.front().info.number ? "" : "; ") << info.number << " = "
         << (info.uid.empty() ? "no UID" : info.uid) << " (" << (info.modality.empty() ? "no modality" : info.modality)
         << ", " << info.columns << " x " << info.rows << ", " << info.files.size()
         << (info.files.size() == 1 ? " file" : " files");
    if (info.files.size() != static_cast<std::size_t>(info.slices)) text << " of " << info.slices << " slices";
    if (!info.told_apart_by.empty()) text << ", stack " << info.stack << " by " << info.told_apart_by;
    text << ')';
  }
  return text.str();
}

void reject_several(const std::vector<ScannedSeries>& found, const std::filesystem::path& folder) {
  const bool one_uid = std::all_of(found.begin(), found.end(), [&](const ScannedSeries& series) {
    return series.info.uid == found.front().info.uid && series.info.modality == found.front().info.modality;
  });
  const bool are_acquisitions = one_uid && std::any_of(found.begin(), found.end(), [](const ScannedSeries& series) {
                                  return !series.info.told_apart_by.empty();
                                });
  TextWriter text;
  if (are_acquisitions) {
    text << "expected one acquisition in one frame of reference, found " << found.size() << " stacks in "
         << folder.string() << ", which are never put together; choose one with CtReadOptions::stack: ";
  } else {
    text << (one_uid ? "expected slices of one size and orientation, found " : "expected one series, found ")
         << found.size() << (one_uid ? " sets in " : " in ") << folder.string() << "; choose one by number "
         << (one_uid ? "" : "or UID ") << "with CtReadOptions::series: ";
  }
  text << list_for_people(found);
  std::vector<SeriesInfo> series;
  series.reserve(found.size());
  for (const ScannedSeries& one : found) series.push_back(one.info);
  throw SeveralSeries(text.str(), std::move(series));
}

ScannedSeries choose_series(const std::vector<ScannedSeries>& all, const std::string& wanted, int stack,
                            const std::filesystem::path& folder) {
  std::vector<ScannedSeries> matches;
  for (const ScannedSeries& series : all) {
    if (wanted.empty() || series.info.uid == wanted) matches.push_back(series);
  }
  if (matches.empty()) {
    for (const ScannedSeries& series : all) {
      if (std::to_string(series.info.number) == wanted) matches.push_back(series);
    }
  }
  if (matches.empty()) {
    fail("no series \"", wanted, "\" in ", folder.string(), "; there are: ", list_for_people(all));
  }
  if (stack > 0) {
    std::erase_if(matches, [&](const ScannedSeries& series) { return series.info.stack != stack; });
    if (matches.empty()) fail("no stack ", stack, " in ", folder.string(), "; there are: ", list_for_people(all));
  }
  if (matches.size() > 1) reject_several(matches, folder);
  return std::move(matches.front());
}

/// As the files say; 0 where none says one that a scanner has.
double thickest_mm(const std::vector<DicomHeader>& slices) {
  constexpr double kThickestMm = 10.0;
  double thickest_mm = 0.0;
  for (const DicomHeader& slice : slices) {
    if (slice.slice_thickness_mm.size() != 1 || !std::isfinite(slice.slice_thickness_mm.front())) continue;
    const double mm = slice.slice_thickness_mm.front();
    if (mm <= kThickestMm) thickest_mm = std::max(thickest_mm, mm);
  }
  return thickest_mm;
}

}  // namespace

std::string plane_name(const Vec3& normal) {
  constexpr std::array<const char*, 3> kNames{"sagittal", "coronal", "axial"};
  constexpr double kWithin = 0.9986;  // cosine of 3 degrees
  Eigen::Index axis = 0;
  const double max = normal.cwiseAbs().maxCoeff(&axis);
  const std::string name = kNames[static_cast<std::size_t>(axis)];
  return max >= kWithin ? name : "oblique, near " + name;
}

CtVolume read_dicom(const std::filesystem::path& path, const DicomReadOptions& options, const Progress& progress) {
  ScannedSeries series = choose_series(scan_dicom(path, progress), options.series, options.stack, path);
  if (series.info.modality != "CT") {
    fail("expected a CT, found modality ", series.info.modality.empty() ? "\"\"" : series.info.modality, " in ",
         series.info.files.front().string());
  }
  const DicomStack stack = stack_slices(std::move(series.headers), options.resample);
  for (const DicomHeader& slice : stack.slices) {  // before memory is taken
    check_dicom_slice(slice, options.takes_stored);
  }

  std::vector<std::int16_t> hu(stack.geometry.voxel_count());
  const std::size_t slice_size = stack.geometry.offset(0, 0, 1);
  for_each_file(stack.slices.size(), "decoding slices", progress, [&](std::size_t k) {
    decode_dicom_slice(stack.slices[k], std::span(hu).subspan(k * slice_size, slice_size), options.takes_stored);
  });
  CtVolume ct = !stack.needs_resampling
                    ? make_ct_volume(stack.geometry, std::move(hu))
                    : resample_stack(stack.geometry, stack.places, stack.geometry.spacing_mm.z(), hu, progress);
  ct.slice_thickness_mm = thickest_mm(stack.slices);
  if (options.resample) add_made_up({stack.geometry.directions.col(2), made_up_slabs(stack)}, ct.choices);
  ct.warnings = std::move(series.info.warnings);
  for (std::string& line : disagreements_of(stack.slices)) ct.warnings.push_back(std::move(line));
  for (std::string& line : contradictions_of(stack)) ct.warnings.push_back(std::move(line));
  if (has_rescale_type(stack.slices, "US") && !check_hu(ct).shows_tissue) {
    ct.warnings.emplace_back(
        "RescaleType US says that the unit is not specified, and the values do not show that it is HU");
  }
  if (has_rescale_type(stack.slices, "HU_MOD")) {
    ct.warnings.emplace_back("RescaleType HU_MOD: modified Hounsfield units, calculated and not measured");
  }
  const std::string& frame = stack.slices.front().frame_of_reference;
  const bool is_one_frame = std::all_of(stack.slices.begin(), stack.slices.end(),
                                        [&](const DicomHeader& slice) { return slice.frame_of_reference == frame; });
  if (is_one_frame) ct.frame_hash = hash_of_frame(frame);
  ct.notes = std::move(series.info.notes);
  if (!stack.note.empty()) ct.notes.push_back(stack.note);
  if (!series.info.passed_over.empty()) ct.notes.push_back(series.info.passed_over);
  return ct;
}

}  // namespace spinaltap
