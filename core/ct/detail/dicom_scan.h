#pragma once

#include <vector>

#include "core/ct/detail/dicom_header.h"
#include "core/ct/dicom_read.h"

namespace spinaltap {

/// A series and the headers of its files and frames, in the order of the names.
struct ScannedSeries {
  SeriesInfo info;
  std::vector<DicomHeader> headers;
};

/// As list_dicom_series(), with what the headers say.
std::vector<ScannedSeries> scan_dicom(const std::filesystem::path& path, const Progress& progress);

}  // namespace spinaltap
