#include "core/ct/dicom_scan.h"

#include <algorithm>
#include <cmath>
#include <tuple>

#include "core/base/error.h"
#include "core/ct/dicom_parallel.h"

namespace spinaltap {
namespace fs = std::filesystem;
namespace {

/// Regular files at any depth, sorted by path. Links to folders are not followed, so a loop of links ends here; folders
/// that cannot be read are passed over.
std::vector<fs::path> regular_files_below(const fs::path& folder, const Progress& progress) {
  std::vector<fs::path> files;
  std::vector<fs::path> to_visit{folder};
  while (!to_visit.empty()) {
    progress.report("looking for files", 0.0);
    const fs::path visited = std::move(to_visit.back());
    to_visit.pop_back();
    std::error_code error;
    for (fs::directory_iterator entry(visited, error), end; !error && entry != end; entry.increment(error)) {
      std::error_code entry_error;
      if (entry->symlink_status(entry_error).type() == fs::file_type::directory) {
        to_visit.push_back(entry->path());
      } else if (entry->status(entry_error).type() == fs::file_type::regular) {
        files.push_back(entry->path());
      }
    }
  }
  std::sort(files.begin(), files.end());
  return files;
}

bool fit_into_one_volume(const DicomHeader& a, const DicomHeader& b) {
  constexpr double kTolerance = 1e-3;  // of a direction's component: files round them
  if (std::tie(a.series_uid, a.modality, a.columns, a.rows) != std::tie(b.series_uid, b.modality, b.columns, b.rows) ||
      a.orientation.size() != b.orientation.size()) {
    return false;
  }
  for (std::size_t n = 0; n < a.orientation.size(); ++n) {
    if (std::abs(a.orientation[n] - b.orientation[n]) > kTolerance) return false;
  }
  return true;
}

bool comes_before(const DicomHeader& a, const DicomHeader& b) {
  const auto key = [](const DicomHeader& h) { return std::tie(h.series_uid, h.modality); };
  if (key(a) != key(b)) return key(a) < key(b);
  if (a.orientation.size() != b.orientation.size()) return a.orientation.size() < b.orientation.size();
  for (std::size_t n = 0; n < a.orientation.size(); ++n) {
    if (a.orientation[n] < b.orientation[n]) return true;
    if (b.orientation[n] < a.orientation[n]) return false;
  }
  return std::tie(a.columns, a.rows, a.file) < std::tie(b.columns, b.rows, b.file);
}

}  // namespace

std::vector<ScannedSeries> scan_dicom_folder(const fs::path& folder, const Progress& progress) {
  std::error_code error;
  if (!fs::exists(folder, error)) fail("no such folder: ", folder.string());
  if (!fs::is_directory(folder, error)) fail("expected a folder of DICOM files, found a file: ", folder.string());

  const std::vector<fs::path> files = regular_files_below(folder, progress);
  std::vector<std::optional<DicomHeader>> headers(files.size());
  for_each_file(files.size(), "reading DICOM headers", progress,
                [&](std::size_t n) { headers[n] = read_dicom_header(files[n]); });

  std::vector<ScannedSeries> series;
  for (std::optional<DicomHeader>& header : headers) {
    if (!header) continue;
    const auto known = std::find_if(series.begin(), series.end(), [&](const ScannedSeries& other) {
      return fit_into_one_volume(other.headers.front(), *header);
    });
    ScannedSeries& home = known != series.end() ? *known : series.emplace_back();
    home.headers.push_back(std::move(*header));
  }
  if (series.empty()) {
    fail("expected DICOM images, found none among ", files.size(), " files in ", folder.string());
  }
  std::sort(series.begin(), series.end(), [](const ScannedSeries& a, const ScannedSeries& b) {
    return comes_before(a.headers.front(), b.headers.front());
  });
  for (std::size_t n = 0; n < series.size(); ++n) {
    const DicomHeader& first = series[n].headers.front();
    SeriesInfo& info = series[n].info;
    info = {first.series_uid, static_cast<int>(n) + 1, first.modality, first.columns, first.rows, {}};
    for (const DicomHeader& header : series[n].headers) info.files.push_back(header.file);
  }
  return series;
}

std::vector<SeriesInfo> list_dicom_series(const fs::path& folder, const Progress& progress) {
  std::vector<SeriesInfo> list;
  for (ScannedSeries& series : scan_dicom_folder(folder, progress)) list.push_back(std::move(series.info));
  return list;
}

}  // namespace spinaltap
