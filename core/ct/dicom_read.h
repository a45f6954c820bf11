#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "core/base/progress.h"
#include "core/ct/ct_volume.h"

namespace spinaltap {

/// One CT series found in a folder. Holds nothing that identifies a patient.
struct SeriesInfo {
  std::string uid;       ///< SeriesInstanceUID; empty where the files have none
  int number = 0;        ///< 1, 2, ...: what a person may type instead of the UID
  std::string modality;  ///< "CT", "MR", ...
  int columns = 0;
  int rows = 0;
  std::vector<std::filesystem::path> files;  ///< in the order of the names
};

/// The DICOM image series below a folder, ordered by UID (then orientation and size, which split a series whose files
/// do not fit into one volume). Files that are not DICOM are passed over.
/// Throws Error when the folder is missing or holds no DICOM image.
std::vector<SeriesInfo> list_dicom_series(const std::filesystem::path& folder, const Progress& progress = {});

struct DicomReadOptions {
  /// SeriesInstanceUID or number of the series to read; may be empty where the folder holds just one.
  std::string series;
};

/// Reads a CT series: slices sorted by position along their normal, rescaled to HU, step taken from the positions.
/// Throws Error on a folder without DICOM, a series that is not CT, several series and none chosen (the message lists
/// them), a missing or doubled slice, slices of unequal size or orientation, and files that cannot be decoded.
CtVolume read_dicom(const std::filesystem::path& folder, const DicomReadOptions& options = {},
                    const Progress& progress = {});

}  // namespace spinaltap
