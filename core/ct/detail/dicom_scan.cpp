#include "core/ct/detail/dicom_scan.h"

#include <algorithm>
#include <cmath>
#include <tuple>

#include "core/base/error.h"
#include "core/ct/detail/dicom_codec.h"
#include "core/ct/detail/dicom_parallel.h"
#include "core/ct/detail/dicom_stack.h"

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
  const auto key = [](const DicomHeader& h) {
    return std::tie(h.series_uid, h.modality, h.stack_id, h.columns, h.rows);
  };
  if (key(a) != key(b) || a.orientation.size() != b.orientation.size()) {
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
  const auto rest = [](const DicomHeader& h) { return std::tie(h.stack_id, h.columns, h.rows, h.file, h.frame); };
  return rest(a) < rest(b);
}

/// What the positions say, where they say something.
void describe(const std::vector<DicomHeader>& headers, SeriesInfo& info) {
  const DicomHeader& first = headers.front();
  info.uid = first.series_uid;
  info.modality = first.modality;
  info.columns = first.columns;
  info.rows = first.rows;
  info.slices = static_cast<int>(headers.size());
  info.transfer_syntax = transfer_syntax_name(first.transfer_syntax);
  for (const DicomHeader& header : headers) {
    if (info.files.empty() || info.files.back() != header.file) info.files.push_back(header.file);
  }
  try {
    info.layout = measure_stack(headers);
  } catch (const Error&) {
    info.layout.reset();  // pictures without a place in space, or one alone, are listed too
  }
}

std::vector<ScannedSeries> scan_files(const std::vector<fs::path>& files, const fs::path& where,
                                      const Progress& progress) {
  std::vector<std::vector<DicomHeader>> headers(files.size());
  for_each_file(files.size(), "reading DICOM headers", progress,
                [&](std::size_t n) { headers[n] = read_dicom_headers(files[n]); });

  std::vector<ScannedSeries> series;
  for (std::vector<DicomHeader>& frames : headers) {
    for (DicomHeader& header : frames) {
      const auto known = std::find_if(series.begin(), series.end(), [&](const ScannedSeries& other) {
        return fit_into_one_volume(other.headers.front(), header);
      });
      ScannedSeries& home = known != series.end() ? *known : series.emplace_back();
      home.headers.push_back(std::move(header));
    }
  }
  if (series.empty()) {
    fail("expected DICOM images, found none among ", files.size(), files.size() == 1 ? " file in " : " files in ",
         where.string());
  }
  std::sort(series.begin(), series.end(), [](const ScannedSeries& a, const ScannedSeries& b) {
    return comes_before(a.headers.front(), b.headers.front());
  });
  for (std::size_t n = 0; n < series.size(); ++n) {
    describe(series[n].headers, series[n].info);
    series[n].info.number = static_cast<int>(n) + 1;
  }
  return series;
}

}  // namespace

std::vector<ScannedSeries> scan_dicom(const fs::path& path, const Progress& progress) {
  std::error_code error;
  const fs::file_type type = fs::status(path, error).type();
  if (type == fs::file_type::directory) return scan_files(regular_files_below(path, progress), path, progress);
  if (type == fs::file_type::regular) return scan_files({path}, path, progress);
  if (fs::exists(fs::symlink_status(path, error)) && type != fs::file_type::not_found) {
    fail("expected a folder or a file with DICOM images, found something else: ", path.string());
  }
  fail("no such folder: ", path.string());
}

std::vector<SeriesInfo> list_dicom_series(const fs::path& path, const Progress& progress) {
  std::vector<SeriesInfo> list;
  for (ScannedSeries& series : scan_dicom(path, progress)) list.push_back(std::move(series.info));
  return list;
}

}  // namespace spinaltap
