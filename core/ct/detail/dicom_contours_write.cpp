// DICOM structure sets: PS3.3, A.19 and C.8.8.5 to C.8.8.8.

#include <cmath>

#include "core/base/error.h"
#include "core/ct/detail/dicom_label_object.h"
#include "core/ct/detail/dicom_label_writer.h"
#include "core/ct/detail/label_colour.h"
#include "core/ct/detail/mask_contours.h"

namespace spinaltap::detail {
namespace {

constexpr const char* kStructureSetStorage = "1.2.840.10008.5.1.4.1.1.481.3";
constexpr const char* kStudyComponent = "1.2.840.10008.3.1.2.3.1";  // what PS3.3, C.8.8.5 has for a study

std::vector<DicomItem> contours_of(const LabelVolume& volume, const DicomSource& source, int label) {
  const GridGeometry& geometry = volume.geometry;
  const std::size_t slice_size = geometry.offset(0, 0, 1);
  std::vector<DicomItem> contours;
  for (int k = 0; k < geometry.size[2]; ++k) {
    const auto at = static_cast<std::size_t>(k);
    const std::span<const std::uint8_t> slice(volume.labels.data() + at * slice_size, slice_size);
    for (const auto& outline :
         outlines_of(slice, geometry.size[0], geometry.size[1], static_cast<std::uint8_t>(label))) {
      std::string points;
      for (const ContourPoint& p : outline) {
        points += (points.empty() ? "" : "\\") + decimals_to_write(geometry.to_patient(Vec3(p.a, p.b, k)));
      }
      DicomItem item;
      item.put(0x30060042, "CS", "CLOSED_PLANAR")
          .put(0x30060046, "IS", std::to_string(outline.size()))
          .put(0x30060050, "DS", std::move(points));
      if (at < source.slices.size() && source.slices[at]) {
        item.put_items(0x30060016, {reference_to(*source.slices[at])});
      }
      contours.push_back(std::move(item));
    }
  }
  return contours;
}

/// The images that contours were drawn on, as far as there are any.
DicomItem referenced_frame(const DicomSource& source, const ObjectUids& uids) {
  DicomItem frame;
  frame.put(0x00200052, "UI", uids.frame_of_reference);
  std::vector<DicomItem> images;
  for (const auto& image : source.slices) {
    if (image) images.push_back(reference_to(*image));
  }
  if (images.empty()) return frame;
  DicomItem series, study;
  series.put(0x0020000e, "UI", source.series_uid).put_items(0x30060016, std::move(images));
  study.put(0x00081150, "UI", kStudyComponent).put(0x00081155, "UI", source.study_uid).put_items(0x30060014, {series});
  frame.put_items(0x30060012, {study});
  return frame;
}

}  // namespace

std::string encode_dicom_contours(const LabelVolume& volume, const DicomSource& source) {
  const ObjectUids uids = uids_to_write(volume, source, "structure set");
  DicomItem data = begin_object(kStructureSetStorage, uids, "RTSTRUCT", "Vertebrae");
  data.put(0x00081070, "PN", "")            // OperatorsName
      .put(0x00200013, "IS", "1")           // InstanceNumber
      .put(0x30060002, "SH", "VERTEBRAE")   // StructureSetLabel
      .put(0x30060008, "DA", kDateToWrite)  // StructureSetDate
      .put(0x30060009, "TM", kTimeToWrite)
      .put(0x300e0002, "CS", "UNAPPROVED");  // ApprovalStatus
  std::vector<DicomItem> rois, shapes, observations;
  for (const auto& [number, label] : volume.names) {
    const std::string text = std::to_string(number);
    const std::string name = name_to_write(number, label);
    std::vector<DicomItem> contours = contours_of(volume, source, number);
    DicomItem roi, shape, observation;
    roi.put(0x30060022, "IS", text)
        .put(0x30060024, "UI", uids.frame_of_reference)
        .put(0x30060026, "LO", name)
        .put(0x30060036, "CS", "SEMIAUTOMATIC");
    const Vec3 colour = (255.0 * label_colour(number)).array().round();
    shape.put(0x3006002a, "IS",
              std::to_string(static_cast<int>(colour[0])) + "\\" + std::to_string(static_cast<int>(colour[1])) + "\\" +
                  std::to_string(static_cast<int>(colour[2])));
    if (!contours.empty()) shape.put_items(0x30060040, std::move(contours));
    shape.put(0x30060084, "IS", text);
    observation.put(0x30060082, "IS", text)
        .put(0x30060084, "IS", text)
        .put_code(0x30060086, code_to_write(label.level, name))
        .put(0x300600a4, "CS", "ORGAN")
        .put(0x300600a6, "PN", "");
    rois.push_back(std::move(roi));
    shapes.push_back(std::move(shape));
    observations.push_back(std::move(observation));
  }
  if (rois.empty()) fail("expected labels to write into a DICOM structure set, found none");
  data.put_items(0x30060010, {referenced_frame(source, uids)})
      .put_items(0x30060020, std::move(rois))
      .put_items(0x30060039, std::move(shapes))
      .put_items(0x30060080, std::move(observations));
  return dicom_file(data, kStructureSetStorage, uids.instance, false);
}

}  // namespace spinaltap::detail
