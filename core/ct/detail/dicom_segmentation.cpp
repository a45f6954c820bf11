// DICOM segmentations: PS3.3, A.51 and C.8.20.

#include <zlib.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "core/base/error.h"
#include "core/base/text_fields.h"
#include "core/ct/detail/dicom_bytes.h"
#include "core/ct/detail/dicom_codec.h"
#include "core/ct/detail/dicom_segmentation_head.h"

namespace spinaltap::detail {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kDeflatedFrames = "1.2.840.10008.1.2.8.1";
constexpr std::string_view kEncapsulatedPlain = "1.2.840.10008.1.2.1.98";

/// The slices that frames lie in: a grid, and for each frame which of its slices.
struct FrameGrid {
  LabelFile labels;
  std::vector<int> slice_of;
};

Vec3 position_of(const SegmentFrame& frame) {
  return {frame.position_mm[0], frame.position_mm[1], frame.position_mm[2]};
}

/// How far along `heights` (sorted, all different) each lies in whole steps. Most neighbours are one step apart; some
/// are several, where slices between are empty and not stored.
std::vector<int> steps_along(const std::vector<double>& heights, double& step_mm) {
  std::vector<double> gaps;
  for (std::size_t n = 1; n < heights.size(); ++n) gaps.push_back(heights[n] - heights[n - 1]);
  const double min_mm = *std::min_element(gaps.begin(), gaps.end());
  double sum_mm = 0.0;
  int count = 0;
  for (const double gap_mm : gaps) {
    if (gap_mm > 1.5 * min_mm) continue;
    sum_mm += gap_mm;
    ++count;
  }
  step_mm = sum_mm / count;
  std::vector<int> steps{0};
  constexpr double kMaxSteps = 1e6;
  for (const double gap_mm : gaps) {
    const double more = std::min(std::max(1.0, std::round(gap_mm / step_mm)), kMaxSteps);
    steps.push_back(static_cast<int>(std::min(steps.back() + more, kMaxSteps)));
  }
  step_mm = (heights.back() - heights.front()) / steps.back();
  return steps;
}

/// Rejects sizes that the file's bytes cannot hold, before memory is taken for them.
void check_pixels(const DicomSegmentation& seg) {
  constexpr std::uint64_t kMaxShrink = 1032;  // deflate's, which of all codecs here shrinks most
  const std::uint64_t wanted =
      (static_cast<std::uint64_t>(seg.header.rows) * static_cast<std::uint64_t>(seg.header.columns) *
           static_cast<std::uint64_t>(seg.header.bits_allocated) * seg.frames.size() +
       7) /
      8;
  std::uint64_t there = seg.pixels.plain.length;
  if (seg.header.encapsulated) {
    there = 0;
    for (const ByteRange& fragment : seg.pixels.encapsulated.fragments) there += kMaxShrink * fragment.length;
  }
  if (there < wanted) {
    fail("expected ", wanted, " bytes of pixels for ", seg.frames.size(), " frames, found ", there, " in ",
         seg.header.file.string());
  }
}

FrameGrid grid_of(const DicomSegmentation& seg) {
  constexpr double kSame = 1e-3;  // mm, or of a direction's component
  const std::string file = seg.header.file.string();
  const SegmentFrame& first = seg.frames.front();
  const Vec3 along_row(first.orientation[0], first.orientation[1], first.orientation[2]);
  const Vec3 along_column(first.orientation[3], first.orientation[4], first.orientation[5]);
  const Vec3 normal = along_row.cross(along_column);
  if (!(std::abs(along_row.norm() - 1.0) < kSame) || !(std::abs(along_column.norm() - 1.0) < kSame) ||
      !(std::abs(along_row.dot(along_column)) < kSame)) {
    fail("expected ImageOrientationPatient to hold two unit vectors at right angles, found (", along_row.transpose(),
         ") and (", along_column.transpose(), ") in ", file);
  }
  for (const double spacing_mm : first.pixel_spacing_mm) {
    if (!(spacing_mm > 0.0 && spacing_mm < kMaxPixelMm)) {
      fail("expected PixelSpacing above 0 and below ", kMaxPixelMm, " mm, found ", spacing_mm, " in ", file);
    }
  }
  std::vector<double> heights;
  for (const SegmentFrame& frame : seg.frames) {
    const auto differs = [&](const std::vector<double>& a, const std::vector<double>& b) {
      for (std::size_t n = 0; n < a.size(); ++n) {
        if (!(std::abs(a[n] - b[n]) < kSame)) return true;
      }
      return false;
    };
    if (differs(frame.orientation, first.orientation) || differs(frame.pixel_spacing_mm, first.pixel_spacing_mm)) {
      fail("expected frames of one orientation and pixel spacing, found several in ", file);
    }
    if (!position_of(frame).allFinite()) fail("expected positions that are numbers, found others in ", file);
    heights.push_back(normal.dot(position_of(frame)));
  }
  std::vector<double> sorted = heights;
  std::sort(sorted.begin(), sorted.end());
  constexpr double kMinStepMm = 0.01;
  sorted.erase(std::unique(sorted.begin(), sorted.end(), [](double a, double b) { return b - a < kMinStepMm; }),
               sorted.end());
  const auto stated = [&] {
    if (!first.step_mm.empty()) return first.step_mm.front();
    return first.thickness_mm.empty() ? 0.0 : first.thickness_mm.front();
  };
  double step_mm = sorted.size() < 2 ? stated() : 0.0;
  std::vector<int> steps = sorted.size() < 2 ? std::vector<int>{0} : steps_along(sorted, step_mm);
  // Frames that stand nearer to each other than is stated decide; such as stand farther apart leave slices out, which
  // two alone may do.
  const double stated_mm = first.step_mm.empty() ? 0.0 : first.step_mm.front();
  if (sorted.size() >= 2 && stated_mm >= kMinStepMm && step_mm > 1.1 * stated_mm) {
    const double slices_apart = std::round(step_mm / stated_mm);
    const bool fits = std::abs(step_mm - slices_apart * stated_mm) < 0.1 * stated_mm && slices_apart < 1e4;
    if (sorted.size() > 2 || !fits) {
      fail("expected frames that are slices of one grid, found them ", step_mm,
           " mm apart, and SpacingBetweenSlices of ", stated_mm, " mm, in ", file);
    }
    steps.back() = static_cast<int>(slices_apart);
    step_mm /= slices_apart;
  }
  if (!(step_mm >= kMinStepMm)) {
    fail("expected frames at several places, or a spacing between slices, found neither in ", file);
  }
  FrameGrid grid;
  std::size_t lowest = 0, highest = 0;
  for (std::size_t n = 0; n < heights.size(); ++n) {
    const auto place = std::lower_bound(sorted.begin(), sorted.end(), heights[n] - kMinStepMm);
    const auto at = static_cast<std::size_t>(place - sorted.begin());
    grid.slice_of.push_back(steps[std::min(at, steps.size() - 1)]);
    if (heights[n] < heights[lowest]) lowest = n;
    if (heights[n] > heights[highest]) highest = n;
  }
  const Vec3 p_first = position_of(seg.frames[lowest]);
  const int slices = steps.back() + 1;
  // Slices of a tilted gantry drift sideways; a label map may.
  const Vec3 step = slices > 1 ? Vec3((position_of(seg.frames[highest]) - p_first) / steps.back()) : step_mm * normal;
  for (std::size_t n = 0; n < heights.size(); ++n) {
    const double off_mm = (position_of(seg.frames[n]) - p_first - grid.slice_of[n] * step).norm();
    if (!(off_mm < 0.1 * step_mm + 0.05)) {
      fail("expected frames that are slices of one grid, found one ", off_mm, " mm beside it (frame ", n + 1, ") in ",
           file);
    }
  }
  LabelFile& labels = grid.labels;
  labels.origin_mm = p_first;
  // PixelSpacing: from row to row, then from column to column.
  labels.index_to_patient.col(0) = along_row * first.pixel_spacing_mm[1];
  labels.index_to_patient.col(1) = along_column * first.pixel_spacing_mm[0];
  labels.index_to_patient.col(2) = step;
  labels.size = {seg.header.columns, seg.header.rows, slices};
  constexpr std::size_t kMaxVoxels = std::size_t{1} << 30;
  // Slices without frames cost the file nothing: there may be some between bones, and no more.
  const std::size_t max_slices = 1000 + 30 * sorted.size();
  const double volume_mm3 = std::abs(labels.index_to_patient.determinant());
  if (labels.voxel_count() > kMaxVoxels || static_cast<std::size_t>(slices) > max_slices || !(volume_mm3 > 1e-12) ||
      !labels.index_to_patient.allFinite()) {
    fail("expected frames that make a grid of at most ", kMaxVoxels, " voxels with a volume, found ", labels.size[0],
         " x ", labels.size[1], " x ", labels.size[2], " in ", file);
  }
  return grid;
}

/// Two frames of one segment at one place would be put together; one of them may be of another time or segment.
void check_places(const DicomSegmentation& seg, const std::vector<int>& slice_of) {
  std::map<std::pair<std::uint32_t, int>, std::size_t> first;
  for (std::size_t n = 0; n < seg.frames.size(); ++n) {
    const std::uint32_t segment = seg.type == "LABELMAP" ? 0 : seg.frames[n].segment;
    const auto [at, is_new] = first.try_emplace({segment, slice_of[n]}, n);
    if (is_new) continue;
    fail("expected one frame", segment == 0 ? "" : joined(" of segment ", segment), " at a place, found frames ",
         at->second + 1, " and ", n + 1, " there in ", seg.header.file.string());
  }
}

/// As many bytes as are wanted, and some that may be there beyond.
std::vector<char> inflated(const std::vector<char>& packed, std::size_t size, const std::string& file) {
  constexpr std::size_t kBeyond = 16;
  std::vector<char> bytes(size + kBeyond);
  z_stream zlib{};
  if (inflateInit2(&zlib, -MAX_WBITS) != Z_OK) fail("cannot inflate ", file);
  std::vector<char> in = packed;
  zlib.next_in = reinterpret_cast<Bytef*>(in.data());
  zlib.avail_in = static_cast<uInt>(in.size());
  zlib.next_out = reinterpret_cast<Bytef*>(bytes.data());
  zlib.avail_out = static_cast<uInt>(bytes.size());
  static_cast<void>(inflate(&zlib, Z_FINISH));
  bytes.resize(bytes.size() - zlib.avail_out);
  inflateEnd(&zlib);
  if (bytes.size() < size) fail("expected ", size, " bytes of a deflated frame, found fewer in ", file);
  return bytes;
}

/// How many bytes there are behind those that are wanted and the padding to even length.
std::uint64_t beyond(std::uint64_t there, std::uint64_t wanted) { return there - std::min(there, wanted + wanted % 2); }

/// Calls `visit` for each frame with its bytes, and with the bit of the first byte that its first pixel is. Gives how
/// many bytes lie beyond those that the sizes take, of encapsulated frames in one of them.
std::uint64_t for_each_frame(const DicomSegmentation& seg,
                             const std::function<void(std::size_t, const std::vector<char>&, std::size_t)>& visit) {
  const DicomHeader& header = seg.header;
  const std::string file = header.file.string();
  const std::uint64_t pixels = static_cast<std::uint64_t>(header.rows) * static_cast<std::uint64_t>(header.columns);
  const auto bits = static_cast<std::uint64_t>(header.bits_allocated);
  const std::uint64_t frame_size = (pixels * bits + 7) / 8;
  if (header.encapsulated) {
    const bool is_deflated = header.transfer_syntax == kDeflatedFrames;
    const bool is_plain = header.transfer_syntax == kEncapsulatedPlain;
    if (!is_deflated && !is_plain &&
        (header.bits_allocated == 1 || !is_compressed_syntax(header.transfer_syntax) ||
         !is_known_syntax(header.transfer_syntax))) {
      fail(
          "expected segments' pixels plain, deflated, or for bytes in RLE, JPEG-LS or JPEG 2000, found transfer "
          "syntax ",
          in_quotes(header.transfer_syntax), " in ", file, " (gdcmconv makes them plain)");
    }
    DicomFrameGroups groups;
    groups.frame_count = {static_cast<double>(seg.frames.size())};
    const std::vector<DicomHeader> frames = split_into_frames(header, groups, seg.pixels);
    std::uint64_t max_surplus = 0;
    for (std::size_t n = 0; n < frames.size(); ++n) {
      if (!is_deflated && !is_plain) {
        visit(n, decompress_frame(frames[n]), 0);
        continue;
      }
      std::vector<char> bytes;
      for (const std::vector<char>& part : read_fragments(frames[n]))
        bytes.insert(bytes.end(), part.begin(), part.end());
      if (is_deflated) bytes = inflated(bytes, frame_size, file);
      if (bytes.size() < frame_size) fail("expected ", frame_size, " bytes a frame, found fewer in ", file);
      max_surplus = std::max(max_surplus, beyond(bytes.size(), frame_size));
      visit(n, bytes, 0);
    }
    return max_surplus;
  }
  // Frames of single bits follow each other without a gap: PS3.5, 8.1.1.
  DicomBytes stream;
  bool is_there = stream.open(header.file);
  if (is_there && header.deflated_at) {
    is_there = stream.skip(*header.deflated_at);
    stream.inflate_from_here();
  }
  is_there = is_there && stream.skip(seg.pixels.plain.offset - stream.position());
  std::vector<char> bytes;
  std::uint64_t held_from = 0;  // the byte of the pixels that bytes.front() is
  for (std::size_t n = 0; n < seg.frames.size(); ++n) {
    const std::uint64_t from = n * pixels * bits / 8;
    const std::uint64_t to = ((n + 1) * pixels * bits + 7) / 8;
    // The byte that two frames share is read once.
    const std::uint64_t held_to = held_from + bytes.size();
    std::vector<char> next(bytes.end() - static_cast<std::ptrdiff_t>(held_to - std::min(held_to, from)), bytes.end());
    const std::size_t kept = next.size();
    next.resize(to - from);
    is_there = is_there && stream.read(next.data() + kept, next.size() - kept);
    if (!is_there) fail("cannot read the pixels of ", file);
    bytes = std::move(next);
    held_from = from;
    visit(n, bytes, static_cast<std::size_t>(n * pixels * bits % 8));
  }
  const std::uint64_t wanted = (seg.frames.size() * pixels * bits + 7) / 8;
  return beyond(seg.pixels.plain.length, wanted);
}

}  // namespace

