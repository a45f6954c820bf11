#include "core/ct/detail/dicom_frames.h"

#include <algorithm>

#include "core/base/error.h"
#include "core/ct/detail/dicom_values.h"

namespace spinaltap {
namespace {

// More than any CT has; each costs some memory before its pixels are looked at.
constexpr std::size_t kMaxFrames = 20000;

void take_from_group(DicomElementWalker& walker, const DicomElement& element, DicomFrame& frame) {
  switch (element.tag) {
    case 0x00200032:
      frame.position_mm = dicom_decimals(walker.value(element));
      return;
    case 0x00200037:
      frame.orientation = dicom_decimals(walker.value(element));
      return;
    case 0x00089007:
      frame.image_type = dicom_text(walker.value(element));
      return;
    case 0x00180060:
      frame.kvp = dicom_text(walker.value(element));
      return;
    case 0x00181210:
      frame.kernel = dicom_text(walker.value(element));
      return;
    case 0x00189074:
      frame.acquisition_time = dicom_text(walker.value(element));
      return;
    case 0x00209128:
      frame.temporal_position = std::to_string(dicom_unsigned(walker.value(element), walker.is_big_endian()));
      return;
    case 0x00209156:
      frame.acquisition_number = std::to_string(dicom_unsigned(walker.value(element), walker.is_big_endian()));
      return;
    case 0x00209241:
      frame.cardiac_phase = dicom_text(walker.value(element));
      return;
    case 0x00281054:
      frame.rescale_type = dicom_text(walker.value(element));
      return;
    case 0x00209056:
      frame.stack_id = dicom_text(walker.value(element));
      return;
    case 0x00280030:
      frame.pixel_spacing_mm = dicom_decimals(walker.value(element));
      return;
    case 0x00281052:
      frame.rescale_intercept = dicom_decimals(walker.value(element));
      return;
    case 0x00281053:
      frame.rescale_slope = dicom_decimals(walker.value(element));
      return;
    default:
      walker.skip(element);
  }
}

bool is_wanted_group(std::uint32_t tag) {
  return tag == 0x00209113 || tag == 0x00209116 || tag == 0x00209111 || tag == 0x00289110 || tag == 0x00289145 ||
         tag == 0x00189314 || tag == 0x00189325 || tag == 0x00189329 || tag == 0x00189118;
}

void overlay(const DicomFrame& from, DicomFrame& to) {
  if (!from.position_mm.empty()) to.position_mm = from.position_mm;
  if (!from.orientation.empty()) to.orientation = from.orientation;
  if (!from.pixel_spacing_mm.empty()) to.pixel_spacing_mm = from.pixel_spacing_mm;
  if (!from.rescale_slope.empty()) to.rescale_slope = from.rescale_slope;
  if (!from.rescale_intercept.empty()) to.rescale_intercept = from.rescale_intercept;
  const auto take = [&](std::string DicomFrame::*text) {
    if (!(from.*text).empty()) to.*text = from.*text;
  };
  for (const auto text : {&DicomFrame::rescale_type, &DicomFrame::stack_id, &DicomFrame::image_type,
                          &DicomFrame::kernel, &DicomFrame::kvp, &DicomFrame::acquisition_number,
                          &DicomFrame::acquisition_time, &DicomFrame::temporal_position, &DicomFrame::cardiac_phase}) {
    take(text);
  }
}

/// As the file states it; 0 where it states too much.
std::uint64_t stated_frame_bytes(const DicomHeader& file) {
  constexpr int kMaxPixels = 65535;  // along a side: Rows and Columns have 16 bits
  if (file.columns > kMaxPixels || file.rows > kMaxPixels || file.samples > 4 || file.bits_allocated > 64) return 0;
  return static_cast<std::uint64_t>(std::max(file.columns, 0)) * static_cast<std::uint64_t>(std::max(file.rows, 0)) *
         static_cast<std::uint64_t>(std::max(file.samples, 0)) *
         static_cast<std::uint64_t>(std::max(file.bits_allocated, 0) / 8);
}

/// Which fragments make which frame: one each, or as the offset table says (PS3.5, A.4).
std::vector<std::vector<ByteRange>> share_out(const DicomFragments& pixels, std::size_t frames,
                                              const DicomHeader& file) {
  std::vector<std::vector<ByteRange>> shares(frames);
  if (frames == 1) {
    shares.front() = pixels.fragments;
    return shares;
  }
  if (pixels.fragments.size() == frames) {
    for (std::size_t n = 0; n < frames; ++n) shares[n] = {pixels.fragments[n]};
    return shares;
  }
  const bool is_sorted = std::is_sorted(pixels.frames_at.begin(), pixels.frames_at.end());
  if (pixels.frames_at.size() != frames || !is_sorted || pixels.frames_at.front() != 0) {
    fail("expected ", frames, " compressed frames, found ", pixels.fragments.size(),
         " fragments and an offset table of ", pixels.frames_at.size(), " in ", file.file.string());
  }
  constexpr std::uint64_t kItemHead = 8;  // tag and length before a fragment
  for (const ByteRange& fragment : pixels.fragments) {
    const std::uint64_t at = fragment.offset - kItemHead - pixels.start;
    const auto after = std::upper_bound(pixels.frames_at.begin(), pixels.frames_at.end(), at);
    shares[static_cast<std::size_t>(after - pixels.frames_at.begin()) - 1].push_back(fragment);
  }
  return shares;
}

std::size_t frame_count(const DicomHeader& file, const std::vector<double>& stated) {
  if (stated.empty()) return 1;
  const double count = stated.front();
  if (!(count >= 1.0) || !(count <= static_cast<double>(kMaxFrames)) ||
      count != static_cast<double>(static_cast<std::size_t>(count))) {
    fail("expected 1 to ", kMaxFrames, " frames, found NumberOfFrames ", count, " in ", file.file.string());
  }
  return static_cast<std::size_t>(count);
}

}  // namespace

std::vector<DicomFrame> read_functional_groups(DicomElementWalker& walker, const DicomElement& sequence) {
  std::vector<DicomFrame> frames;
  walker.items(sequence, [&](std::size_t item, const DicomElement& group) {
    if (item >= kMaxFrames) fail("expected functional groups of at most ", kMaxFrames, " frames, found more");
    if (frames.size() <= item) frames.resize(item + 1);
    if (!is_wanted_group(group.tag)) return walker.skip(group);
    walker.items(group,
                 [&](std::size_t, const DicomElement& element) { take_from_group(walker, element, frames[item]); });
  });
  return frames;
}

std::vector<DicomHeader> split_into_frames(const DicomHeader& file, const DicomFrameGroups& groups,
                                           const DicomPixelData& pixels) {
  const std::size_t frames = frame_count(file, groups.frame_count);
  if (!groups.per_frame.empty() && groups.per_frame.size() != frames) {
    fail("expected functional groups of ", frames, " frames, found those of ", groups.per_frame.size(), " in ",
         file.file.string());
  }
  const std::uint64_t bytes = stated_frame_bytes(file);
  std::vector<std::vector<ByteRange>> shares;
  if (file.encapsulated) {
    shares = share_out(pixels.encapsulated, frames, file);
  } else if (frames > 1 && (bytes == 0 || pixels.plain.length / bytes < frames)) {
    fail("expected ", frames, " frames of ", bytes, " bytes, found ", pixels.plain.length, " bytes of pixels in ",
         file.file.string());
  }
  const std::uint64_t surplus =
      file.encapsulated || pixels.plain.length <= frames * bytes ? 0 : pixels.plain.length - frames * bytes;
  std::vector<DicomHeader> headers(frames, file);
  for (std::size_t n = 0; n < frames; ++n) {
    DicomHeader& header = headers[n];
    header.frame = static_cast<int>(n);
    header.frames = static_cast<int>(frames);
    header.surplus_bytes = surplus;
    if (!groups.shared.empty()) overlay(groups.shared.front(), header);
    if (!groups.per_frame.empty()) overlay(groups.per_frame[n], header);
    if (file.encapsulated) {
      header.pixels = std::move(shares[n]);
    } else if (pixels.plain.offset != 0) {
      header.pixels = {frames == 1 ? pixels.plain : ByteRange{pixels.plain.offset + n * bytes, bytes}};
    }
  }
  return headers;
}

}  // namespace spinaltap
