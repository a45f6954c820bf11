#include "core/ct/detail/dicom_scan.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <tuple>

#include "core/base/error.h"
#include "core/base/text_writer.h"
#include "core/ct/detail/dicom_codec.h"
#include "core/ct/detail/dicom_parallel.h"
#include "core/ct/detail/dicom_parts.h"
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

/// "passed over 3 of 50 files: 1 a directory (DICOMDIR), 2 not DICOM"; empty where none was.
std::string list_passed_over(const std::vector<std::string>& why_none) {
  std::map<std::string, std::size_t> counts;
  for (const std::string& why : why_none) {
    if (!why.empty()) ++counts[why];
  }
  TextWriter text;
  std::size_t all = 0;
  for (const auto& [why, count] : counts) {
    text << (all == 0 ? "" : ", ") << count << ' ' << why;
    all += count;
  }
  return all == 0 ? std::string() : joined("passed over ", all, " of ", why_none.size(), " files: ", text.str());
}

/// CTs are parted into acquisitions; pictures of other modalities are only listed.
std::vector<ScannedSeries> parted(std::vector<ScannedSeries> series) {
  std::vector<ScannedSeries> all;
  for (ScannedSeries& one : series) {
    if (one.headers.front().modality != "CT") {
      all.push_back(std::move(one));
      continue;
    }
    for (DicomPart& part : part_into_acquisitions(std::move(one.headers))) {
      ScannedSeries& made = all.emplace_back();
      made.headers = std::move(part.headers);
      made.info.told_apart_by = std::move(part.told_apart_by);
      made.info.notes = std::move(part.notes);
      made.info.warnings = std::move(part.warnings);
    }
  }
  return all;
}

void number_stacks(std::vector<ScannedSeries>& series) {
  const auto key = [](const ScannedSeries& one) { return std::tie(one.info.uid, one.info.modality); };
  std::map<std::tuple<std::string, std::string>, int> counts;
  for (ScannedSeries& one : series) one.info.stack = ++counts[key(one)];
  for (ScannedSeries& one : series) one.info.stacks = counts[key(one)];
}

std::vector<ScannedSeries> scan_files(const std::vector<fs::path>& files, const fs::path& where,
                                      const Progress& progress) {
  std::vector<std::vector<DicomHeader>> headers(files.size());
  std::vector<std::string> why_none(files.size());
  for_each_file(files.size(), "reading DICOM headers", progress,
                [&](std::size_t n) { headers[n] = read_dicom_headers(files[n], &why_none[n]); });
  const std::string passed_over = list_passed_over(why_none);

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
         where.string(), passed_over.empty() ? "" : ": ", passed_over);
  }
  std::sort(series.begin(), series.end(), [](const ScannedSeries& a, const ScannedSeries& b) {
    return comes_before(a.headers.front(), b.headers.front());
  });
  series = parted(std::move(series));
  for (std::size_t n = 0; n < series.size(); ++n) {
    SeriesInfo& info = series[n].info;
    describe(series[n].headers, info);
    info.number = static_cast<int>(n) + 1;
    info.passed_over = passed_over;
  }
  number_stacks(series);
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
  fail_as(ErrorKind::file, "no such folder: ", path.string());
}

std::vector<SeriesInfo> list_dicom_series(const fs::path& path, const Progress& progress) {
  std::vector<SeriesInfo> list;
  for (ScannedSeries& series : scan_dicom(path, progress)) list.push_back(std::move(series.info));
  return list;
}

}  // namespace spinaltap
