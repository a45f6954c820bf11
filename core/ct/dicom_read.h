#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/base/error.h"
#include "core/base/geometry.h"
#include "core/base/progress.h"
#include "core/ct/ct_volume.h"

namespace spinaltap {

/// What the positions of a series say, judged or not.
struct StackLayout {
  Mat3 directions;           ///< as GridGeometry's
  double min_step_mm = 0.0;  ///< along the normal
  double max_step_mm = 0.0;
  double tilt_rad = 0.0;  ///< between the normal and the line of the slices' first pixels
};

/// The plane of slices with this normal (unit, patient LPS): "axial", "coronal" or "sagittal" within 3 degrees,
/// otherwise "oblique, near axial" and so on.
std::string plane_name(const Vec3& normal);

/// One CT series found in a folder. Holds nothing that identifies a patient.
struct SeriesInfo {
  std::string uid;       ///< SeriesInstanceUID; empty where the files have none
  int number = 0;        ///< 1, 2, ...: what a person may type instead of the UID
  std::string modality;  ///< "CT", "MR", ...
  int columns = 0;
  int rows = 0;
  int slices = 0;                            ///< files, or the frames in them
  std::string transfer_syntax;               ///< how the first is stored: "JPEG 2000, lossless", ...
  std::optional<StackLayout> layout;         ///< where the slices lie, where they say so
  std::vector<std::filesystem::path> files;  ///< in the order of the names
  int stack = 1;              ///< of the series' stacks, from 1: a series may hold several acquisitions or sizes
  int stacks = 1;             ///< that the series holds
  std::string told_apart_by;  ///< the attributes that part it from the series' other stacks; empty: size, orientation
  std::vector<std::string> notes;     ///< what was assumed of it, a line each
  std::vector<std::string> warnings;  ///< what speaks against it, a line each
  std::string passed_over;            ///< of the whole folder: how many files were, and why; empty: none
};

/// What read_dicom() throws where a choice is missing: of several series, or of several sets of pictures of one.
class SeveralSeries : public Error {
 public:
  SeveralSeries(const std::string& what, std::vector<SeriesInfo> found) : Error(what), series(std::move(found)) {}
  std::vector<SeriesInfo> series;  ///< to choose from
};

/// What read_dicom() throws where DicomReadOptions::resample would read what is there.
class UnevenSlices : public Error {
 public:
  UnevenSlices(const std::string& what_is_uneven, const std::string& advice)
      : Error(what_is_uneven + " (" + advice + ")"), found(what_is_uneven) {}
  std::string found;  ///< without the advice, which names the option
};

/// The DICOM image series below a folder, or in one file, ordered by UID (then orientation, stack and size, which split
/// a series whose pictures do not fit into one volume, and acquisitions and frames of reference, see
/// part_into_acquisitions()). What is not DICOM, DICOM objects without pixels and what cannot be opened are passed over
/// and counted; links to folders are not followed.
/// Throws Error when the path is missing or holds no DICOM image, and for a file cut short that may be a CT.
std::vector<SeriesInfo> list_dicom_series(const std::filesystem::path& path, const Progress& progress = {});

struct DicomReadOptions {
  /// SeriesInstanceUID or number of the series to read; may be empty where the folder holds just one.
  std::string series{};
  /// Which of the series' stacks, from 1; 0: the only one.
  int stack = 0;
  /// Stored values of slices without RescaleSlope and RescaleIntercept are taken as they are: the caller knows their
  /// unit.
  bool takes_stored = false;
  /// Unequal steps, gaps of up to 6 mm and uneven sideways shifts are interpolated instead of rejected.
  bool resample = false;
};

/// Reads a CT series from a folder, or from one multi-frame file: slices sorted by position along their normal,
/// rescaled to HU, clamped to 16 bit, padding made air. The step is the mean over the positions. The grid is
/// right-handed: k grows along the normal, columns' direction x rows' direction. Slices of a tilted gantry, which drift
/// sideways evenly, are resampled onto an orthogonal grid (resample_stack()).
/// Throws Error on a path without DICOM, a series that is not CT, several series and none chosen (SeveralSeries), a
/// doubled slice, slices of unequal size or orientation, without `resample` a missing slice, unequal steps and uneven
/// drift (UnevenSlices where they can be interpolated), one slice alone, and files that cannot be decoded.
CtVolume read_dicom(const std::filesystem::path& path, const DicomReadOptions& options = {},
                    const Progress& progress = {});

}  // namespace spinaltap
