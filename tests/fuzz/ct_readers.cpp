// CTs and label maps.

#include "core/base/error.h"
#include "core/base/gzip.h"
#include "core/base/process_changes.h"
#include "core/ct/label_map.h"
#include "core/ct/label_volume.h"
#include "core/ct/read_ct.h"
#include "core/files/strokes.h"
#include "tests/fuzz/readers.h"
#include "tests/support/made_dicom_labels.h"
#include "tests/support/made_nifti.h"
#include "tests/support/made_series.h"

namespace spinaltap::test {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMaxCtAllocation = std::size_t{200} << 20;

std::vector<Seed> series_seeds() {
  std::vector<Seed> seeds;
  for (const SeriesRecipe& recipe : every_kind_of_series()) {
    Seed seed{recipe.name, {}};
    for (const MadeSeries::File& file : make_series(recipe).files) seed.files.push_back({file.name, file.bytes});
    // Two slices of a series will do, and are faster than six.
    if (seed.files.size() > 2) seed.files.resize(2);
    seeds.push_back(std::move(seed));
  }
  return seeds;
}

std::vector<Seed> nifti_seeds() {
  std::vector<Seed> seeds;
  for (const bool is_second : {false, true}) {
    for (const bool is_big_endian : {false, true}) {
      for (const auto type : {MadeNifti::Type::kInt16, MadeNifti::Type::kFloat}) {
        MadeNifti nifti;
        nifti.type = type;
        nifti.is_second = is_second;
        nifti.is_big_endian = is_big_endian;
        nifti.slope = is_second ? 2.0 : 0.0;
        nifti.ras_steps(1, 2) = is_second ? 0.3 : 0.0;  // leans
        for (int n = 0; n < 24; ++n) nifti.values.push_back(10.0 * n);
        seeds.push_back({"NIfTI", {{"ct.nii", nifti.bytes()}}});
        seeds.push_back({"NIfTI, gzipped", {{"ct.nii.gz", nifti.bytes(), gzipped}}});
      }
    }
  }
  return seeds;
}

/// Headers of text with data attached, deflated, listed and beside them.
std::vector<Seed> volume_seeds() {
  const std::string nrrd =
      "NRRD0004\n# by hand\ntype: short\ndimension: 3\nspace: left-posterior-superior\nsizes: 4 3 2\n"
      "space directions: (0.5,0,0) (0,0.75,0) (0,0.2,2)\nkinds: domain domain domain\nendian: little\n"
      "space origin: (-10,-20,30)\nspace units: \"mm\" \"mm\" \"mm\"\nencoding: ";
  const std::string meta =
      "ObjectType = Image\nNDims = 3\nBinaryData = True\nBinaryDataByteOrderMSB = False\n"
      "TransformMatrix = 1 0 0 0 1 0 0 0 1\nOffset = -10 -20 30\nAnatomicalOrientation = RAI\n"
      "ElementSpacing = 0.5 0.75 2\nDimSize = 4 3 2\nElementType = MET_SHORT\n";
  std::string voxels, words;
  for (int n = 0; n < 24; ++n) {
    voxels += MadeItem::little_endian(10 * n, 2);
    words += std::to_string(10 * n) + " ";
  }
  const std::string first = voxels.substr(0, 24), second = voxels.substr(24);
  std::vector<Seed> seeds;
  seeds.push_back({"NRRD", {{"ct.nrrd", nrrd + "raw\n\n" + voxels}}});
  seeds.push_back({"NRRD, text", {{"ct.nrrd", nrrd + "ascii\n\n" + words}}});
  seeds.push_back(
      {"NRRD, gzipped", {{"ct.nrrd", voxels, [nrrd](const std::string& in) { return nrrd + "gzip\n\n" + gzip(in); }}}});
  seeds.push_back(
      {"NRRD, detached", {{"ct.nhdr", nrrd + "raw\nbyte skip: 3\ndata file: a.raw\n"}, {"a.raw", "abc" + voxels}}});
  seeds.push_back({"NRRD, numbered",
                   {{"ct.nhdr", nrrd + "raw\ndata file: s%02d.raw 1 2 1\n"}, {"s01.raw", first}, {"s02.raw", second}}});
  seeds.push_back(
      {"NRRD, listed",
       {{"ct.nhdr", nrrd + "raw\ndata file: LIST\ns1.raw\ns2.raw\n"}, {"s1.raw", first}, {"s2.raw", second}}});
  seeds.push_back({"MetaImage", {{"ct.mha", meta + "ElementDataFile = LOCAL\n" + voxels}}});
  seeds.push_back({"MetaImage, deflated", {{"ct.mha", voxels, [meta](const std::string& in) {
                                              return meta + "CompressedData = True\nElementDataFile = LOCAL\n" +
                                                     gzip(in);
                                            }}}});
  seeds.push_back({"MetaImage, detached",
                   {{"ct.mhd", meta + "HeaderSize = -1\nElementDataFile = a.raw\n"}, {"a.raw", "abc" + voxels}}});
  seeds.push_back(
      {"MetaImage, listed",
       {{"ct.mhd", meta + "ElementDataFile = LIST\ns1.raw\ns2.raw\n"}, {"s1.raw", first}, {"s2.raw", second}}});
  return seeds;
}

/// The header among the files of a folder.
fs::path volume_in(const fs::path& folder) {
  for (const char* name : {"ct.nrrd", "ct.nhdr", "ct.mha", "ct.mhd"}) {
    if (fs::exists(folder / name)) return folder / name;
  }
  fail("expected a header in ", folder.string());
}

/// The grid that label maps are read on.
GridGeometry label_grid() {
  GridGeometry geometry;
  geometry.size = {6, 5, 4};
  geometry.spacing_mm = Vec3(0.5, 0.75, 2.0);
  geometry.origin_mm = Vec3(-10.0, -20.0, 30.0);
  return geometry;
}

LabelVolume labels() {
  LabelVolume volume{label_grid(), std::vector<std::uint8_t>(120, 0), {}};
  for (std::size_t i = 40; i < 80; ++i) volume.labels[i] = i < 60 ? 18 : 20;
  volume.names = {{18, {"T11", Level{18}}}, {20, {"L1", Level::kL1}}};
  return volume;
}

std::string gunzipped_nrrd(const std::string& encoding, const std::string& voxels) {
  return "NRRD0004\n# by hand\ntype: uint16\nendian: big\ndimension: 4\nspace: RAS\nsizes: 1 3 2 2\n"
         "space directions: none (-1,0,0) (0,-1,0) (0,0,1)\nkinds: list domain domain domain\n"
         "space origin: (10,20,30)\nSegment0_LabelValue:=5\nSegment0_Name:=L3: mine\nencoding: " +
         encoding + "\n\n" + voxels;
}

std::vector<Seed> label_seeds() {
  std::vector<Seed> seeds;
  for (const char* name : {"labels.nii", "labels.nii.gz", "labels.nrrd", "labels.seg.nrrd"}) {
    seeds.push_back({name, {{name, encode_label_volume(labels(), name)}}});
  }
  const std::string nii = encode_label_volume(labels(), "labels.nii");
  seeds.push_back({"NIfTI labels, gzipped", {{"labels.nii.gz", nii, gzipped}}});
  std::string voxels(24, '\0');
  voxels[5] = 5;
  seeds.push_back({"NRRD, raw", {{"labels.nrrd", gunzipped_nrrd("raw", voxels)}}});
  seeds.push_back({"NRRD, gzipped", {{"labels.nrrd", voxels, [](const std::string& inside) {
                                        return gunzipped_nrrd("gzip", gzip(inside));
                                      }}}});
  return seeds;
}

/// Segmentations of each type, and structure sets; some by our writer, some as others write them.
std::vector<Seed> dicom_label_seeds() {
  std::vector<Seed> seeds;
  for (const char* name : {"labels.dcm", "labels.rtstruct.dcm"}) {
    seeds.push_back({name, {{name, encode_label_volume(labels(), name)}}});
  }
  for (const char* type : {"BINARY", "FRACTIONAL", "LABELMAP"}) {
    for (const bool is_open : {false, true}) {
      MadeSegmentation made;
      made.type = type;
      made.bits = made.type == "BINARY" ? 1 : 8;
      made.is_open = is_open;
      made.segments = {{1, "", "36470004", "SCT", ""}, {2, "L4", "51282000", "SCT", "11994002", "SCT"}};
      for (int k = 0; k < 3; ++k) {
        std::vector<int> pixels(15, 0);
        pixels[static_cast<std::size_t>(k)] = made.type == "FRACTIONAL" ? 200 : 1;
        made.frames.push_back({1 + k % 2, Vec3(-10.0, -20.0, 30.0 + 2.0 * k), pixels});
      }
      seeds.push_back({made.type, {{"labels.dcm", made.bytes()}}});
    }
  }
  MadeStructureSet set;
  const auto square = [](double half, double z) {
    return std::vector<Vec3>{
        {-9.0 - half, -19.0 - half, z}, {-9.0 + half, -19.0 - half, z}, {-9.0 + half, -19.0 + half, z}};
  };
  set.rois = {{300, "L3", {square(0.9, 30.0), square(0.3, 30.0), square(0.9, 32.0)}, "CLOSED_PLANAR", "36470004"},
              {2, "point", {square(0.1, 30.0)}, "POINT"}};
  seeds.push_back({"structure set", {{"labels.dcm", set.bytes()}}});
  return seeds;
}

void read_labels(const fs::path& folder) {
  const fs::path file = only_file(folder);
  const LabelVolume volume = read_label_volume(file, label_grid(), {.convention = LabelConvention::any_names});
  for (const auto& [label, name] : volume.names) static_cast<void>(mask_of(volume, label));
  static_cast<void>(levels_of(volume));
  static_cast<void>(read_strokes(file, label_grid()));
  static_cast<void>(read_label_map(file, volume.names.begin()->first, label_grid()));
}

}  // namespace

void add_ct_readers(std::vector<Reader>& readers) {
  readers.push_back({"dicom", series_seeds,
                     [](const fs::path& folder) {
                       // GDCM's decoders print what they think of damaged pictures.
                       allow_process_changes({.silences_decoders = true});
                       static_cast<void>(read_ct(folder, {.series = "1", .resample = true}));
                     },
                     kMaxCtAllocation, true});
  readers.push_back({"nifti", nifti_seeds,
                     [](const fs::path& folder) { static_cast<void>(read_ct(only_file(folder))); }, kMaxCtAllocation});
  readers.push_back({"volume", volume_seeds,
                     [](const fs::path& folder) { static_cast<void>(read_ct(volume_in(folder))); }, kMaxCtAllocation});
  readers.push_back({"label-map", label_seeds, read_labels, kMaxCtAllocation});
  readers.push_back({"dicom-labels", dicom_label_seeds, read_labels, kMaxCtAllocation, true});
}

}  // namespace spinaltap::test
