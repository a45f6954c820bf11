#include "core/ct/detail/dicom_label_object.h"

#include <algorithm>

#include "core/base/error.h"
#include "core/base/hash.h"
#include "core/base/text_fields.h"
#include "core/base/version.h"
#include "core/ct/detail/dicom_uid.h"
#include "core/ct/detail/dicom_values.h"

namespace spinaltap::detail {

std::string name_to_write(int number, const LabelName& name) {
  std::string text = name.name.empty() ? "label " + std::to_string(number) : name.name;
  constexpr std::size_t kMax = 64;  // LO: PS3.5, table 6.2-1
  const bool is_text = std::all_of(text.begin(), text.end(), [](char c) {
    return c != '\\' && static_cast<unsigned char>(c) >= ' ' && static_cast<unsigned char>(c) < 0x7f;
  });
  if (!is_text || text.size() > kMax) {
    fail("expected a label's name of at most ", kMax, " letters of ASCII without backslash for DICOM, found ",
         in_quotes(text), " for label ", number);
  }
  return text;
}

ObjectUids uids_to_write(const LabelVolume& volume, const DicomSource& source, const std::string& kind) {
  WordHash64 hash;
  const GridGeometry& geometry = volume.geometry;
  hash.add(geometry.size.data(), sizeof geometry.size);
  hash.add(geometry.origin_mm.data(), 3 * sizeof(double));
  hash.add(geometry.spacing_mm.data(), 3 * sizeof(double));
  hash.add(geometry.directions.data(), 9 * sizeof(double));
  const std::string grid = hash.hex();
  hash.add(volume.labels.data(), volume.labels.size());
  for (const auto& [number, name] : volume.names) {
    const std::string text = std::to_string(number) + name.name;
    hash.add(text.data(), text.size());
  }
  const std::string content = kind + " " + hash.hex() + " " + source.series_uid;
  ObjectUids uids;
  uids.study = source.study_uid.empty() ? dicom_uid_of("study of labels " + grid) : source.study_uid;
  uids.frame_of_reference = source.frame_of_reference_uid.empty() ? dicom_uid_of("frame of reference of labels " + grid)
                                                                  : source.frame_of_reference_uid;
  uids.series = dicom_uid_of("series " + content);
  uids.instance = dicom_uid_of("instance " + content);
  return uids;
}

DicomItem begin_object(const std::string& sop_class, const ObjectUids& uids, const std::string& modality,
                       const std::string& description) {
  DicomItem data;
  data.put(0x00080005, "CS", "ISO_IR 192")
      .put(0x00080016, "UI", sop_class)
      .put(0x00080018, "UI", uids.instance)
      .put(0x00080020, "DA", "")  // StudyDate
      .put(0x00080030, "TM", "")  // StudyTime
      .put(0x00080050, "SH", "")  // AccessionNumber
      .put(0x00080060, "CS", modality)
      .put(0x00080070, "LO", "SpinalTap")  // Manufacturer
      .put(0x00080090, "PN", "")           // ReferringPhysicianName
      .put(0x0008103e, "LO", description)
      .put(0x00081090, "LO", "SpinalTap")  // ManufacturerModelName
      .put(0x00100010, "PN", "")           // PatientName
      .put(0x00100020, "LO", "")           // PatientID
      .put(0x00100030, "DA", "")           // PatientBirthDate
      .put(0x00100040, "CS", "")           // PatientSex
      .put(0x00181000, "LO", "1")          // DeviceSerialNumber, which may not be empty
      .put(0x00181020, "LO", version())
      .put(0x0020000d, "UI", uids.study)
      .put(0x0020000e, "UI", uids.series)
      .put(0x00200010, "SH", "")     // StudyID
      .put(0x00200011, "IS", "300")  // SeriesNumber: behind those of scanners
      .put(0x00200052, "UI", uids.frame_of_reference)
      .put(0x00201040, "LO", "");  // PositionReferenceIndicator
  return data;
}

DicomItem reference_to(const DicomSource::Image& image) {
  DicomItem item;
  item.put(0x00081150, "UI", image.sop_class).put(0x00081155, "UI", image.sop_instance);
  if (image.frame > 0) item.put(0x00081160, "IS", std::to_string(image.frame));
  return item;
}

std::string decimals_to_write(std::initializer_list<double> values) {
  std::string text;
  for (const double value : values) text += (text.empty() ? "" : "\\") + to_decimal_string(value);
  return text;
}

std::string decimals_to_write(const Vec3& v) { return decimals_to_write({v.x(), v.y(), v.z()}); }

}  // namespace spinaltap::detail
