#include "core/ct/label_volume.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>

#include "core/base/gzip.h"
#include "core/base/random.h"
#include "core/base/staged_output.h"
#include "core/ct/dicom_read.h"
#include "core/ct/label_map.h"
#include "tests/support/error_of.h"
#include "tests/support/mask_overlap.h"
#include "tests/support/nan.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/test_data.h"

namespace spinaltap {
namespace {

using test::error_of;
using test::voxel_count;
using testing::ElementsAre;
using testing::HasSubstr;

/// One voxel a label in a column, the first at the top (z grows upwards): 1 x 1 x n voxels of 1 mm.
GridGeometry column_grid(std::size_t labels) {
  GridGeometry geometry;
  geometry.size = {1, 1, static_cast<int>(labels)};
  return geometry;
}

template <class Number>
std::string upwards(const std::vector<double>& from_the_top) {
  std::string bytes;
  for (auto label = from_the_top.rbegin(); label != from_the_top.rend(); ++label) {
    const auto number = static_cast<Number>(*label);
    bytes.append(reinterpret_cast<const char*>(&number), sizeof number);
  }
  return bytes;
}

/// As 3D Slicer writes a segmentation: `head` has the lines of its segments.
std::string nrrd(const std::vector<double>& from_the_top, const std::string& head = {},
                 const std::string& type = "double") {
  return "NRRD0004\ntype: " + type + "\ndimension: 3\nspace: left-posterior-superior\nsizes: 1 1 " +
         std::to_string(from_the_top.size()) +
         "\nspace directions: (1,0,0) (0,1,0) (0,0,1)\nkinds: domain domain domain\nendian: little\nencoding: raw\n"
         "space origin: (0,0,0)\n" +
         head + "\n" + upwards<double>(from_the_top);
}

/// As TotalSegmentator writes it: NIfTI-1 with `xml` as an extension of code 0.
std::string nifti(const std::vector<double>& from_the_top, const std::string& xml = {}) {
  std::string header(352, '\0');
  const auto put = [&](std::size_t at, auto value) { std::memcpy(header.data() + at, &value, sizeof value); };
  put(0, std::int32_t{348});
  const std::int16_t dim[8] = {3, 1, 1, static_cast<std::int16_t>(from_the_top.size()), 1, 1, 1, 1};
  std::memcpy(header.data() + 40, dim, sizeof dim);
  put(70, std::int16_t{2});
  put(72, std::int16_t{8});
  for (std::size_t n = 0; n < 4; ++n) put(76 + 4 * n, 1.0F);
  put(254, std::int16_t{1});
  const float rows[3][4] = {{-1, 0, 0, 0}, {0, -1, 0, 0}, {0, 0, 1, 0}};
  std::memcpy(header.data() + 280, rows, sizeof rows);
  std::memcpy(header.data() + 344, "n+1", 4);
  std::string extension;
  if (!xml.empty()) {
    header[348] = 1;
    extension = std::string(8, '\0') + xml;
    extension.resize((extension.size() + 15) / 16 * 16, '\0');
    const std::int32_t head[2] = {static_cast<std::int32_t>(extension.size()), 0};
    std::memcpy(extension.data(), head, sizeof head);
  }
  put(108, static_cast<float>(352 + extension.size()));
  return header + extension + upwards<std::uint8_t>(from_the_top);
}

std::string label_table(const std::vector<std::pair<int, std::string>>& labels) {
  std::string xml =
      "<?xml version=\"1.0\" encoding=\"UTF-8\"?> <CaretExtension>  <Date><![CDATA[2013-07-14T05:45:09]]></Date>"
      "<VolumeInformation Index=\"0\">   <LabelTable>\n";
  for (const auto& [key, name] : labels) {
    xml += "<Label Key=\"" + std::to_string(key) + "\" Red=\"0.1\" Green=\"0.2\" Blue=\"0.3\" Alpha=\"1\"><![CDATA[" +
           name + "]]></Label>\n";
  }
  return xml + "  </LabelTable>  </VolumeInformation></CaretExtension>";
}

LabelVolume read(const std::string& bytes, std::size_t voxels, LabelConvention convention = LabelConvention::automatic,
                 const std::string& name = "map.seg.nrrd") {
  const test::TemporaryFolder folder;
  write_whole_file(folder.path() / name, bytes);
  return read_label_volume(folder.path() / name, column_grid(voxels), {.convention = convention});
}

LabelVolume read_numbers(const std::vector<double>& from_the_top,
                         LabelConvention convention = LabelConvention::automatic) {
  return read(nrrd(from_the_top), from_the_top.size(), convention);
}

std::string numbers_error(const std::vector<double>& from_the_top,
                          LabelConvention convention = LabelConvention::automatic) {
  return error_of([&] { read_numbers(from_the_top, convention); });
}

std::vector<std::string> names_of(const LabelVolume& volume) {
  std::vector<std::string> names;
  for (const Level level : levels_of(volume)) names.push_back(level_name(level));
  return names;
}

std::string segment(int number, const std::string& name, int label) {
  const std::string key = "Segment" + std::to_string(number);
  return key + "_ID:=Segment_" + std::to_string(number) + "\n" + key + "_LabelValue:=" + std::to_string(label) + "\n" +
         key + "_Layer:=0\n" + key + "_Name:=" + name + "\n";
}

TEST(ReadLabelVolume, TakesOneNameOfALabelTableALabel) {
  const auto error = [](const std::string& table) {
    return error_of([&] { read(nifti({21, 22}, table), 2, LabelConvention::automatic, "map.nii"); });
  };
  EXPECT_EQ(error(label_table({{21, "L2"}, {22, "L3"}, {22, "L3"}})), "");
  EXPECT_THAT(error(label_table({{21, "L2"}, {22, "L3"}, {22, "L4"}})),
              HasSubstr("one name a label, found \"L3\" and \"L4\" for label 22"));
}

TEST(ReadLabelVolume, TakesLevelsFromTheNamesOf3DSlicersSegments) {
  const std::string head = segment(0, "T11", 1) + segment(1, "vertebrae_T12", 2) + segment(2, "L1 vertebra", 3) +
                           segment(3, "Th10", 4) + segment(4, "T11 rib left", 5) + segment(5, "T11-T12 disc", 6);
  const LabelVolume volume = read(nrrd({4, 1, 2, 3, 5, 6}, head), 6);
  EXPECT_THAT(names_of(volume), ElementsAre("T10", "T11", "T12", "L1"));
  EXPECT_EQ(label_of(volume, *level_from_name("T11")), 1);
  EXPECT_EQ(volume.names.at(2).name, "T12");
  EXPECT_EQ(volume.names.at(5), (LabelName{"T11 rib left", Level::kNone}));
  EXPECT_EQ(volume.names.at(6).level, Level::kNone);
  EXPECT_EQ(voxel_count(mask_of(volume, Level::kT12)), 1);
  EXPECT_TRUE(mask_of(volume, Level::kT12).at(0, 0, 3));  // third from the top of six
}

TEST(ReadLabelVolume, TakesLevelsFromTheLabelTableOfTotalSegmentator) {
  // Of another task than `total`: numbers that alone would mislead.
  const std::string bytes = nifti(
      {24, 23, 9, 1},
      label_table({{24, "vertebrae_L2"}, {23, "vertebrae_L3"}, {9, "vertebrae_S1"}, {1, "sacrum"}, {77, "hip_left"}}));
  const LabelVolume volume = read(bytes, 4, LabelConvention::automatic, "map.nii");
  EXPECT_THAT(names_of(volume), ElementsAre("L2", "L3", "sacrum"));
  EXPECT_EQ(label_of(volume, Level::kSacrum), 1);
  EXPECT_EQ(volume.names.at(9), (LabelName{"S1", Level::kNone}));  // a part of it
  EXPECT_FALSE(volume.names.contains(77));                         // named, but not there
  EXPECT_THAT(names_of(read(gzip(bytes), 4, LabelConvention::automatic, "map.nii.gz")),
              ElementsAre("L2", "L3", "sacrum"));
}

TEST(ReadLabelVolume, LeavesTheTableAloneWhereItIsDamaged) {
  for (const std::string table : {"<Label Key=\"22", "<Label Key=\"22\">L3", "<Label Key=\"x\">L3</Label>", "<Label >",
                                  "<Label Key=\"99999999999999999999\">L3</Label>"}) {
    EXPECT_THAT(error_of([&] {
                  read(nifti({21, 22}, table), 2, LabelConvention::automatic, "map.nii");
                }),
                HasSubstr("22 is L3 in VerSe"))
        << table;
  }
}

TEST(ReadLabelVolume, KnowsEachConventionsNumbers) {
  EXPECT_THAT(names_of(read_numbers({1, 7, 8, 19, 28, 20, 24, 25, 26, 27}, LabelConvention::verse)),
              ElementsAre("C1", "C7", "T1", "T12", "T13", "L1", "L5", "L6", "sacrum"));
  EXPECT_THAT(names_of(read_numbers({50, 44, 43, 32, 31, 27, 26, 25, 51, 1}, LabelConvention::totalsegmentator)),
              ElementsAre("C1", "C7", "T1", "T12", "L1", "L5", "sacrum"));
  EXPECT_THAT(names_of(read_numbers({41, 35, 34, 23, 22, 18, 42, 17}, LabelConvention::totalsegmentator_v1)),
              ElementsAre("C1", "C7", "T1", "T12", "L1", "L5"));
}

/// Boxes of the size of lumbar vertebrae, 60 x 60 x 20 mm, one below the other in voxels of 10 mm, as a file.
std::string lumbar_boxes(const std::vector<std::uint8_t>& from_the_top) {
  const std::size_t count = from_the_top.size();
  std::string voxels;
  for (auto label = from_the_top.rbegin(); label != from_the_top.rend(); ++label) {
    for (int slice = 0; slice < 3; ++slice) {
      for (int j = 0; j < 8; ++j) {
        for (int i = 0; i < 8; ++i) {
          const bool is_in = slice > 0 && i > 0 && i < 7 && j > 0 && j < 7;
          voxels += static_cast<char>(is_in ? *label : 0);
        }
      }
    }
  }
  voxels += std::string(64, '\0');
  return "NRRD0004\ntype: uint8\ndimension: 3\nspace: left-posterior-superior\nsizes: 8 8 " +
         std::to_string(3 * count + 1) +
         "\nspace directions: (10,0,0) (0,10,0) (0,0,10)\nkinds: domain domain domain\nencoding: raw\n"
         "space origin: (0,0,0)\n\n" +
         voxels;
}

LabelVolume read_boxes(const std::vector<std::uint8_t>& from_the_top, const LabelReadOptions& options = {}) {
  const test::TemporaryFolder folder;
  write_whole_file(folder.path() / "map.nrrd", lumbar_boxes(from_the_top));
  GridGeometry geometry;
  geometry.size = {8, 8, static_cast<int>(3 * from_the_top.size()) + 1};
  geometry.spacing_mm = Vec3::Constant(10.0);
  return read_label_volume(folder.path() / "map.nrrd", geometry, options);
}

TEST(ReadLabelVolume, TakesNumbersWhoseOrderAndSizesLeaveOneMeaning) {
  EXPECT_THAT(names_of(read_boxes({21, 22, 23})), ElementsAre("L2", "L3", "L4"));
  EXPECT_THAT(read_boxes({21, 22, 23}).level_source, HasSubstr("VerSe or CTSpine1K"));
  EXPECT_THAT(names_of(read_boxes({30, 29, 28})), ElementsAre("L2", "L3", "L4"));
  EXPECT_THAT(error_of([&] { read_boxes({12, 13, 14}); }), HasSubstr("C3 in TotalSpineSeg"));
  EXPECT_THAT(error_of([&] { read_boxes({2, 3, 4}); }), HasSubstr("L3 in a count from L1"));
}

TEST(ReadLabelVolume, TakesOneWantedLabelOfAMapThatHasNoOther) {
  LabelReadOptions wanted;
  wanted.wanted = 22;
  EXPECT_TRUE(levels_of(read_boxes({22}, wanted)).empty());
  EXPECT_THAT(error_of([&] { read_boxes({22}); }), HasSubstr("L3 in VerSe"));
  EXPECT_THAT(error_of([&] { read_boxes({12, 13, 14}, wanted); }), HasSubstr("convention"));
}

TEST(ReadLabelVolume, TakesNoOtherMapsOrgansForVertebrae) {
  // 28 alone would be L4 in TotalSegmentator 2.
  EXPECT_THAT(names_of(read_numbers({18, 19, 28, 20})), ElementsAre("T11", "T12", "T13", "L1"));
}

TEST(ReadLabelVolume, FindsNoLevelWhereThereIsNone) {
  EXPECT_TRUE(levels_of(read_numbers({200, 230})).empty());
  EXPECT_THAT(numbers_error({21, 22}, LabelConvention::names), HasSubstr("names vertebrae"));
}

TEST(ReadLabelVolume, RejectsALevelTwice) {
  const std::string head = segment(0, "T11", 1) + segment(1, "Th11", 2);
  EXPECT_THAT(error_of([&] { read(nrrd({1, 2}, head), 2); }), HasSubstr("1 and 2 are both T11"));
  const std::string same = segment(0, "T11", 1) + segment(1, "T12", 1);
  EXPECT_THAT(error_of([&] { read(nrrd({1, 2}, same), 2); }), HasSubstr("two of label 1"));
}

TEST(ReadLabelVolume, RejectsWhatAreNoLabels) {
  EXPECT_THAT(numbers_error({-1, 3}), HasSubstr("found -1"));
  EXPECT_THAT(numbers_error({0.5}), HasSubstr("whole numbers"));
  EXPECT_THAT(numbers_error({test::kNan}), HasSubstr("whole numbers"));
  EXPECT_THAT(numbers_error({60000}), HasSubstr("from 0 to 255, found 60000"));
  EXPECT_THAT(numbers_error({0, 0}), HasSubstr("found none"));
  const std::string bad = "Segment0_LabelValue:=many\n";
  EXPECT_THAT(error_of([&] { read(nrrd({1}, bad), 1); }), HasSubstr("\"many\""));
}

TEST(ReadLabelVolume, SaysWhenAllLabelsLieOutsideTheCt) {
  const test::TemporaryFolder folder;
  write_whole_file(folder.path() / "map.nrrd", nrrd({21, 22}));
  GridGeometry far = column_grid(2);
  far.origin_mm.x() += 100.0;
  EXPECT_THAT(
      error_of([&] { read_label_volume(folder.path() / "map.nrrd", far, {.convention = LabelConvention::verse}); }),
      HasSubstr("only outside"));
  GridGeometry part = column_grid(1);
  const LabelVolume volume =
      read_label_volume(folder.path() / "map.nrrd", part, {.convention = LabelConvention::verse});
  EXPECT_THAT(names_of(volume), ElementsAre("L3"));
}

TEST(MaskOf, SaysWhatThereIs) {
  const LabelVolume volume = read_numbers({21, 22}, LabelConvention::verse);
  EXPECT_THAT(error_of([&] { mask_of(volume, 5); }), HasSubstr("there are: 21, 22"));
  EXPECT_THAT(error_of([&] { mask_of(volume, 0); }), HasSubstr("no label 0"));
  EXPECT_THAT(error_of([&] { mask_of(volume, Level::kT12); }), HasSubstr("no T12 in the label map; there are: L2, L3"));
}

LabelVolume random_volume() {
  constexpr std::uint64_t kSeed = 23;
  LabelVolume volume;
  volume.geometry.size = {9, 7, 5};
  volume.geometry.spacing_mm = Vec3(0.352, 0.352, 0.5);
  volume.geometry.origin_mm = Vec3(-101.25, 33.7, -679.8);
  volume.geometry.directions = Eigen::AngleAxisd(0.6, Vec3(1, -2, 2).normalized()).toRotationMatrix();
  const std::uint8_t labels[4] = {0, 18, 19, 255};
  for (std::size_t v = 0; v < volume.geometry.voxel_count(); ++v) {
    volume.labels.push_back(labels[static_cast<std::size_t>(4.0 * random_uniform(kSeed, v))]);
  }
  volume.names = {{18, {"T11", Level{18}}}, {19, {"T12", Level::kT12}}, {255, {"metal", Level::kNone}}};
  return volume;
}

class WrittenLabelVolume : public ::testing::TestWithParam<std::string> {};

TEST_P(WrittenLabelVolume, ComesBackWithItsNames) {
  const LabelVolume volume = random_volume();
  const std::string bytes = encode_label_volume(volume, GetParam());
  EXPECT_EQ(encode_label_volume(volume, GetParam()), bytes);
  const test::TemporaryFolder folder;
  write_whole_file(folder.path() / GetParam(), bytes);
  const bool has_names = GetParam() != "map.nrrd";
  const LabelVolume back =
      read_label_volume(folder.path() / GetParam(), volume.geometry,
                        {.convention = has_names ? LabelConvention::names : LabelConvention::verse});
  EXPECT_EQ(back.labels, volume.labels);
  if (has_names) {
    EXPECT_EQ(back.names, volume.names);
  }
  EXPECT_EQ(read_label_map(folder.path() / GetParam(), 18, volume.geometry).inside, mask_of(volume, 18).inside);
}

INSTANTIATE_TEST_SUITE_P(Formats, WrittenLabelVolume,
                         ::testing::Values("map.nii", "map.nii.gz", "map.nrrd", "map.seg.nrrd"));

TEST(EncodeLabelVolume, GivesEachSegmentItsOwnIdAndColour) {
  const std::string bytes = encode_label_volume(random_volume(), "map.seg.nrrd");
  const auto value = [&](const std::string& key) {
    const std::size_t at = bytes.find(key + ":=");
    return at == std::string::npos ? "" : bytes.substr(at + key.size() + 2, bytes.find('\n', at) - at - key.size() - 2);
  };
  EXPECT_EQ(value("Segment0_ID"), "T11");
  EXPECT_EQ(value("Segment0_Name"), "T11");
  EXPECT_EQ(value("Segment0_LabelValue"), "18");
  EXPECT_EQ(value("Segment1_Name"), "T12");
  EXPECT_EQ(value("Segment2_Name"), "metal");
  EXPECT_EQ(value("Segment2_Layer"), "0");
  EXPECT_NE(value("Segment0_Color"), value("Segment1_Color"));
  EXPECT_EQ(value("Segment3_ID"), "");
}

TEST(EncodeLabelVolume, RejectsNamesThatWouldBreakTheHeader) {
  LabelVolume volume = random_volume();
  volume.names[18].name = "T11\ntype: float";
  EXPECT_THAT(error_of([&] { encode_label_volume(volume, "map.seg.nrrd"); }), HasSubstr("one line"));
  volume = random_volume();
  volume.labels.pop_back();
  EXPECT_THAT(error_of([&] { encode_label_volume(volume, "map.nii"); }), HasSubstr("voxels"));
}

TEST(ReadLabelVolume, FindsTheLevelsAroundL3) {
  SPINALTAP_NEED_TEST_DATA(data, "L3_ct_1.5mm");
  const CtVolume ct = read_dicom(data / "dicom");
  const LabelVolume volume = read_label_volume(data / "sub-ct_seg-vert_label-22_msk.nii.gz", ct.geometry);
  EXPECT_THAT(names_of(volume), ElementsAre("L2", "L3", "L4"));
  EXPECT_EQ(voxel_count(mask_of(volume, *level_from_name("L3"))), 17698);
}

}  // namespace
}  // namespace spinaltap
