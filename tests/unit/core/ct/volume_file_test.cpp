// CTs and label maps as NRRD and MetaImage: headers put together by hand.

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <zlib.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <map>

#include "core/base/gzip.h"
#include "core/base/staged_output.h"
#include "core/ct/label_map.h"
#include "core/ct/label_volume.h"
#include "core/ct/read_ct.h"
#include "tests/support/error_of.h"
#include "tests/support/made_nifti.h"
#include "tests/support/temporary_folder.h"

namespace spinaltap {
namespace {

namespace fs = std::filesystem;
using test::error_of;
using test::TemporaryFolder;
using testing::HasSubstr;

/// 4 x 3 x 2 voxels whose values are 100 i + 10 j + k.
constexpr std::array<int, 3> kSize{4, 3, 2};
std::vector<double> numbered() {
  std::vector<double> values;
  for (int k = 0; k < 2; ++k) {
    for (int j = 0; j < 3; ++j) {
      for (int i = 0; i < 4; ++i) values.push_back(100 * i + 10 * j + k);
    }
  }
  return values;
}

template <class Number>
std::string stored(const std::vector<double>& values, bool is_big = false) {
  std::string bytes;
  for (const double value : values) {
    const auto number = static_cast<Number>(value);
    std::array<char, sizeof number> raw{};
    std::memcpy(raw.data(), &number, raw.size());
    if (is_big) std::reverse(raw.begin(), raw.end());
    bytes.append(raw.data(), raw.size());
  }
  return bytes;
}

std::string text_of(const std::vector<double>& values) {
  std::string text;
  for (const double value : values)
    text += std::to_string(static_cast<int>(value)) + (text.size() % 7 == 0 ? "\n" : " ");
  return text;
}

/// As ITK compresses MetaImages.
std::string zlib_stream(const std::string& bytes) {
  uLongf size = compressBound(static_cast<uLong>(bytes.size()));
  std::string packed(size, '\0');
  compress(reinterpret_cast<Bytef*>(packed.data()), &size, reinterpret_cast<const Bytef*>(bytes.data()),
           static_cast<uLong>(bytes.size()));
  packed.resize(size);
  return packed;
}

/// Fields by name, so that a test changes one; what is empty is left out.
struct MadeHeader {
  std::string first;
  std::vector<std::pair<std::string, std::string>> fields;
  std::string between, last;

  MadeHeader& set(const std::string& name, const std::string& value) {
    for (auto& field : fields) {
      if (field.first == name) {
        field.second = value;
        return *this;
      }
    }
    fields.insert(fields.end() - 1, {name, value});
    return *this;
  }
  std::string text() const {
    std::string all = first;
    for (const auto& [name, value] : fields) {
      if (!value.empty()) all += name + between + value + "\n";
    }
    return all + last;
  }
};

MadeHeader nrrd() {
  return {"NRRD0004\n# by hand\n",
          {{"type", "short"},
           {"dimension", "3"},
           {"space", "left-posterior-superior"},
           {"sizes", "4 3 2"},
           {"space directions", "(0.5,0,0) (0,0.75,0) (0,0,2)"},
           {"kinds", "domain domain domain"},
           {"endian", "little"},
           {"space origin", "(-10,-20,30)"},
           {"encoding", "raw"}},
          ": ",
          "\n"};
}

MadeHeader meta() {
  return {"ObjectType = Image\n",
          {{"NDims", "3"},
           {"BinaryData", "True"},
           {"BinaryDataByteOrderMSB", "False"},
           {"CompressedData", "False"},
           {"TransformMatrix", "1 0 0 0 1 0 0 0 1"},
           {"Offset", "-10 -20 30"},
           {"CenterOfRotation", "0 0 0"},
           {"AnatomicalOrientation", "RAI"},
           {"ElementSpacing", "0.5 0.75 2"},
           {"DimSize", "4 3 2"},
           {"ElementType", "MET_SHORT"},
           {"ElementDataFile", "LOCAL"}},
          " = ",
          ""};
}

std::string nrrd_file(const MadeHeader& header = nrrd()) { return header.text() + stored<std::int16_t>(numbered()); }
std::string meta_file(const MadeHeader& header = meta()) { return header.text() + stored<std::int16_t>(numbered()); }

class VolumeFiles : public testing::Test {
 protected:
  CtVolume read(const std::string& name, const std::string& bytes) {
    write_whole_file(folder_.path() / name, bytes);
    return read_ct(folder_.path() / name);
  }
  std::string error(const std::string& name, const std::string& bytes) {
    return error_of([&] { read(name, bytes); });
  }
  /// Of any file of the numbered volume as it stands in both headers.
  void expect_numbered(const std::string& name, const std::string& bytes) {
    SCOPED_TRACE(name);
    const CtVolume ct = read(name, bytes);
    EXPECT_EQ(ct.geometry.size, kSize);
    EXPECT_EQ(ct.geometry.origin_mm, Vec3(-10.0, -20.0, 30.0));
    EXPECT_EQ(ct.geometry.spacing_mm, Vec3(0.5, 0.75, 2.0));
    EXPECT_TRUE(ct.geometry.directions.isApprox(Mat3::Identity()));
    EXPECT_EQ(ct.at(3, 0, 0), 300);
    EXPECT_EQ(ct.at(1, 2, 1), 121);
  }

