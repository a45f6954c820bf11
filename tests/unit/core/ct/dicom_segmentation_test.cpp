// Label maps as DICOM segmentations, read: files put together byte by byte.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "core/base/staged_output.h"
#include "core/ct/label_map.h"
#include "core/ct/label_volume.h"
#include "tests/support/error_of.h"
#include "tests/support/made_dicom_labels.h"
#include "tests/support/temporary_folder.h"

namespace spinaltap {
namespace {

using test::error_of;
using test::MadeSegmentation;
using test::TemporaryFolder;
using testing::HasSubstr;

/// Voxels of MadeSegmentation's grid, slices at z = 10, 12, 14, ...
GridGeometry seg_grid(int slices = 4) {
  GridGeometry geometry;
  geometry.size = {5, 3, slices};
  geometry.spacing_mm = Vec3(1.0, 0.5, 2.0);
  geometry.origin_mm = Vec3(-20.0, 30.0, 10.0);
  return geometry;
}

Vec3 slice_at(int k) { return {-20.0, 30.0, 10.0 + 2.0 * k}; }

/// 15 pixels with `value` at (i, j).
std::vector<int> pixel_at(int i, int j, int value = 1) {
  std::vector<int> pixels(15, 0);
  pixels[static_cast<std::size_t>(5 * j + i)] = value;
  return pixels;
}

/// L3 at (1, 1) of slices 0 and 3, L4 at (4, 2) of slice 1, in no order; slice 2 is empty and not stored.
MadeSegmentation two_segments() {
  MadeSegmentation seg;
  seg.segments = {{1, "", "36470004", "SCT", ""}, {2, "L4", "", "", ""}};
  seg.frames = {{2, slice_at(1), pixel_at(4, 2)}, {1, slice_at(3), pixel_at(1, 1)}, {1, slice_at(0), pixel_at(1, 1)}};
  return seg;
}

LabelVolume read_seg(const std::string& bytes, const GridGeometry& grid = seg_grid()) {
  const TemporaryFolder folder;
  write_whole_file(folder.path() / "map.dcm", bytes);
  return read_label_volume(folder.path() / "map.dcm", grid);
}

std::string seg_error(const MadeSegmentation& seg) {
  return error_of([&] { read_seg(seg.bytes()); });
}

Level level_at(const LabelVolume& map, int i, int j, int k) {
  const int label = map.labels[map.geometry.offset(i, j, k)];
  return label == 0 ? Level::kNone : map.names.at(label).level;
}

std::ptrdiff_t labelled(const LabelVolume& map) {
  return std::count_if(map.labels.begin(), map.labels.end(), [](std::uint8_t label) { return label != 0; });
}

TEST(DicomSegmentation, IsReadWithFramesInAnyOrderAndSlicesLeftOut) {
  for (const bool is_open : {false, true}) {
    MadeSegmentation seg = two_segments();
    seg.is_open = is_open;
    const LabelVolume map = read_seg(seg.bytes());
    EXPECT_EQ(level_at(map, 1, 1, 0), *level_from_name("L3"));
    EXPECT_EQ(level_at(map, 1, 1, 3), *level_from_name("L3"));
    EXPECT_EQ(level_at(map, 4, 2, 1), *level_from_name("L4"));
    EXPECT_EQ(labelled(map), 3);
  }
}

TEST(DicomSegmentation, IsPlacedByItsFramesOnAnyGrid) {
  GridGeometry shifted = seg_grid();
  shifted.origin_mm += Vec3(1.0, 0.5, 2.0);
  const LabelVolume map = read_seg(two_segments().bytes(), shifted);
  EXPECT_EQ(level_at(map, 0, 0, 2), *level_from_name("L3"));
  EXPECT_EQ(level_at(map, 3, 1, 0), *level_from_name("L4"));
  EXPECT_EQ(labelled(map), 2);
}

TEST(DicomSegmentation, OfATiltedGantryKeepsItsLean) {
  MadeSegmentation seg = two_segments();
  for (auto& frame : seg.frames) frame.p_mm.y() += 0.25 * (frame.p_mm.z() - 10.0);  // one pixel a slice
  const LabelVolume map = read_seg(seg.bytes());
  EXPECT_EQ(level_at(map, 1, 1, 0), *level_from_name("L3"));
  EXPECT_EQ(labelled(map), 1);  // the others drifted off this grid
}

TEST(DicomSegmentation, OfOneFrameTakesItsStatedStep) {
  MadeSegmentation seg = two_segments();
  seg.frames.resize(1);
  EXPECT_EQ(level_at(read_seg(seg.bytes()), 4, 2, 1), *level_from_name("L4"));
  seg.step_mm = 0.0;
  EXPECT_THAT(seg_error(seg), HasSubstr("spacing between slices"));
}

TEST(DicomSegmentation, OfTwoFramesFarApartLeavesTheSlicesBetweenEmpty) {
  MadeSegmentation seg = two_segments();
  seg.frames.erase(seg.frames.begin());  // slices 0 and 3 are left
  EXPECT_EQ(labelled(read_seg(seg.bytes())), 2);
  seg.step_mm = 4.0;  // not stated for thirds of 6 mm
  EXPECT_THAT(seg_error(seg), HasSubstr("6 mm apart"));
}

TEST(DicomSegmentation, OfFractionsIsTakenFromHalfOnAndTheLargerPartWins) {
  MadeSegmentation seg = two_segments();
  seg.type = "FRACTIONAL";
  seg.bits = 8;
  seg.max_fraction = 200;
  seg.frames = {{1, slice_at(0), pixel_at(0, 0, 99)},
                {1, slice_at(1), pixel_at(1, 0, 100)},
                {2, slice_at(1), pixel_at(1, 0, 120)},
                {1, slice_at(2), pixel_at(2, 0, 150)},
                {2, slice_at(2), pixel_at(2, 0, 120)}};
  const LabelVolume map = read_seg(seg.bytes());
  EXPECT_EQ(level_at(map, 1, 0, 1), *level_from_name("L4"));
  EXPECT_EQ(level_at(map, 2, 0, 2), *level_from_name("L3"));
  EXPECT_EQ(labelled(map), 2);
  seg.frames[1].pixels = pixel_at(1, 0, 200);
  seg.frames[2].pixels = pixel_at(1, 0, 200);
  EXPECT_THAT(seg_error(seg), HasSubstr("do not overlap"));
}

TEST(DicomSegmentation, OfTypeLabelMapHasAllSegmentsInEachFrame) {
  for (const int bits : {8, 16}) {
    MadeSegmentation seg;
    seg.type = "LABELMAP";
    seg.bits = bits;
    seg.background = 7;
    seg.segments = {{7, "Background", "", "", ""}, {40, "", "T-11930", "SRT", ""}, {200, "L4 vertebra", "", "", ""}};
    for (int k = 0; k < 3; ++k) {
      std::vector<int> pixels(15, 7);
      pixels[3] = k == 1 ? 40 : 7;
      pixels[14] = k == 2 ? 200 : 7;
      seg.frames.push_back({0, slice_at(k), pixels});
    }
    const LabelVolume map = read_seg(seg.bytes());
    EXPECT_EQ(level_at(map, 3, 0, 1), *level_from_name("L3"));
    EXPECT_EQ(level_at(map, 4, 2, 2), *level_from_name("L4"));
    EXPECT_EQ(labelled(map), 2);
    EXPECT_EQ(map.names.begin()->first, 40);
  }
}

TEST(DicomSegmentation, SaysItsLevelsByCodeOrName) {
  const auto level_of = [](const MadeSegmentation::Segment& segment) {
    MadeSegmentation seg = two_segments();
    seg.segments = {segment, {2, "disc L3/4", "", "", ""}};
    const LabelVolume map = read_seg(seg.bytes());
    return level_name(map.names.at(1).level);
  };
  EXPECT_EQ(level_of({1, "Segment_1", "12989004", "SCT", ""}), "T11");
  EXPECT_EQ(level_of({1, "Segment_1", "T-117B0", "SRT", ""}), "T11");
  EXPECT_EQ(level_of({1, "bone of mine", "T-11670", "SNM3", ""}), "C7");
  EXPECT_EQ(level_of({1, "vertebrae_T11", "51282000", "SCT", ""}), "T11");
  EXPECT_EQ(level_of({1, "", "51282000", "SCT", "12989004", "SCT"}), "T11");
  EXPECT_EQ(level_of({1, "", "54735007", "SCT", ""}), "sacrum");
  // A lesion in T11 is not T11, and a number of another scheme not a vertebra's.
  EXPECT_EQ(level_of({1, "lesion", "52988006", "SCT", "12989004", "SCT"}), "");
  EXPECT_EQ(level_of({1, "thing", "12989004", "DCM", ""}), "");
  MadeSegmentation twofold = two_segments();
  twofold.segments[0].label = "L2";
  EXPECT_THAT(seg_error(twofold), HasSubstr("code of L3 and the name of L2"));
}

// Type, region, label and description may each name a vertebra.
TEST(DicomSegmentation, RejectsTwoVertebraeInAllThatSaysWhichItIs) {
  const std::string l3 = "36470004", l4 = "11994002", vertebra = "51282000";
  const auto read = [](const std::string& type, const std::string& region, const std::string& label,
                       const std::string& description) {
    test::MadeItem data = two_segments().data_set(), first, second;
    first.put_short(0x00620004, 1).put(0x00620005, "LO", label).put(0x00620006, "ST", description);
    if (!type.empty()) first.put_code(0x0062000f, type, "SCT");
    if (!region.empty()) first.put_code(0x00082218, region, "SCT");
    second.put_short(0x00620004, 2);
    data.put_items(0x00620002, {first, second});
    std::string level;
    const std::string error = error_of([&] { level = level_name(read_seg(data.file()).names.at(1).level); });
    return level + error;
  };
  EXPECT_EQ(read(l3, l3, "L3", "L3 vertebra"), "L3");
  EXPECT_EQ(read("", "", "Segment_1", "L3"), "L3");
  EXPECT_EQ(read(vertebra, l3, "bone", "as drawn"), "L3");
  EXPECT_EQ(read("65985001", "", "Segment_1", "S1"), "sacrum");
  EXPECT_THAT(read(l3, l4, "", ""), HasSubstr("the code of L3 and the region of L4"));
  EXPECT_THAT(read(vertebra, l3, "L4", ""), HasSubstr("the region of L3 and the name of L4"));
  EXPECT_THAT(read(l3, "", "L3", "L4"), HasSubstr("the code of L3 and the description of L4"));
  EXPECT_THAT(read("", "", "L3", "L4"), HasSubstr("the name of L3 and the description of L4"));
}

// Named as a vertebra by who drew it, and coded as something else.
TEST(DicomSegmentation, WarnsWhereAVertebrasNameHasTheCodeOfSomethingElse) {
  const auto warnings_of = [](const MadeSegmentation::Segment& segment) {
    MadeSegmentation seg = two_segments();
    seg.segments[0] = segment;
    const LabelVolume map = read_seg(seg.bytes());
    return map.warnings.empty() ? std::string() : map.warnings.front();
  };
  EXPECT_THAT(warnings_of({1, "L3", "113197003", "SCT", ""}),
              HasSubstr("segment 1 is named \"L3\", but its type is coded as \"\" (SCT 113197003)"));
  EXPECT_THAT(warnings_of({1, "L3", "T-11300", "SRT", ""}), HasSubstr("T-11300"));
  EXPECT_THAT(warnings_of({1, "vertebra L3", "360499006", "SCT", ""}), HasSubstr("may be no vertebra"));
  // What writers put where they are told nothing, and what says no more than bone.
  for (const char* plain : {"85756007", "91723000", "123037004", "113343008", "51282000", "272673000", "36470004"}) {
    EXPECT_EQ(warnings_of({1, "L3", plain, "SCT", ""}), "") << plain;
  }
  EXPECT_EQ(warnings_of({1, "L3", "113197003", "99LOCAL", ""}), "");
  EXPECT_EQ(warnings_of({1, "rib", "113197003", "SCT", ""}), "");
}

TEST(DicomSegmentation, HasOneFrameOfASegmentAtAPlace) {
  MadeSegmentation seg = two_segments();
  seg.frames.push_back({1, slice_at(3), pixel_at(2, 1)});
  EXPECT_THAT(seg_error(seg), HasSubstr("one frame of segment 1 at a place, found frames 2 and 4 there"));
  seg.frames.back().segment = 2;
  EXPECT_EQ(labelled(read_seg(seg.bytes())), 4);
  MadeSegmentation map;
  map.type = "LABELMAP";
  map.bits = 8;
  map.segments = {{1, "L3", "", "", ""}};
  map.frames = {{0, slice_at(0), pixel_at(1, 1)}, {0, slice_at(1), pixel_at(1, 1)}, {0, slice_at(1), pixel_at(2, 1)}};
  EXPECT_THAT(seg_error(map), HasSubstr("one frame at a place, found frames 2 and 3 there"));
}

TEST(DicomSegmentation, NumbersSegmentsByRankSoThatNoConventionIsSeen) {
  MadeSegmentation seg = two_segments();
  seg.segments = {{1, "a", "", "", ""}, {2, "b", "", "", ""}};
  const LabelVolume map = read_seg(seg.bytes());
  EXPECT_EQ(map.names.at(1), (LabelName{"a", Level::kNone}));
  EXPECT_EQ(map.names.at(2), (LabelName{"b", Level::kNone}));
}

TEST(DicomSegmentation, RejectsVertebraeThatOverlapAndReadsOneAlone) {
  MadeSegmentation seg = two_segments();
  seg.frames.push_back({2, slice_at(3), pixel_at(1, 1)});
  const std::string message = seg_error(seg);
  EXPECT_THAT(message, HasSubstr("1 voxel in two of them"));
  EXPECT_THAT(message, HasSubstr("1 (L3) and 2 (L4)"));
  const TemporaryFolder folder;
  write_whole_file(folder.path() / "map.dcm", seg.bytes());
  const BoneMask l4 = read_label_map(folder.path() / "map.dcm", 2, seg_grid());
  EXPECT_TRUE(l4.at(1, 1, 3) && l4.at(4, 2, 1));
  EXPECT_EQ(std::count(l4.inside.begin(), l4.inside.end(), 1), 2);
  // What is no vertebra gives way, whichever comes first.
  seg.segments[1].label = "spine";
  EXPECT_EQ(level_at(read_seg(seg.bytes()), 1, 1, 3), *level_from_name("L3"));
  std::swap(seg.frames[1], seg.frames[3]);
  EXPECT_EQ(level_at(read_seg(seg.bytes()), 1, 1, 3), *level_from_name("L3"));
}

// As a CT's slices: a mirrored or sheared map would be another bone.
TEST(DicomSegmentation, IsPlacedByUnitVectorsAtRightAnglesAndSpacingsAboveZero) {
  const auto placed = [](const std::string& orientation, const std::string& spacing) {
    test::MadeItem data = two_segments().data_set(), plane, measures, shared;
    plane.put(0x00200037, "DS", orientation);
    measures.put(0x00180088, "DS", "2").put(0x00280030, "DS", spacing);
    shared.put_items(0x00209116, {plane}).put_items(0x00289110, {measures});
    data.put_items(0x52009229, {shared});
    return error_of([&] { read_seg(data.file()); });
  };
  const std::string axial = "1\\0\\0\\0\\1\\0", spacing = "0.5\\1.0";
  EXPECT_EQ(placed(axial, spacing), "");
  // Their cross product is a unit vector too.
  EXPECT_THAT(placed("1\\0\\0\\1.7320508\\1\\0", spacing), HasSubstr("right angles"));
  EXPECT_THAT(placed("1\\0\\0\\0.03\\0.99955\\0", spacing), HasSubstr("right angles"));
  for (const char* wrong : {"-0.5\\1.0", "0.5\\-1.0", "0\\1.0", "0.5\\wide", "25\\1.0"}) {
    EXPECT_THAT(placed(axial, wrong), HasSubstr("PixelSpacing")) << wrong;
  }
}

/// Encapsulated pixels of a fragment each, behind an empty offset table.
std::string encapsulated(const std::vector<std::string>& fragments) {
  const auto item = [](const std::string& bytes) {
    return std::string("\xfe\xff\x00\xe0", 4) + test::MadeItem::little_endian(static_cast<long long>(bytes.size()), 4) +
           bytes;
  };
  std::string all = std::string("\xe0\x7f\x10\x00OB\0\0\xff\xff\xff\xff", 12) + item("");
  for (const std::string& fragment : fragments) all += item(fragment);
  return all + std::string("\xfe\xff\xdd\xe0\0\0\0\0", 8);
}

/// A deflated stream that shrinks nothing (RFC 1951, 3.2.4).
std::string deflated(const std::string& bytes) {
  const auto size = static_cast<long long>(bytes.size());
  return "\x01" + test::MadeItem::little_endian(size, 2) + test::MadeItem::little_endian(~size, 2) + bytes;
}

// As with a CT's, more bytes than the sizes take say that the sizes may be wrong.
TEST(DicomSegmentation, WarnsWhereItsPixelsAreLongerThanItsSizes) {
  const auto said = [](const std::string& bytes) {
    std::string all;
    for (const std::string& line : read_seg(bytes).warnings) all += line;
    return all;
  };
  const auto rows = [](int count) { return two_segments().data_set().put_short(0x00280010, count); };
  EXPECT_EQ(said(rows(3).file()), "");
  EXPECT_THAT(said(rows(2).file()), HasSubstr("longer than Rows, Columns and NumberOfFrames say, by 2 bytes"));
  // Frames of 15 bits: two bytes each.
  const std::vector<std::string> frames{std::string("\0\x40", 2), std::string("\x40\0", 2), std::string("\x40\0", 2)};
  const auto packed = [&](int count, bool is_deflated, const std::string& more) {
    std::vector<std::string> fragments;
    for (const std::string& frame : frames) fragments.push_back(is_deflated ? deflated(frame + more) : frame + more);
    return rows(count).remove(0x7fe00010).file(is_deflated ? "1.2.840.10008.1.2.8.1" : "1.2.840.10008.1.2.1.98") +
           encapsulated(fragments);
  };
  for (const bool is_deflated : {false, true}) {
    EXPECT_EQ(labelled(read_seg(packed(3, is_deflated, ""))), 3);
    EXPECT_EQ(said(packed(3, is_deflated, "")), "");
    EXPECT_THAT(said(packed(3, is_deflated, "more")), HasSubstr("longer than Rows")) << is_deflated;
  }
}

TEST(DicomSegmentation, HoldsNoValuesButThoseThatItDescribes) {
  MadeSegmentation part = two_segments();
  part.type = "FRACTIONAL";
  part.bits = 8;
  part.max_fraction = 100;
  for (auto& frame : part.frames) {
    for (int& value : frame.pixels) value *= 100;
  }
  EXPECT_EQ(labelled(read_seg(part.bytes())), 3);
  // Half of what, where the most is not said (type 1C: PS3.3, C.8.20.2)?
  EXPECT_THAT(error_of([&] { read_seg(part.data_set().remove(0x0062000e).file()); }),
              HasSubstr("MaximumFractionalValue"));
  part.frames[1].pixels[6] = 101;
  EXPECT_THAT(seg_error(part), HasSubstr("at most MaximumFractionalValue, 100, found 101"));

  MadeSegmentation map;
  map.type = "LABELMAP";
  map.bits = 8;
  map.segments = {{1, "L3", "", "", ""}};
  map.frames = {{0, slice_at(0), pixel_at(1, 1)}, {0, slice_at(1), pixel_at(1, 1)}};
  EXPECT_EQ(labelled(read_seg(map.bytes())), 2);
  map.frames[1].pixels[6] = 2;
  EXPECT_THAT(seg_error(map), HasSubstr("segments that the file describes, found one of segment 2"));
}

TEST(DicomSegmentation, SaysWhatIsWrong) {
  MadeSegmentation uneven = two_segments();
  uneven.frames[0].p_mm.z() += 0.9;
  EXPECT_THAT(seg_error(uneven), HasSubstr("slices of one grid"));
  MadeSegmentation aside = two_segments();
  aside.frames[0].p_mm.x() += 1.0;
  EXPECT_THAT(seg_error(aside), HasSubstr("slices of one grid"));
  MadeSegmentation far = two_segments();
  far.frames[1].p_mm.z() += 1e5;
  EXPECT_THAT(seg_error(far), HasSubstr("grid of at most"));
  MadeSegmentation other = two_segments();
  other.type = "SURFACE";
  EXPECT_THAT(seg_error(other), HasSubstr("\"SURFACE\""));
  MadeSegmentation bits = two_segments();
  bits.bits = 8;
  EXPECT_THAT(seg_error(bits), HasSubstr("pixels of 1 bit"));
  MadeSegmentation unknown = two_segments();
  unknown.frames[0].segment = 9;
  EXPECT_THAT(seg_error(unknown), HasSubstr("segment 9"));
  MadeSegmentation twice = two_segments();
  twice.segments[1].number = 1;
  EXPECT_THAT(seg_error(twice), HasSubstr("two of 1"));
  const auto changed = [](const std::function<void(test::MadeItem&)>& change) {
    test::MadeItem data = two_segments().data_set();
    change(data);
    return error_of([&] { read_seg(data.file()); });
  };
  EXPECT_THAT(changed([](auto& data) { data.put(0x7fe00010, "OB", "\1"); }), HasSubstr("bytes of pixels"));
  EXPECT_THAT(changed([](auto& data) { data.remove(0x7fe00010); }), HasSubstr("no pixels"));
  EXPECT_THAT(changed([](auto& data) { data.put(0x00280008, "IS", "4"); }), HasSubstr("NumberOfFrames 4"));
  EXPECT_THAT(changed([](auto& data) { data.remove(0x52009229); }), HasSubstr("an orientation"));
  EXPECT_THAT(changed([](auto& data) { data.put(0x00080016, "UI", "1.2.840.10008.5.1.4.1.1.66.5"); }),
              HasSubstr("one of surfaces"));
  EXPECT_THAT(changed([](auto& data) { data.put(0x00080016, "UI", "1.2.840.10008.5.1.4.1.1.2"); }),
              HasSubstr("another DICOM file"));
  const std::string whole = two_segments().bytes();
  EXPECT_THAT(error_of([&] { read_seg(whole.substr(0, whole.size() - 10)); }), HasSubstr("cut short"));
}

}  // namespace
}  // namespace spinaltap
