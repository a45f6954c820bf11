#pragma once

#include <cstdint>
#include <initializer_list>
#include <map>
#include <string>
#include <vector>

#include "core/base/geometry.h"

namespace spinaltap::test {

/// A DICOM data set put together byte by byte, sequences included, so that tests of the readers do not rest on our own
/// writer. Explicit little endian; sequences and items of undefined length where `is_open`.
class MadeItem {
 public:
  MadeItem& put(std::uint32_t tag, const std::string& vr, std::string value) {
    if (value.size() % 2 != 0) value.push_back(vr == "UI" || vr == "OB" ? '\0' : ' ');
    elements_[tag] = {vr, value, false};
    return *this;
  }
  MadeItem& put_short(std::uint32_t tag, int value) { return put(tag, "US", little_endian(value, 2)); }
  MadeItem& put_items(std::uint32_t tag, const std::vector<MadeItem>& items, bool is_open = false) {
    std::string inside;
    for (const MadeItem& item : items) {
      const std::string content = item.bytes();
      inside +=
          tag_bytes(0xfffee000) + little_endian(is_open ? -1 : static_cast<long long>(content.size()), 4) + content;
      if (is_open) inside += tag_bytes(0xfffee00d) + little_endian(0, 4);
    }
    if (is_open) inside += tag_bytes(0xfffee0dd) + little_endian(0, 4);
    elements_[tag] = {"SQ", inside, is_open};
    return *this;
  }
  MadeItem& put_code(std::uint32_t tag, const std::string& value, const std::string& scheme) {
    return put_items(tag, {MadeItem().put(0x00080100, "SH", value).put(0x00080102, "SH", scheme)});
  }
  MadeItem& remove(std::uint32_t tag) {
    elements_.erase(tag);
    return *this;
  }

  std::string bytes() const {
    std::string all;
    for (const auto& [tag, element] : elements_) {
      const bool is_long = element.vr == "OB" || element.vr == "OW" || element.vr == "SQ" || element.vr == "UN";
      const auto length = element.is_open ? -1 : static_cast<long long>(element.value.size());
      all +=
          tag_bytes(tag) + element.vr + (is_long ? std::string(2, '\0') : "") + little_endian(length, is_long ? 4 : 2);
      all += element.value;
    }
    return all;
  }

  /// With the preamble and group 0002 in front.
  std::string file(const std::string& transfer_syntax = "1.2.840.10008.1.2.1") const {
    const std::string meta = MadeItem().put(0x00020010, "UI", transfer_syntax).bytes();
    return std::string(128, '\0') + "DICM" +
           MadeItem().put(0x00020000, "UL", little_endian(static_cast<long long>(meta.size()), 4)).bytes() + meta +
           bytes();
  }

  static std::string little_endian(long long value, int count) {
    std::string bytes;
    for (int n = 0; n < count; ++n) bytes.push_back(static_cast<char>(value >> (8 * n) & 0xff));
    return bytes;
  }

 private:
  struct Element {
    std::string vr, value;
    bool is_open = false;
  };
  static std::string tag_bytes(std::uint32_t tag) {
    return little_endian(tag >> 16, 2) + little_endian(tag & 0xffff, 2);
  }

  std::map<std::uint32_t, Element> elements_;
};

inline std::string numbers_text(std::initializer_list<double> numbers) {
  std::string text;
  for (const double number : numbers) text += (text.empty() ? "" : "\\") + std::to_string(number);
  return text;
}

/// A DICOM segmentation of 5 x 3 pixels (15 bits: frames of single bits begin within bytes) of 1.0 x 0.5 mm, axial.
struct MadeSegmentation {
  struct Segment {
    int number = 1;
    std::string label;
    std::string code, scheme;                ///< SegmentedPropertyTypeCodeSequence
    std::string region, region_scheme = {};  ///< AnatomicRegionSequence
  };
  struct Frame {
    int segment = 1;
    Vec3 p_mm = Vec3::Zero();
    std::vector<int> pixels;  ///< 15, rows one after the other
  };
  std::string type = "BINARY";
  int bits = 1;
  int max_fraction = 255;
  int background = -1;  ///< PixelPaddingValue; -1: none
  double step_mm = 2.0;
  bool is_open = false;  ///< undefined lengths
  std::vector<Segment> segments;
  std::vector<Frame> frames;

