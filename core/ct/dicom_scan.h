#pragma once

#include <vector>

#include "core/ct/dicom_header.h"
#include "core/ct/dicom_read.h"

namespace spinaltap {

/// A series and the headers of its files, in the same order.
struct ScannedSeries {
  SeriesInfo info;
  std::vector<DicomHeader> headers;
};

/// As list_dicom_series(), with what the headers say.
std::vector<ScannedSeries> scan_dicom_folder(const std::filesystem::path& folder, const Progress& progress);

}  // namespace spinaltap
