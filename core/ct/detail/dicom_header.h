#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/ct/detail/dicom_elements.h"

namespace spinaltap {

/// PixelSpacing lies below it: a body is then some twenty pixels wide.
inline constexpr double kMaxPixelMm = 25.0;

/// What may differ from frame to frame of a multi-frame file. Lists are empty where the attribute is missing; a part
/// that is not a number is NaN.
struct DicomFrame {
  std::vector<double> position_mm;        ///< ImagePositionPatient: centre of the first pixel, patient LPS
  std::vector<double> orientation;        ///< ImageOrientationPatient: along which columns grow, then rows
  std::vector<double> pixel_spacing_mm;   ///< PixelSpacing: from row to row, then from column to column
  std::vector<double> rescale_slope;      ///< RescaleSlope
  std::vector<double> rescale_intercept;  ///< RescaleIntercept
  std::string rescale_type;               ///< RescaleType: the unit of rescaled values; empty: HU (PS3.3, C.11.1.1.2)
  std::string stack_id;                   ///< StackID: frames of one multi-frame file that belong together
  // What tells acquisitions apart that stand in one series; empty where the attribute is missing.
  std::string image_type;          ///< ImageType, or FrameType
  std::string kernel;              ///< ConvolutionKernel
  std::string kvp;                 ///< KVP: the tube's voltage
  std::string contrast;            ///< ContrastBolusAgent
  std::string acquisition_number;  ///< AcquisitionNumber, or FrameAcquisitionNumber
  std::string acquisition_time;    ///< AcquisitionDateTime, or AcquisitionDate and AcquisitionTime
  std::string temporal_position;   ///< TemporalPositionIdentifier, or TemporalPositionIndex
  std::string cardiac_phase;       ///< NominalPercentageOfCardiacPhase, or TriggerTime
};

/// What the reader needs to know of one DICOM picture (a file, or a frame of one) before its pixels are decoded, as the
/// file states it: numbers are not judged here.
struct DicomHeader : DicomFrame {
  std::filesystem::path file;
  std::string transfer_syntax;  ///< UID of how the pixels are stored
  std::string sop_class;
  std::string series_uid;
  std::string instance_uid;        ///< SOPInstanceUID: no two pictures have the same
  std::string frame_of_reference;  ///< FrameOfReferenceUID: positions are of this frame
  std::string modality;
  std::string photometric;  ///< "MONOCHROME2", ...
  int columns = -1;         ///< -1 while missing
  int rows = -1;
  int samples = 1;  ///< per pixel
  int bits_allocated = 0;
  int bits_stored = 0;
  int high_bit = 0;
  bool is_signed = false;                      ///< stored values are two's complement
  std::optional<std::uint32_t> padding;        ///< PixelPaddingValue, as stored: not a measured value
  std::optional<std::uint32_t> padding_limit;  ///< PixelPaddingRangeLimit: the other end of a range of such values
  bool has_modality_lut = false;               ///< values go through a table instead of slope and intercept
  std::vector<double> slice_spacing_mm;        ///< SpacingBetweenSlices: a hint of the step, no more
  std::vector<double> slice_thickness_mm;      ///< SliceThickness: another
  // What says again, in other words, where a slice lies and how large it is: witnesses, nothing is read from them.
  std::vector<double> slice_location_mm;     ///< SliceLocation
  std::vector<double> instance_number;       ///< InstanceNumber
  std::vector<double> reconstruction_mm;     ///< ReconstructionDiameter
  std::vector<double> gantry_tilt_deg;       ///< GantryDetectorTilt
  std::string patient_orientation;           ///< PatientOrientation: "L\P"
  std::uint64_t surplus_bytes = 0;           ///< of plain pixels, beyond what sizes and frames take
  int frame = 0;                             ///< which of `frames`, from 0
  int frames = 1;                            ///< in the file
  std::vector<ByteRange> pixels;             ///< of this frame: one range, or the fragments of compressed pixels
  bool encapsulated = false;                 ///< pixels are fragments
  bool big_endian = false;                   ///< plain pixels: most significant byte first
  bool swapped_bytes = false;                ///< 8-bit pixels in 16-bit words of a big endian file
  std::optional<std::uint64_t> deflated_at;  ///< where the deflated data set begins, whose bytes `pixels` counts
};

/// "IM0042.dcm", or "IM0042.dcm, frame 7" (counted from 1), for messages.
std::string name_of(const DicomHeader& header);
/// The same with the whole path.
std::string path_of(const DicomHeader& header);

/// Reads all but the pixels: one header a frame. Nothing for a file that is not DICOM, cannot be opened, or is no
/// image; `why_none` then says which, in words for many such files. Files without the 128 bytes and mark in front are
/// read too. Throws Error for a file that ends early or is broken and may be a CT: it must not be lost in silence.
std::vector<DicomHeader> read_dicom_headers(const std::filesystem::path& file, std::string* why_none = nullptr);

}  // namespace spinaltap