  MadeItem data_set() const {
    std::vector<MadeItem> described, groups;
    for (const Segment& segment : segments) {
      MadeItem item;
      item.put_short(0x00620004, segment.number).put(0x00620005, "LO", segment.label);
      if (!segment.code.empty()) item.put_code(0x0062000f, segment.code, segment.scheme);
      if (!segment.region.empty()) item.put_code(0x00082218, segment.region, segment.region_scheme);
      described.push_back(item);
    }
    std::vector<int> stored;
    for (const Frame& frame : frames) {
      MadeItem group;
      group.put_items(0x00209113, {MadeItem().put(0x00200032, "DS",
                                                  numbers_text({frame.p_mm.x(), frame.p_mm.y(), frame.p_mm.z()}))});
      if (type != "LABELMAP") {
        group.put_items(0x0062000a, {MadeItem().put_short(0x0062000b, frame.segment)}, is_open);
      }
      groups.push_back(group);
      stored.insert(stored.end(), frame.pixels.begin(), frame.pixels.end());
    }
    std::string pixels((stored.size() * static_cast<std::size_t>(bits) + 7) / 8, '\0');
    for (std::size_t n = 0; n < stored.size(); ++n) {
      if (bits == 1) pixels[n / 8] = static_cast<char>(pixels[n / 8] | stored[n] << (n % 8));
      if (bits == 8) pixels[n] = static_cast<char>(stored[n]);
      if (bits == 16) pixels.replace(2 * n, 2, MadeItem::little_endian(stored[n], 2));
    }
    MadeItem shared;
    shared.put_items(0x00209116, {MadeItem().put(0x00200037, "DS", "1\\0\\0\\0\\1\\0")}, is_open)
        .put_items(0x00289110,
                   {MadeItem().put(0x00180088, "DS", std::to_string(step_mm)).put(0x00280030, "DS", "0.5\\1.0")});
    MadeItem data;
    data.put(0x00080016, "UI", std::string("1.2.840.10008.5.1.4.1.1.66.") + (type == "LABELMAP" ? "7" : "4"))
        .put(0x00080060, "CS", "SEG")
        .put_short(0x00280002, 1)
        .put(0x00280008, "IS", std::to_string(frames.size()))
        .put_short(0x00280010, 3)
        .put_short(0x00280011, 5)
        .put_short(0x00280100, bits)
        .put_short(0x00280101, bits)
        .put_short(0x00280102, bits - 1)
        .put(0x00620001, "CS", type)
        .put_items(0x00620002, described, is_open)
        .put_items(0x52009229, {shared}, is_open)
        .put_items(0x52009230, groups, is_open)
        .put(0x7fe00010, bits == 16 ? "OW" : "OB", pixels);
    if (type == "FRACTIONAL") data.put_short(0x0062000e, max_fraction);
    if (background >= 0) data.put_short(0x00280120, background);
    return data;
  }
  std::string bytes() const { return data_set().file(); }
};

/// A DICOM structure set.
struct MadeStructureSet {
  struct Roi {
    int number = 1;
    std::string name;
    std::vector<std::vector<Vec3>> contours;  ///< patient LPS, mm
    std::string type = "CLOSED_PLANAR";
    std::string code = {};    ///< of SNOMED CT
    int points_too_many = 0;  ///< that NumberOfContourPoints counts
  };
  std::vector<Roi> rois;

  std::string bytes() const {
    std::vector<MadeItem> described, shapes, observed;
    for (const Roi& roi : rois) {
      const std::string number = std::to_string(roi.number);
      described.push_back(MadeItem().put(0x30060022, "IS", number).put(0x30060026, "LO", roi.name));
      std::vector<MadeItem> contours;
      for (const std::vector<Vec3>& contour : roi.contours) {
        std::string points;
        for (const Vec3& p : contour) points += (points.empty() ? "" : "\\") + numbers_text({p.x(), p.y(), p.z()});
        contours.push_back(
            MadeItem()
                .put(0x30060042, "CS", roi.type)
                .put(0x30060046, "IS", std::to_string(static_cast<int>(contour.size()) + roi.points_too_many))
                .put(0x30060050, "UN", points));  // longer than DS can be with an explicit length
      }
      shapes.push_back(MadeItem().put_items(0x30060040, contours).put(0x30060084, "IS", number));
      MadeItem observation;
      observation.put(0x30060084, "IS", number);
      if (!roi.code.empty()) observation.put_code(0x30060086, roi.code, "SCT");
      observed.push_back(observation);
    }
    return MadeItem()
        .put(0x00080016, "UI", "1.2.840.10008.5.1.4.1.1.481.3")
        .put(0x00080060, "CS", "RTSTRUCT")
        .put_items(0x30060020, described)
        .put_items(0x30060039, shapes)
        .put_items(0x30060080, observed)
        .file();
  }
};

}  // namespace spinaltap::test