LabelFile read_dicom_segmentation(const fs::path& file, std::optional<long long> only,
                                  const std::function<void(const LabelFile&)>& begin, const TakeLabels& take) {
  const DicomSegmentation seg = read_segmentation_head(file);
  check_pixels(seg);
  FrameGrid grid = grid_of(seg);
  check_places(seg, grid.slice_of);
  const bool is_map = seg.type == "LABELMAP";
  const bool is_binary = seg.type == "BINARY";
  const bool is_wide = seg.header.bits_allocated == 16;
  std::map<long long, std::string> names;
  std::vector<bool> is_described(65536, false);
  for (const DicomSegment& segment : seg.segments) {
    is_described[static_cast<std::size_t>(segment.number)] = true;
    if (segment.number == 0) continue;
    names[segment.number] = name_of_segment(segment, file);
    if (std::optional<std::string> doubt = doubt_of_segment(segment)) grid.labels.warnings.push_back(*std::move(doubt));
  }
  // Numbers of other types count from 1: PS3.3, C.8.20.4.
  grid.labels.numbers_are_ranks = !is_map;
  if (begin) begin(grid.labels);
  LabelPainter painter(grid.labels.voxel_count(), names);
  const std::size_t pixels =
      static_cast<std::size_t>(grid.labels.size[0]) * static_cast<std::size_t>(grid.labels.size[1]);
  const auto check_described = [&](std::uint32_t value) {
    if (is_described[value]) return;
    fail("expected pixels of the segments that the file describes, found one of segment ", value, " in ",
         file.string());
  };
  const std::uint32_t background = is_map ? seg.header.padding.value_or(0) : 0;
  const auto take_frame = [&](std::size_t n, const std::vector<char>& bytes, std::size_t first_bit) {
    const std::uint32_t segment = seg.frames[n].segment;
    if (!is_map && only && *only != static_cast<long long>(segment)) return;
    const std::size_t at = pixels * static_cast<std::size_t>(grid.slice_of[n]);
    const auto byte = [&](std::size_t p) { return static_cast<unsigned char>(bytes[p]); };
    for (std::size_t p = 0; p < pixels; ++p) {
      if (is_binary) {
        const std::size_t bit = first_bit + p;
        if (bit % 8 == 0 && byte(bit / 8) == 0) {
          p += 7;  // most bytes hold none
        } else if ((byte(bit / 8) >> (bit % 8) & 1) != 0) {
          painter.put(at + p, static_cast<std::uint16_t>(segment));
        }
      } else if (is_map) {
        const std::uint32_t value = is_wide ? static_cast<std::uint32_t>(byte(2 * p) | byte(2 * p + 1) << 8) : byte(p);
        if (value == background || value == 0) continue;
        check_described(value);
        if (only && *only != value) continue;
        painter.put(at + p, static_cast<std::uint16_t>(value));
      } else if (byte(p) > seg.max_fraction) {
        fail("expected values of at most MaximumFractionalValue, ", seg.max_fraction, ", found ", int{byte(p)}, " in ",
             file.string());
      } else if (byte(p) != 0 && 2U * byte(p) >= seg.max_fraction) {
        const std::uint32_t part = 255U * byte(p) / seg.max_fraction;
        painter.put(at + p, static_cast<std::uint16_t>(segment), static_cast<std::uint8_t>(part));
      }
    }
  };
  if (const std::uint64_t surplus = for_each_frame(seg, take_frame); surplus > 0) {
    grid.labels.warnings.push_back(
        joined("PixelData of the label map is longer than Rows, Columns and NumberOfFrames say, by ", surplus,
               " bytes: its sizes may be wrong"));
  }
  painter.check_shared(file);
  painter.give_to(take);
  grid.labels.names = std::move(names);
  return grid.labels;
}

}  // namespace spinaltap::detail
