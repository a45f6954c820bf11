#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/ct/dicom_elements.h"

namespace spinaltap {

/// What the reader needs to know of one DICOM image before its pixels are decoded, as the file states it: numbers are
/// not judged here. Lists are empty where the attribute is missing; a part that is not a number is NaN.
struct DicomHeader {
  std::filesystem::path file;
  std::string transfer_syntax;  ///< UID of how the pixels are stored
  std::string sop_class;
  std::string series_uid;
  std::string modality;
  std::string photometric;  ///< "MONOCHROME2", ...
  int columns = -1;         ///< -1 while missing
  int rows = -1;
  int samples = 1;  ///< per pixel
  int bits_allocated = 0;
  int bits_stored = 0;
  int high_bit = 0;
  bool is_signed = false;                 ///< stored values are two's complement
  std::vector<double> frames;             ///< NumberOfFrames
  std::vector<double> position_mm;        ///< ImagePositionPatient: centre of the first pixel, patient LPS
  std::vector<double> orientation;        ///< ImageOrientationPatient: along which columns grow, then rows
  std::vector<double> pixel_spacing_mm;   ///< PixelSpacing: from row to row, then from column to column
  std::vector<double> rescale_slope;      ///< RescaleSlope
  std::vector<double> rescale_intercept;  ///< RescaleIntercept
  std::vector<ByteRange> pixels;          ///< one range, or the fragments of compressed pixels
  bool encapsulated = false;              ///< pixels are fragments
};

/// Reads all but the pixels. Nothing for a file that is not DICOM, cannot be opened, or is no image.
/// Throws Error for a file that ends early or is broken and may be a CT slice: it must not be lost in silence.
std::optional<DicomHeader> read_dicom_header(const std::filesystem::path& file);

}  // namespace spinaltap
