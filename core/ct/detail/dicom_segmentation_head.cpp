#include "core/ct/detail/dicom_segmentation_head.h"

#include "core/base/error.h"
#include "core/base/text_fields.h"
#include "core/ct/detail/dicom_values.h"

namespace spinaltap::detail {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMaxFrames = 200'000;

/// The elements of groups that we know have tags of their own: which group one stands in tells nothing more.
void take_group(DicomElementWalker& walker, const DicomElement& element, SegmentFrame& group) {
  switch (element.tag) {
    case 0x00200032:
      group.position_mm = dicom_decimals(walker.value(element));
      return;
    case 0x00200037:
      group.orientation = dicom_decimals(walker.value(element));
      return;
    case 0x00280030:
      group.pixel_spacing_mm = dicom_decimals(walker.value(element));
      return;
    case 0x00180088:
      group.step_mm = dicom_decimals(walker.value(element));
      return;
    case 0x00180050:
      group.thickness_mm = dicom_decimals(walker.value(element));
      return;
    case 0x0062000b:
      group.segment = dicom_unsigned(walker.value(element), walker.is_big_endian());
      return;
    default:
      walker.skip(element);
  }
}

bool is_wanted_group(std::uint32_t tag) {
  return tag == 0x00209113 || tag == 0x00209116 || tag == 0x00289110 || tag == 0x0062000a;
}

void read_groups(DicomElementWalker& walker, const DicomElement& sequence,
                 const std::function<SegmentFrame&(std::size_t)>& group_of) {
  walker.items(sequence, [&](std::size_t item, const DicomElement& macro) {
    if (!is_wanted_group(macro.tag)) return walker.skip(macro);
    walker.items(macro, [&](std::size_t, const DicomElement& element) { take_group(walker, element, group_of(item)); });
  });
}

void read_segments(DicomElementWalker& walker, const DicomElement& sequence, std::vector<DicomSegment>& segments) {
  constexpr std::size_t kMaxSegments = 65535;
  walker.items(sequence, [&](std::size_t item, const DicomElement& element) {
    if (item >= kMaxSegments) fail("expected at most ", kMaxSegments, " segments, found more");
    if (segments.size() <= item) segments.resize(item + 1);
    DicomSegment& segment = segments[item];
    switch (element.tag) {
      case 0x00620004:
        segment.number = dicom_unsigned(walker.value(element), walker.is_big_endian());
        return;
      case 0x00620005:
        segment.label = dicom_text(walker.value(element));
        return;
      case 0x00620006:
        segment.description = dicom_text(walker.value(element));
        return;
      case 0x0062000f:
        segment.type = read_code(walker, element);
        return;
      case 0x00082218:
        segment.region = read_code(walker, element);
        return;
      default:
        walker.skip(element);
    }
  });
}

DicomSegmentation read_head(const fs::path& file) {
  DicomSegmentation seg;
  DicomElementWalker walker;
  if (!walker.open(file)) fail("expected a DICOM file, found one that is not: ", file.string());
  DicomHeader& header = seg.header;
  header.file = file;
  const auto number = [&](const DicomElement& element) {
    return dicom_unsigned(walker.value(element), walker.is_big_endian());
  };
  const auto small = [&](const DicomElement& element) { return static_cast<int>(std::min(number(element), 65535U)); };
  for (DicomElement element; !seg.has_pixels && walker.next(element);) {
    switch (element.tag) {
      case 0x00020010:
        header.transfer_syntax = dicom_text(walker.value(element));
        walker.set_transfer_syntax(header.transfer_syntax);
        break;
      case 0x00280002:
        header.samples = small(element);
        break;
      case 0x00280008:
        seg.frame_count = dicom_decimals(walker.value(element));
        break;
      case 0x00280010:
        header.rows = small(element);
        break;
      case 0x00280011:
        header.columns = small(element);
        break;
      case 0x00280100:
        header.bits_allocated = small(element);
        break;
      case 0x00280101:
        header.bits_stored = small(element);
        break;
      case 0x00280102:
        header.high_bit = small(element);
        break;
      case 0x00280120:
        header.padding = number(element);
        break;
      case 0x00620001:
        seg.type = dicom_text(walker.value(element));
        break;
      case 0x00620002:
        read_segments(walker, element, seg.segments);
        break;
      case 0x0062000e:
        seg.max_fraction = number(element);
        break;
      case 0x52009229:
        read_groups(walker, element, [&](std::size_t) -> SegmentFrame& { return seg.shared; });
        break;
      case 0x52009230:
        read_groups(walker, element, [&](std::size_t item) -> SegmentFrame& {
          if (item >= kMaxFrames) fail("expected at most ", kMaxFrames, " frames, found more in ", file.string());
          if (seg.frames.size() <= item) seg.frames.resize(item + 1);
          return seg.frames[item];
        });
        break;
      case 0x7fe00010:
        seg.has_pixels = true;
        header.encapsulated = element.undefined_length;
        header.big_endian = walker.is_big_endian();
        if (walker.is_deflated()) header.deflated_at = walker.data_set_offset();
        if (header.encapsulated) {
          seg.pixels.encapsulated = walker.fragments();
        } else {
          seg.pixels.plain = {element.offset, element.length};
        }
        break;
      default:
        walker.skip(element);
    }
  }
  return seg;
}

/// Frames with what all share, checked: each has a place, a segment and pixels.
void check_head(DicomSegmentation& seg) {
  const DicomHeader& header = seg.header;
  const std::string file = header.file.string();
  const bool is_binary = seg.type == "BINARY";
  const bool is_map = seg.type == "LABELMAP";
  if (!is_binary && !is_map && seg.type != "FRACTIONAL") {
    fail("expected a DICOM segmentation of type BINARY, FRACTIONAL or LABELMAP, found ", in_quotes(seg.type), " in ",
         file);
  }
  const int bits = header.bits_allocated;
  const bool fits = is_binary ? bits == 1 : is_map ? bits == 8 || bits == 16 : bits == 8;
  if (!fits || header.samples != 1 || header.rows < 1 || header.columns < 1) {
    fail("expected pixels of ",
         is_binary ? "1 bit"
         : is_map  ? "8 or 16 bits"
                   : "8 bits",
         " for a segmentation of type ", seg.type, ", found ", header.columns, " x ", header.rows, " x ",
         header.samples, " of ", bits, " in ", file);
  }
  // Type 1C: without it nobody knows what half is.
  if (!is_binary && !is_map && (seg.max_fraction < 1 || seg.max_fraction > 255)) {
    fail("expected a MaximumFractionalValue from 1 to 255, found ", seg.max_fraction, " in ", file);
  }
  const double stated = seg.frame_count.empty() ? 1.0 : seg.frame_count.front();
  if (seg.frames.empty() && stated == 1.0) seg.frames.resize(1);
  if (!seg.has_pixels || stated != static_cast<double>(seg.frames.size())) {
    fail("expected ", seg.frames.size(), " frames with pixels, as there are functional groups, found NumberOfFrames ",
         stated, seg.has_pixels ? "" : " and no pixels", " in ", file);
  }
  if (header.big_endian) fail("expected a segmentation in little endian, found a big endian one (retired): ", file);
  std::map<long long, int> known;
  for (const DicomSegment& segment : seg.segments) {
    if (segment.number > 65535 || (segment.number == 0 && !is_map)) {
      fail("expected segment numbers from 1 to 65535, found ", segment.number, " in ", file);
    }
    if (++known[segment.number] > 1) fail("expected one segment a number, found two of ", segment.number, " in ", file);
  }
  for (SegmentFrame& frame : seg.frames) {
    const auto or_shared = [&](std::vector<double> SegmentFrame::*part) {
      if ((frame.*part).empty()) frame.*part = seg.shared.*part;
    };
    or_shared(&SegmentFrame::position_mm);
    or_shared(&SegmentFrame::orientation);
    or_shared(&SegmentFrame::pixel_spacing_mm);
    or_shared(&SegmentFrame::step_mm);
    or_shared(&SegmentFrame::thickness_mm);
    if (frame.segment == 0) frame.segment = seg.shared.segment;
    if (!is_map && !known.contains(frame.segment)) {
      fail("expected frames of the segments that the file describes, found one of segment ", frame.segment, " in ",
           file);
    }
    if (frame.position_mm.size() != 3 || frame.orientation.size() != 6 || frame.pixel_spacing_mm.size() != 2) {
      fail("expected a position, an orientation and a pixel spacing for each frame, found none in ", file);
    }
  }
}

}  // namespace

DicomSegmentation read_segmentation_head(const fs::path& file) {
  DicomSegmentation seg = read_head(file);
  check_head(seg);
  return seg;
}

}  // namespace spinaltap::detail
