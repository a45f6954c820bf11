#pragma once

#include <string>

#include "core/ct/detail/dicom_item.h"
#include "core/ct/dicom_source.h"
#include "core/ct/label_volume.h"

// What segmentations and structure sets have in common when they are written.
namespace spinaltap::detail {

/// What a label is called: its name, or "label 5".
std::string name_to_write(int number, const LabelName& name);

/// UIDs of the object and of what it lies in: the CT's study and frame of reference where there is one. The object's
/// own depend on its content, so that the same labels give the same bytes.
struct ObjectUids {
  std::string study, series, frame_of_reference, instance;
};
ObjectUids uids_to_write(const LabelVolume& volume, const DicomSource& source, const std::string& kind);

/// Patient (empty), study, series, equipment. Attributes that must be there stay empty where they would tell of a
/// patient.
DicomItem begin_object(const std::string& sop_class, const ObjectUids& uids, const std::string& modality,
                       const std::string& description);

/// An item that refers to an image: ReferencedSOPClassUID, ReferencedSOPInstanceUID, ReferencedFrameNumber.
DicomItem reference_to(const DicomSource::Image& image);

/// Numbers with backslashes between, each of at most 16 characters.
std::string decimals_to_write(std::initializer_list<double> values);
std::string decimals_to_write(const Vec3& v);

/// Date and time for attributes that may not be empty: the same in each file, and no patient's.
constexpr const char* kDateToWrite = "20000101";
constexpr const char* kTimeToWrite = "000000";

}  // namespace spinaltap::detail
