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
/// do not fit into one volume). Files without the mark of a DICOM file ("DICM" after 128 bytes), DICOM objects without
/// pixels and what cannot be opened are passed over; links to folders are not followed.
/// Throws Error when the folder is missing or holds no DICOM image, and for a file cut short that may be a CT slice.
std::vector<SeriesInfo> list_dicom_series(const std::filesystem::path& folder, const Progress& progress = {});

struct DicomReadOptions {
  /// SeriesInstanceUID or number of the series to read; may be empty where the folder holds just one.
  std::string series;
};

/// Reads a CT series: slices sorted by position along their normal, rescaled to HU, clamped to 16 bit. The step is the
/// mean over the positions. The grid is right-handed: k grows along the normal, columns' direction x rows' direction.
/// Throws Error on a folder without DICOM, a series that is not CT, several series and none chosen (the message lists
/// them), a missing or doubled slice, slices of unequal size, orientation or step, slices that drift sideways (a
/// tilted gantry), one slice alone, and files that cannot be decoded.
CtVolume read_dicom(const std::filesystem::path& folder, const DicomReadOptions& options = {},
                    const Progress& progress = {});

}  // namespace spinaltap
