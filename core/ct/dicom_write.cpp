#include "core/ct/dicom_write.h"

#include <gdcmFile.h>
#include <gdcmWriter.h>

#include <algorithm>
#include <cstdio>
#include <cstring>

#include "core/base/error.h"
#include "core/base/staged_output.h"
#include "core/base/text_fields.h"
#include "core/base/text_writer.h"
#include "core/ct/detail/dicom_parallel.h"
#include "core/ct/detail/dicom_silence.h"
#include "core/ct/detail/dicom_uid.h"
#include "core/ct/detail/dicom_values.h"

namespace spinaltap {
namespace {

constexpr const char* kCtImageStorage = "1.2.840.10008.5.1.4.1.1.2";
constexpr const char* kExplicitLittleEndian = "1.2.840.10008.1.2.1";

/// What all slices of a series share.
struct SeriesText {
  std::string study_uid;
  std::string series_uid;
  std::string frame_uid;
  std::string description;
  std::string thickness_mm;
};

void put(gdcm::DataSet& data, const gdcm::Tag& tag, gdcm::VR::VRType vr, std::string value) {
  // Values have even length: UIDs are padded with a zero byte, text with a space (PS3.5, 6.2).
  if (value.size() % 2 != 0) value.push_back(vr == gdcm::VR::UI ? '\0' : ' ');
  gdcm::DataElement element(tag);
  element.SetVR(vr);
  element.SetByteValue(value.data(), static_cast<std::uint32_t>(value.size()));
  data.Replace(element);
}

void put_short(gdcm::DataSet& data, const gdcm::Tag& tag, int value) {
  put(data, tag, gdcm::VR::US, {static_cast<char>(value & 0xff), static_cast<char>(value >> 8 & 0xff)});
}

std::string decimals(std::initializer_list<double> values) {
  std::string text;
  for (const double value : values) text += (text.empty() ? "" : "\\") + to_decimal_string(value);
  return text;
}

std::string decimals(const Vec3& v) { return decimals({v.x(), v.y(), v.z()}); }

/// When the study was: the same for the same bytes each time, and there, since a DICOMDIR must have it (PS3.3, F.5.2).
constexpr const char* kStudyDate = "20000101";
constexpr const char* kStudyTime = "000000";

/// Patient, study, equipment and frame of reference (PS3.3, A.3): all that must be there, empty where it is not known.
void put_series(gdcm::DataSet& data, const SeriesText& series) {
  using gdcm::VR;
  put(data, {0x0008, 0x0005}, VR::CS, "ISO_IR 192");  // UTF-8
  put(data, {0x0008, 0x0008}, VR::CS, "DERIVED\\PRIMARY\\AXIAL");
  put(data, {0x0008, 0x0020}, VR::DA, kStudyDate);
  put(data, {0x0008, 0x0030}, VR::TM, kStudyTime);
  put(data, {0x0008, 0x0050}, VR::SH, "");  // AccessionNumber
  put(data, {0x0008, 0x0060}, VR::CS, "CT");
  put(data, {0x0008, 0x0070}, VR::LO, "SpinalTap");  // Manufacturer
  put(data, {0x0008, 0x0090}, VR::PN, "");           // ReferringPhysicianName
  put(data, {0x0008, 0x103e}, VR::LO, series.description);
  put(data, {0x0010, 0x0010}, VR::PN, "SpinalTap^Phantom");
  put(data, {0x0010, 0x0020}, VR::LO, "PHANTOM");
  put(data, {0x0010, 0x0030}, VR::DA, "");       // PatientBirthDate
  put(data, {0x0010, 0x0040}, VR::CS, "");       // PatientSex
  put(data, {0x0018, 0x0015}, VR::CS, "SPINE");  // BodyPartExamined: no paired part, which would need a Laterality
  put(data, {0x0018, 0x0050}, VR::DS, series.thickness_mm);
  put(data, {0x0018, 0x0060}, VR::DS, "");     // KVP
  put(data, {0x0018, 0x5100}, VR::CS, "HFS");  // PatientPosition: head first, supine
  put(data, {0x0020, 0x000d}, VR::UI, series.study_uid);
  put(data, {0x0020, 0x000e}, VR::UI, series.series_uid);
  put(data, {0x0020, 0x0010}, VR::SH, "1");  // StudyID
  put(data, {0x0020, 0x0011}, VR::IS, "1");  // SeriesNumber
  put(data, {0x0020, 0x0012}, VR::IS, "1");  // AcquisitionNumber
  put(data, {0x0020, 0x0052}, VR::UI, series.frame_uid);
  put(data, {0x0020, 0x1040}, VR::LO, "");  // PositionReferenceIndicator
}

void put_slice(gdcm::DataSet& data, const CtVolume& ct, const SeriesText& series, int k) {
  using gdcm::VR;
  const GridGeometry& geometry = ct.geometry;
  const Vec3 position_mm = geometry.to_patient(Vec3(0.0, 0.0, k));
  const Vec3 normal = geometry.directions.col(0).cross(geometry.directions.col(1));
  put(data, {0x0008, 0x0016}, VR::UI, kCtImageStorage);
  put(data, {0x0008, 0x0018}, VR::UI, dicom_uid_of(series.series_uid + " slice " + std::to_string(k)));
  put(data, {0x0018, 0x0088}, VR::DS, to_decimal_string(geometry.spacing_mm.z()));  // SpacingBetweenSlices
  put(data, {0x0020, 0x0013}, VR::IS, std::to_string(k + 1));                       // InstanceNumber
  put(data, {0x0020, 0x0032}, VR::DS, decimals(position_mm));
  put(data, {0x0020, 0x0037}, VR::DS,
      decimals(geometry.directions.col(0)) + "\\" + decimals(geometry.directions.col(1)));
  put(data, {0x0020, 0x1041}, VR::DS, to_decimal_string(normal.dot(position_mm)));  // SliceLocation
}

void put_pixels(gdcm::DataSet& data, const CtVolume& ct, int k) {
  using gdcm::VR;
  const GridGeometry& geometry = ct.geometry;
  put_short(data, {0x0028, 0x0002}, 1);  // SamplesPerPixel
  put(data, {0x0028, 0x0004}, VR::CS, "MONOCHROME2");
  put_short(data, {0x0028, 0x0010}, geometry.size[1]);                                                // Rows
  put_short(data, {0x0028, 0x0011}, geometry.size[0]);                                                // Columns
  put(data, {0x0028, 0x0030}, VR::DS, decimals({geometry.spacing_mm.y(), geometry.spacing_mm.x()}));  // PixelSpacing
  put_short(data, {0x0028, 0x0100}, 16);                                                              // BitsAllocated
  put_short(data, {0x0028, 0x0101}, 16);                                                              // BitsStored
  put_short(data, {0x0028, 0x0102}, 15);                                                              // HighBit
  put_short(data, {0x0028, 0x0103}, 1);         // PixelRepresentation: signed
  put(data, {0x0028, 0x1050}, VR::DS, "400");   // WindowCenter: a bone window
  put(data, {0x0028, 0x1051}, VR::DS, "1800");  // WindowWidth
  put(data, {0x0028, 0x1052}, VR::DS, "0");     // RescaleIntercept
  put(data, {0x0028, 0x1053}, VR::DS, "1");     // RescaleSlope
  put(data, {0x0028, 0x1054}, VR::LO, "HU");    // RescaleType

  const std::size_t slice_size = geometry.offset(0, 0, 1);
  std::string bytes(slice_size * 2, '\0');
  for (std::size_t n = 0; n < slice_size; ++n) {
    const auto value = static_cast<std::uint16_t>(ct.hu[static_cast<std::size_t>(k) * slice_size + n]);
    bytes[2 * n] = static_cast<char>(value & 0xff);
    bytes[2 * n + 1] = static_cast<char>(value >> 8);
  }
  put(data, {0x7fe0, 0x0010}, VR::OW, std::move(bytes));
}

std::string encode_slice(const CtVolume& ct, const SeriesText& series, int k) {
  gdcm::Writer writer;
  gdcm::File& file = writer.GetFile();
  gdcm::DataSet& data = file.GetDataSet();
  put_series(data, series);
  put_slice(data, ct, series, k);
  put_pixels(data, ct, k);

  gdcm::FileMetaInformation& meta = file.GetHeader();
  meta.SetDataSetTransferSyntax(gdcm::TransferSyntax::ExplicitVRLittleEndian);
  put(meta, {0x0002, 0x0010}, gdcm::VR::UI, kExplicitLittleEndian);
  put(meta, {0x0002, 0x0012}, gdcm::VR::UI, dicom_uid_of("SpinalTap"));  // ImplementationClassUID
  put(meta, {0x0002, 0x0013}, gdcm::VR::SH, "SPINALTAP");                // not GDCM's version: the bytes stay the same
  TextStream stream;
  writer.SetStream(stream);
  if (!writer.Write() || !stream) fail("cannot encode slice ", k + 1, " as DICOM");
  return std::move(stream).str();
}

void check_writable(const CtVolume& ct, const std::filesystem::path& folder, const DicomWriteOptions& options) {
  check_geometry(ct.geometry, "CT to write");
  if (ct.hu.size() != ct.geometry.voxel_count() || ct.source_hash.empty()) {
    fail("expected a CT from make_ct_volume, found ", ct.hu.size(), " voxels for a grid of ", ct.geometry.voxel_count(),
         ct.source_hash.empty() ? " and no hash" : "");
  }
  if (ct.geometry.size[0] > 65535 || ct.geometry.size[1] > 65535) {
    fail("expected slices of at most 65535 x 65535 pixels, found ", ct.geometry.size[0], " x ", ct.geometry.size[1]);
  }
  if (!(options.slice_thickness_mm >= 0.0)) {
    fail("expected a slice thickness of 0 mm (the step) or more, found ", options.slice_thickness_mm);
  }
  const auto is_allowed = [](char c) { return c != '\\' && static_cast<unsigned char>(c) >= ' '; };
  if (options.series_description.size() > 64 ||
      !std::all_of(options.series_description.begin(), options.series_description.end(), is_allowed)) {
    fail("expected a series description of at most 64 characters without backslash, found ",
         in_quotes(options.series_description));
  }
  std::error_code error;
  if (!std::filesystem::is_directory(folder, error))
    fail_as(ErrorKind::file, "no such folder to write into: ", folder.string());
}

}  // namespace

void write_dicom(const CtVolume& ct, const std::filesystem::path& folder, const DicomWriteOptions& options,
                 const Progress& progress) {
  check_writable(ct, folder, options);
  silence_gdcm();
  const double thickness_mm =
      options.slice_thickness_mm > 0.0 ? options.slice_thickness_mm : ct.geometry.spacing_mm.z();
  SeriesText series;
  series.description = options.series_description;
  series.thickness_mm = to_decimal_string(thickness_mm);
  series.study_uid = dicom_uid_of("study " + ct.source_hash);
  series.frame_uid = dicom_uid_of("frame of reference " + ct.source_hash);
  series.series_uid = dicom_uid_of("series " + ct.source_hash + " " + series.thickness_mm + " " + series.description);

  const int slices = ct.geometry.size[2];
  StagedOutput output;
  std::vector<std::filesystem::path> files;
  files.reserve(static_cast<std::size_t>(slices));
  for (int k = 0; k < slices; ++k) {
    files.push_back(output.stage(folder / (padded_number(static_cast<std::uint64_t>(k) + 1, 4) + ".dcm")));
  }
  for_each_file(files.size(), "writing slices", progress,
                [&](std::size_t k) { write_whole_file(files[k], encode_slice(ct, series, static_cast<int>(k))); });
  output.commit();
}

}  // namespace spinaltap
