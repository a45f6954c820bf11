// DICOM segmentations: PS3.3, A.51 and C.8.20.

#include <algorithm>
#include <array>
#include <cmath>

#include "core/base/error.h"
#include "core/ct/detail/dicom_label_object.h"
#include "core/ct/detail/dicom_label_writer.h"
#include "core/ct/detail/dicom_uid.h"
#include "core/ct/detail/label_colour.h"

namespace spinaltap::detail {
namespace {

constexpr const char* kSegmentationStorage = "1.2.840.10008.5.1.4.1.1.66.4";
const DicomCode kAnatomicalStructure{"91723000", "SCT", "Anatomical Structure"};

/// A colour of sRGB in CIELab under D50, as 16 bits a part (PS3.3, C.10.7.1.1).
std::string cielab_bytes(const Vec3& srgb) {
  Vec3 linear;
  for (Eigen::Index n = 0; n < 3; ++n) {
    linear[n] = srgb[n] <= 0.04045 ? srgb[n] / 12.92 : std::pow((srgb[n] + 0.055) / 1.055, 2.4);
  }
  Mat3 to_xyz;  // of sRGB, adapted from D65 to D50 by Bradford's method (ICC)
  to_xyz << 0.4360747, 0.3850649, 0.1430804, 0.2225045, 0.7168786, 0.0606169, 0.0139322, 0.0971045, 0.7141733;
  const Vec3 xyz = (to_xyz * linear).cwiseQuotient(Vec3(0.9642, 1.0, 0.8249));
  const auto f = [](double t) { return t > 216.0 / 24389.0 ? std::cbrt(t) : (24389.0 / 27.0 * t + 16.0) / 116.0; };
  const double l = 116.0 * f(xyz[1]) - 16.0;
  const double a = 500.0 * (f(xyz[0]) - f(xyz[1]));
  const double b = 200.0 * (f(xyz[1]) - f(xyz[2]));
  std::string bytes;
  for (const double part : {l / 100.0, (a + 128.0) / 255.0, (b + 128.0) / 255.0}) {
    const auto value = static_cast<unsigned>(std::lround(std::clamp(part, 0.0, 1.0) * 65535.0));
    bytes += {static_cast<char>(value & 0xff), static_cast<char>(value >> 8)};
  }
  return bytes;
}

DicomItem segment_item(int segment, int number, const LabelName& label) {
  const std::string name = name_to_write(number, label);
  DicomItem item;
  item.put_code(0x00620003, kAnatomicalStructure)  // SegmentedPropertyCategoryCodeSequence
      .put_short(0x00620004, segment)
      .put(0x00620005, "LO", name)
      .put(0x00620008, "CS", "SEMIAUTOMATIC")
      .put(0x00620009, "LO", "SpinalTap")  // SegmentAlgorithmName
      .put(0x0062000d, "US", cielab_bytes(label_colour(number)))
      .put_code(0x0062000f, code_to_write(label.level, name));  // SegmentedPropertyTypeCodeSequence
  return item;
}

/// One frame: a slice with some voxels of a label.
struct Frame {
  int segment = 0;  ///< from 1
  int label = 0;
  int slice = 0;
};

std::vector<Frame> frames_of(const LabelVolume& volume) {
  const std::size_t slice_size = volume.geometry.offset(0, 0, 1);
  std::array<std::vector<int>, 256> slices;
  for (int k = 0; k < volume.geometry.size[2]; ++k) {
    std::array<bool, 256> found{};
    for (std::size_t v = 0; v < slice_size; ++v) {
      found[volume.labels[static_cast<std::size_t>(k) * slice_size + v]] = true;
    }
    for (std::size_t label = 1; label < found.size(); ++label) {
      if (found[label]) slices[label].push_back(k);
    }
  }
  std::vector<Frame> frames;
  int segment = 0;
  for (const auto& entry : volume.names) {
    ++segment;
    for (const int k : slices[static_cast<std::size_t>(entry.first)]) frames.push_back({segment, entry.first, k});
  }
  return frames;
}

/// Single bits, the first pixel in the lowest, frames without a gap between (PS3.5, 8.1.1).
std::string packed_pixels(const LabelVolume& volume, const std::vector<Frame>& frames) {
  const std::size_t slice_size = volume.geometry.offset(0, 0, 1);
  std::string bytes((slice_size * frames.size() + 7) / 8, '\0');
  std::size_t bit = 0;
  for (const Frame& frame : frames) {
    const std::uint8_t* labels = volume.labels.data() + static_cast<std::size_t>(frame.slice) * slice_size;
    for (std::size_t v = 0; v < slice_size; ++v, ++bit) {
      if (labels[v] == frame.label) bytes[bit / 8] = static_cast<char>(bytes[bit / 8] | 1 << (bit % 8));
    }
  }
  return bytes;
}

DicomItem frame_item(const LabelVolume& volume, const DicomSource& source, const Frame& frame, int position) {
  DicomItem content, plane, identity, item;
  content.put_longs(0x00209157, {static_cast<std::uint32_t>(frame.segment), static_cast<std::uint32_t>(position)});
  plane.put(0x00200032, "DS", decimals_to_write(volume.geometry.to_patient(Vec3(0.0, 0.0, frame.slice))));
  identity.put_short(0x0062000b, frame.segment);
  item.put_items(0x00209111, {content}).put_items(0x00209113, {plane}).put_items(0x0062000a, {identity});
  const auto k = static_cast<std::size_t>(frame.slice);
  if (k < source.slices.size() && source.slices[k]) {
    DicomItem image = reference_to(*source.slices[k]);
    image.put_code(0x0040a170, {"121322", "DCM", "Source image for image processing operation"});
    DicomItem derivation;
    derivation.put_items(0x00082112, {image}).put_code(0x00089215, {"113076", "DCM", "Segmentation"});
    item.put_items(0x00089124, {derivation});
  }
  return item;
}

/// What viewers look the images up by before they read frames.
void put_referenced_series(DicomItem& data, const DicomSource& source) {
  std::vector<DicomItem> images;
  std::string last;
  for (const auto& image : source.slices) {
    if (!image || image->sop_instance == last) continue;  // frames of one file stand together
    last = image->sop_instance;
    images.push_back(reference_to({image->sop_class, image->sop_instance, 0}));
  }
  if (images.empty()) return;
  DicomItem series;
  series.put(0x0020000e, "UI", source.series_uid).put_items(0x0008114a, std::move(images));
  data.put_items(0x00081115, {series});
}

void put_dimensions(DicomItem& data, const ObjectUids& uids) {
  const std::string organization = dicom_uid_of("dimensions of " + uids.instance);
  DicomItem item, by_segment, by_position;
  item.put(0x00209164, "UI", organization);
  by_segment.put(0x00209164, "UI", organization)
      .put_tag(0x00209165, 0x0062000b)
      .put_tag(0x00209167, 0x0062000a)
      .put(0x00209421, "LO", "ReferencedSegmentNumber");
  by_position.put(0x00209164, "UI", organization)
      .put_tag(0x00209165, 0x00200032)
      .put_tag(0x00209167, 0x00209113)
      .put(0x00209421, "LO", "ImagePositionPatient");
  data.put_items(0x00209221, {item}).put_items(0x00209222, {by_segment, by_position});
}

DicomItem shared_groups(const GridGeometry& geometry) {
  DicomItem orientation, measures, groups;
  orientation.put(0x00200037, "DS",
                  decimals_to_write(geometry.directions.col(0)) + "\\" + decimals_to_write(geometry.directions.col(1)));
  measures.put(0x00180050, "DS", decimals_to_write({geometry.spacing_mm.z()}))
      .put(0x00180088, "DS", decimals_to_write({geometry.spacing_mm.z()}))
      .put(0x00280030, "DS", decimals_to_write({geometry.spacing_mm.y(), geometry.spacing_mm.x()}));
  groups.put_items(0x00209116, {orientation}).put_items(0x00289110, {measures});
  return groups;
}

}  // namespace

std::string encode_dicom_segmentation(const LabelVolume& volume, const DicomSource& source) {
  const GridGeometry& geometry = volume.geometry;
  if (geometry.size[0] > 65535 || geometry.size[1] > 65535) {
    fail("expected slices of at most 65535 x 65535 pixels, found ", geometry.size[0], " x ", geometry.size[1]);
  }
  const std::vector<Frame> frames = frames_of(volume);
  if (frames.empty()) fail("expected labels to write into a DICOM segmentation, found none");
  const ObjectUids uids = uids_to_write(volume, source, "segmentation");
  DicomItem data = begin_object(kSegmentationStorage, uids, "SEG", "Vertebrae");
  data.put(0x00080008, "CS", "DERIVED\\PRIMARY")
      .put(0x00080023, "DA", kDateToWrite)
      .put(0x00080033, "TM", kTimeToWrite)
      .put(0x00200013, "IS", "1")
      .put_short(0x00280002, 1)
      .put(0x00280004, "CS", "MONOCHROME2")
      .put(0x00280008, "IS", std::to_string(frames.size()))
      .put_short(0x00280010, geometry.size[1])
      .put_short(0x00280011, geometry.size[0])
      .put_short(0x00280100, 1)
      .put_short(0x00280101, 1)
      .put_short(0x00280102, 0)
      .put_short(0x00280103, 0)
      .put(0x00282110, "CS", "00")  // LossyImageCompression
      .put(0x00620001, "CS", "BINARY")
      .put(0x00700080, "CS", "VERTEBRAE")  // ContentLabel
      .put(0x00700081, "LO", "Vertebrae")
      .put(0x00700084, "PN", "");  // ContentCreatorName
  put_referenced_series(data, source);
  put_dimensions(data, uids);
  std::vector<DicomItem> segments;
  for (const auto& [number, label] : volume.names) {
    segments.push_back(segment_item(static_cast<int>(segments.size()) + 1, number, label));
  }
  data.put_items(0x00620002, std::move(segments)).put_items(0x52009229, {shared_groups(geometry)});

  std::vector<int> slices;
  slices.reserve(frames.size());
  for (const Frame& frame : frames) slices.push_back(frame.slice);
  std::sort(slices.begin(), slices.end());
  slices.erase(std::unique(slices.begin(), slices.end()), slices.end());
  std::vector<DicomItem> groups;
  for (const Frame& frame : frames) {
    const auto at = std::lower_bound(slices.begin(), slices.end(), frame.slice) - slices.begin();
    groups.push_back(frame_item(volume, source, frame, static_cast<int>(at) + 1));
  }
  data.put_items(0x52009230, std::move(groups)).put(0x7fe00010, "OB", packed_pixels(volume, frames));
  return dicom_file(data, kSegmentationStorage, uids.instance, true);
}

}  // namespace spinaltap::detail