  TemporaryFolder folder_;
};

TEST_F(VolumeFiles, AreKnownByWhatTheyBeginWith) {
  expect_numbered("ct.nrrd", nrrd_file());
  expect_numbered("ct.mha", meta_file());
  expect_numbered("nrrd_of_another.name", nrrd_file());
  expect_numbered("meta_of_another.name", meta_file());
  expect_numbered("nrrd_called.mha", nrrd_file());
}

TEST_F(VolumeFiles, TurnEachSpaceOfNrrdIntoLps) {
  expect_numbered("ras.nrrd", nrrd_file(nrrd()
                                            .set("space", "RAS")
                                            .set("space directions", "(-0.5,0,0)(0,-0.75,0)(0,0,2)")
                                            .set("space origin", "(10,20,30)")));
  expect_numbered("las.nrrd", nrrd_file(nrrd()
                                            .set("space", "Left-Anterior-Superior")
                                            .set("space directions", "(0.5,0,0) (0,-0.75,0) (0,0,2)")
                                            .set("space origin", "( -10 , 20, 30 )")));
  expect_numbered("m.nrrd", nrrd_file(nrrd()
                                          .set("space units", "\"m\" \"m\" \"m\"")
                                          .set("space directions", "(0.0005,0,0) (0,0.00075,0) (0,0,0.002)")
                                          .set("space origin", "(-0.010,-0.020,0.030)")));
  for (const char* space : {"scanner-xyz", "3D-right-handed", "left-posterior-superior-time", ""}) {
    EXPECT_THAT(error("other.nrrd", nrrd_file(nrrd().set("space", space))), HasSubstr("where the patient's left"))
        << space;
  }
}

TEST_F(VolumeFiles, PutAxesInTheOrderOfThePatient) {
  // Axes run to the head, to the right and to the back.
  const CtVolume ct = read("turned.nrrd", nrrd_file(nrrd().set("space directions", "(0,0,0.5) (-0.75,0,0) (0,2,0)")));
  EXPECT_EQ(ct.geometry.size, (std::array<int, 3>{3, 2, 4}));
  EXPECT_EQ(ct.geometry.origin_mm, Vec3(-11.5, -20.0, 30.0));
  EXPECT_EQ(ct.at(0, 1, 3), 321);  // i = 3 upwards, j = 2 to the right, k = 1 to the back
  const CtVolume same = read(
      "turned.mha", meta_file(meta().set("TransformMatrix", "0 0 1 -1 0 0 0 1 0").set("AnatomicalOrientation", "ILA")));
  EXPECT_EQ(same.source_hash, ct.source_hash);
}

TEST_F(VolumeFiles, ReadEachTypeByteOrderAndEncoding) {
  struct Type {
    const char* nrrd;
    const char* meta;
    std::string (*bytes)(const std::vector<double>&, bool);
  };
  const std::array<Type, 8> types{{{"int16_t", "MET_SHORT", stored<std::int16_t>},
                                   {"unsigned short", "MET_USHORT", stored<std::uint16_t>},
                                   {"int", "MET_INT", stored<std::int32_t>},
                                   {"uint32", "MET_UINT", stored<std::uint32_t>},
                                   {"long long", "MET_LONG_LONG", stored<std::int64_t>},
                                   {"uint64_t", "MET_ULONG_LONG", stored<std::uint64_t>},
                                   {"float", "MET_FLOAT", stored<float>},
                                   {"double", "MET_DOUBLE", stored<double>}}};
  for (const Type& type : types) {
    SCOPED_TRACE(type.nrrd);
    for (const bool is_big : {false, true}) {
      const std::string bytes = type.bytes(numbered(), is_big);
      MadeHeader nrrd_head = nrrd().set("type", type.nrrd).set("endian", is_big ? "big" : "little");
      expect_numbered("raw.nrrd", nrrd_head.text() + bytes);
      expect_numbered("zipped.nrrd", nrrd_head.set("encoding", "gzip").text() + gzip(bytes));
      expect_numbered("half_and_half.nrrd", nrrd_head.text() + gzip(bytes.substr(0, 11)) + gzip(bytes.substr(11)));
      MadeHeader meta_head =
          meta().set("ElementType", type.meta).set("BinaryDataByteOrderMSB", is_big ? "True" : "False");
      expect_numbered("raw.mha", meta_head.text() + bytes);
      expect_numbered("zipped.mha", meta_head.set("CompressedData", "True").text() + zlib_stream(bytes));
    }
  }
  expect_numbered("text.nrrd", nrrd().set("encoding", "ascii").text() + text_of(numbered()));
  expect_numbered("text.mha", meta().set("BinaryData", "False").text() + text_of(numbered()));
  const std::vector<double> small(24, -5.0);
  EXPECT_EQ(
      read("char.nrrd", nrrd().set("type", "int8").set("endian", "").text() + stored<std::int8_t>(small)).at(1, 1, 1),
      -5);
  EXPECT_EQ(read("char.mha", meta().set("ElementType", "MET_CHAR").text() + stored<std::int8_t>(small)).at(1, 1, 1),
            -5);
}

TEST_F(VolumeFiles, FindDetachedData) {
  const std::string bytes = stored<std::int16_t>(numbered());
  fs::create_directories(folder_.path() / "data");
  write_whole_file(folder_.path() / "data" / "all.raw", bytes);
  write_whole_file(folder_.path() / "data" / "all.raw.gz", gzip(bytes));
  write_whole_file(folder_.path() / "data" / "all.zraw", zlib_stream(bytes));
  write_whole_file(folder_.path() / "with_head.raw", "two lines\nof text\n" + std::string(10, 'x') + bytes);
  write_whole_file(folder_.path() / "slice 007.raw", bytes.substr(0, 24));
  write_whole_file(folder_.path() / "slice_007.raw", bytes.substr(0, 24));
  write_whole_file(folder_.path() / "slice_009.raw", bytes.substr(24));
  // Also without an empty line at the end.
  MadeHeader header = nrrd().set("data file", "data/all.raw");
  expect_numbered("one.nhdr", header.text());
  header.last = "";
  expect_numbered("one.nhdr", header.text());
  expect_numbered("zipped.nhdr", nrrd().set("datafile", "data/all.raw.gz").set("encoding", "gzip").text());
  expect_numbered("numbered.nhdr", nrrd().set("data file", "slice_%03d.raw 7 9 2").text());
  expect_numbered("backwards.nhdr", nrrd().set("data file", "slice_%03d.raw 7 9 2 2").text());
  MadeHeader listed = nrrd();
  listed.fields.emplace_back("data file", "LIST");
  listed.last = "slice 007.raw\nslice_009.raw\n";
  expect_numbered("list.nhdr", listed.text());
  expect_numbered("skip.nhdr",
                  nrrd().set("data file", "with_head.raw").set("line skip", "2").set("byte skip", "10").text());
  expect_numbered("end.nhdr", nrrd().set("data file", "with_head.raw").set("byte skip", "-1").text());
  expect_numbered("absolute.nhdr", nrrd().set("data file", (folder_.path() / "data/all.raw").string()).text());

  expect_numbered("one.mhd", meta().set("ElementDataFile", "data/all.raw").text());
  expect_numbered("zipped.mhd", meta().set("ElementDataFile", "data/all.zraw").set("CompressedData", "True").text());
  expect_numbered("numbered.mhd", meta().set("ElementDataFile", "slice_%03d.raw 7 9 2").text());
  expect_numbered("list.mhd", meta().set("ElementDataFile", "LIST").text() + "slice 007.raw\nslice_009.raw\n");
  expect_numbered("head.mhd", meta().set("HeaderSize", "28").set("ElementDataFile", "with_head.raw").text());
  expect_numbered("end.mhd", meta().set("HeaderSize", "-1").set("ElementDataFile", "with_head.raw").text());

  EXPECT_THAT(error("lost.nhdr", nrrd().set("data file", "lost.raw").text()), HasSubstr("lost.raw"));
  EXPECT_THAT(error("lost.mhd", meta().set("ElementDataFile", "lost.raw").text()), HasSubstr("lost.raw"));
  EXPECT_THAT(error("folder.nhdr", nrrd().set("data file", "data").text()), HasSubstr("no such file"));
  EXPECT_THAT(error("skipless.nhdr", nrrd().set("data file", "with_head.raw").text()),
              HasSubstr("a head of the data's own"));
  EXPECT_THAT(error("three.nhdr", nrrd().set("data file", "slice_%03d.raw 7 11 1").text()),
              HasSubstr("share 24 evenly"));
  EXPECT_THAT(error("endless.nhdr", nrrd().set("data file", "slice_%03d.raw 7 9 0").text()),
              HasSubstr("in steps of 0"));
  EXPECT_THAT(error("two.nhdr", nrrd().set("data file", "slice_%d_%d.raw 7 9 1").text()),
              HasSubstr("one number in it"));
}

TEST_F(VolumeFiles, AreAsLongAsTheirHeaderSaysBehindSkippedLinesToo) {
  write_whole_file(folder_.path() / "lines.raw", "two lines\nof text\n" + stored<std::int16_t>(numbered()));
  const auto lines = [](const std::string& skip) {
    return nrrd().set("data file", "lines.raw").set("line skip", skip);
  };
  expect_numbered("lines.nhdr", lines("2").text());
  EXPECT_THAT(error("narrow.nhdr", lines("2").set("sizes", "3 3 2").text()), HasSubstr("12 more"));
  EXPECT_THAT(error("early.nhdr", lines("1").text()), HasSubstr("8 more"));
  EXPECT_THAT(error("many.nhdr", lines("2147483648").text()), HasSubstr("line skip"));
}

TEST_F(VolumeFiles, MayHaveAFourthAxisOfOne) {
  MadeHeader layered = nrrd();
  layered.set("dimension", "4").set("sizes", "4 3 2 1").set("space directions", "(0.5,0,0) (0,0.75,0) (0,0,2) none");
  expect_numbered("last.nrrd", nrrd_file(layered));
  layered.set("sizes", "1 4 3 2").set("space directions", "none (0.5,0,0) (0,0.75,0) (0,0,2)");
  expect_numbered("first.nrrd", nrrd_file(layered));
  layered.set("sizes", "2 4 3 1");
  EXPECT_THAT(error("two.nrrd", nrrd_file(layered)), HasSubstr("one number a voxel"));
  MadeHeader timed = meta();
  timed.set("NDims", "4").set("DimSize", "4 3 2 1").set("ElementSpacing", "0.5 0.75 2 1").set("Offset", "-10 -20 30 0");
  timed.set("TransformMatrix", "1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1");
  expect_numbered("times.mha", meta_file(timed));
  EXPECT_THAT(error("rgb.mha", meta_file(meta().set("ElementNumberOfChannels", "3"))), HasSubstr("one number a voxel"));
}

TEST_F(VolumeFiles, OfNrrdSayWhatIsWrong) {
  const auto wrong = [&](const std::string& field, const std::string& value) {
    return error("wrong.nrrd", nrrd_file(nrrd().set(field, value)));
  };
  EXPECT_THAT(wrong("type", "block"), HasSubstr("\"block\""));
  EXPECT_THAT(wrong("endian", ""), HasSubstr("endian: little"));
  EXPECT_THAT(wrong("encoding", "bzip2"), HasSubstr("unu save"));
  EXPECT_THAT(wrong("encoding", "hex"), HasSubstr("\"hex\""));
  EXPECT_THAT(wrong("encoding", "gzip"), HasSubstr("gzip stream"));
  EXPECT_THAT(wrong("sizes", "4 3 3"), HasSubstr("cut short"));
  EXPECT_THAT(wrong("sizes", "4 3 1"), HasSubstr("24 more"));
  EXPECT_THAT(wrong("sizes", "4 3 x"), HasSubstr("\"4 3 x\""));
  EXPECT_THAT(wrong("type", "int8"), HasSubstr("24 more"));
  EXPECT_THAT(wrong("space origin", ""), HasSubstr("\"space origin\""));
  EXPECT_THAT(wrong("space origin", "(0,0,inf)"), HasSubstr("NRRD"));
  EXPECT_THAT(wrong("space units", "\"furlong\" \"mm\" \"mm\""), HasSubstr("units of mm"));
  EXPECT_THAT(wrong("space directions", "(0.5,0,0) (0.2,0.75,0) (0,0,2)"), HasSubstr("right angles"));
  EXPECT_THAT(wrong("byte skip", "-2"), HasSubstr("byte skip"));
  EXPECT_THAT(wrong("space directions", "(0.5,0) (0,0.75) (0,2)"), HasSubstr("three numbers"));
  EXPECT_THAT(error("empty.nrrd", ""), HasSubstr("expected an NRRD file"));
  EXPECT_THAT(error("long.nrrd", nrrd().set("encoding", "gzip").text() + gzip(std::string(50, '\0'))),
              HasSubstr("of more"));
  EXPECT_THAT(error("words.nrrd", nrrd().set("encoding", "ascii").text() + "1 2 three" + std::string(60, ' ')),
              HasSubstr("\"three\""));
}

TEST_F(VolumeFiles, OfMetaImageSayWhatIsWrong) {
  const auto wrong = [&](const std::string& field, const std::string& value) {
    return error("wrong.mha", meta_file(meta().set(field, value)));
  };
  EXPECT_THAT(wrong("ElementType", "MET_LONG"), HasSubstr("differs between machines"));
  EXPECT_THAT(wrong("ElementType", "MET_UCHAR_ARRAY"), HasSubstr("MET_UCHAR_ARRAY"));
  EXPECT_THAT(wrong("Offset", ""), HasSubstr("Offset"));
  EXPECT_THAT(wrong("ElementSpacing", ""), HasSubstr("ElementSpacing"));
  EXPECT_THAT(wrong("ElementSpacing", "0.5 0 2"), HasSubstr("above 0"));
  EXPECT_THAT(wrong("DimSize", "4 3"), HasSubstr("as many MetaImage DimSize as NDims"));
  EXPECT_THAT(wrong("DimSize", "4 3 3"), HasSubstr("cut short"));
  EXPECT_THAT(wrong("DimSize", "4 3 1"), HasSubstr("24 more"));
  EXPECT_THAT(wrong("TransformMatrix", "2 0 0 0 1 0 0 0 1"), HasSubstr("unit vectors"));
  EXPECT_THAT(wrong("TransformMatrix", "1 0 0 1 0 0 0 0 1"), HasSubstr("volume"));
  EXPECT_THAT(wrong("CompressedData", "True"), HasSubstr("gzip stream"));
  EXPECT_THAT(wrong("CompressedData", "perhaps"), HasSubstr("True or False"));
  EXPECT_THAT(wrong("ElementToIntensityFunctionSlope", "2"), HasSubstr("ElementToIntensityFunction"));
  EXPECT_THAT(wrong("HeaderSize", "-3"), HasSubstr("HeaderSize"));
  EXPECT_THAT(wrong("DistanceUnits", "inch"), HasSubstr("DistanceUnits"));
  EXPECT_THAT(error("mesh.mha", "ObjectType = Mesh\n" + meta_file().substr(19)), HasSubstr("ObjectType Image"));
  EXPECT_THAT(error("empty.mha", ""), HasSubstr("ElementDataFile"));
  EXPECT_THAT(wrong("AnatomicalOrientation", "LAI"), HasSubstr("AnatomicalOrientation"));
  // Both senses of the letters, unknown ones, and none.
  for (const char* letters : {"RAI", "LPS", "???", ""}) {
    expect_numbered("letters.mha", meta_file(meta().set("AnatomicalOrientation", letters)));
  }
}

TEST_F(VolumeFiles, SayNothingTwiceUnlessItIsTheSame) {
  const auto again = [](MadeHeader header, const std::string& name, const std::string& value) {
    header.fields.insert(header.fields.end() - 1, {name, value});
    return header;
  };
  expect_numbered("same.nrrd", nrrd_file(again(nrrd(), "space origin", "(-10,-20,30)")));
  expect_numbered("same.mha", meta_file(again(meta(), "Position", "-10 -20 30")));
  EXPECT_THAT(error("two.nrrd", nrrd_file(again(nrrd(), "space origin", "(-10,-20,31)"))),
              HasSubstr("\"space origin\" once, found \"(-10,-20,30)\" and \"(-10,-20,31)\""));
  EXPECT_THAT(error("names.nrrd", nrrd_file(again(nrrd(), "spaceorigin", "(-10,-20,31)"))), HasSubstr("once"));
  EXPECT_THAT(error("two.mha", meta_file(again(meta(), "Offset", "-10 -20 31"))),
              HasSubstr("\"Offset\" once, found \"-10 -20 30\" and \"-10 -20 31\""));
  for (const auto& [name, value] : std::map<std::string, std::string>{{"Position", "-10 -20 31"},
                                                                      {"Origin", "-10 -20 31"},
                                                                      {"Rotation", "-1 0 0 0 -1 0 0 0 1"},
                                                                      {"ElementByteOrderMSB", "True"}}) {
    EXPECT_THAT(error("names.mha", meta_file(again(meta(), name, value))), HasSubstr("once, found")) << name;
  }
  // MetaIO's size of a voxel, which is not its step.
  expect_numbered("size.mha", meta_file(again(meta(), "ElementSize", "0.5 0.75 3")));
}

TEST_F(VolumeFiles, OfOtherKindsAreToldWithWhatToDo) {
  EXPECT_THAT(error("ct.zip", std::string("PK\3\4 and more")), HasSubstr("a ZIP archive"));
  EXPECT_THAT(error("ct.dat", test::gzipped("CT")), HasSubstr("a gzip file"));
  EXPECT_THAT(error("ct.hdr", std::string(348, '\0')), HasSubstr("which side is left"));
  EXPECT_THAT(error("ct.img", std::string(348, '\0')), HasSubstr("which side is left"));
  EXPECT_THAT(error("ct.raw", "voxels"), HasSubstr(".nhdr or .mhd"));
  EXPECT_THAT(error("ct.png", "\x89PNG and more"), HasSubstr("no CT numbers"));
  EXPECT_THAT(error("ct.mgz.bin", "?"), HasSubstr("without a header"));
  EXPECT_THAT(error("notes.txt", "a CT"),
              HasSubstr("NIfTI (.nii, .nii.gz), NRRD (.nrrd, .nhdr) or MetaImage (.mha, .mhd)"));
  EXPECT_THAT(error("empty", ""), HasSubstr("an empty file"));
}

TEST_F(VolumeFiles, HoldLabelMapsToo) {
  std::vector<double> labels(24, 0.0);
  labels[1] = 20.0;
  labels[23] = 21.0;
  const std::string bytes = stored<std::uint8_t>(labels);
  GridGeometry grid;
  grid.size = kSize;
  grid.spacing_mm = Vec3(0.5, 0.75, 2.0);
  grid.origin_mm = Vec3(-10.0, -20.0, 30.0);
  write_whole_file(folder_.path() / "labels.raw", bytes);
  const auto check = [&](const std::string& name, const std::string& content) {
    SCOPED_TRACE(name);
    write_whole_file(folder_.path() / name, content);
    const LabelVolume map = read_label_volume(folder_.path() / name, grid, {.convention = LabelConvention::verse});
    EXPECT_EQ(map.labels[1], 20);
    EXPECT_EQ(map.labels[23], 21);
    EXPECT_EQ(map.names.at(20).level, Level::kL1);
    EXPECT_TRUE(read_label_map(folder_.path() / name, 21, grid).at(3, 2, 1));
  };
  check("map.mha", meta().set("ElementType", "MET_UCHAR").text() + bytes);
  check("zipped.mha", meta().set("ElementType", "MET_UCHAR").set("CompressedData", "True").text() + zlib_stream(bytes));
  check("map.mhd", meta().set("ElementType", "MET_UCHAR").set("ElementDataFile", "labels.raw").text());
  check("map.nhdr", nrrd().set("type", "uchar").set("data file", "labels.raw").text());
  check("text.nrrd", nrrd().set("type", "uchar").set("encoding", "text").text() + text_of(labels));
}

}  // namespace
}  // namespace spinaltap
