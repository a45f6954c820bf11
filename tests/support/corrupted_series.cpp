#include "tests/support/corrupted_series.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <random>

#include "core/base/error.h"
#include "core/base/random.h"
#include "core/ct/detail/dicom_values.h"

namespace spinaltap::test {
namespace {

constexpr int kColumns = 64, kRows = 48, kSlices = 12;
constexpr double kColumnMm = 2.4, kRowMm = 2.4, kStepMm = 2.5;

/// HU of a trunk: muscle with a rim of fat in air, a vertebra whose body and canal change along z, an aorta.
double trunk_hu(double x_mm, double y_mm, double z_mm) {
  const auto inside = [&](double x, double y, double a, double b) {
    return std::pow((x_mm - x) / a, 2) + std::pow((y_mm - y) / b, 2) < 1.0;
  };
  if (!inside(0.0, 0.0, 66.0, 48.0)) return -1000.0;
  if (!inside(0.0, 0.0, 58.0, 40.0)) return -105.0;
  const double phase = 0.2 * z_mm;
  const double radius_mm = 15.0 + 2.0 * std::cos(phase);
  if (inside(0.0, 18.0, 8.0, 6.0)) return 30.0;
  if (inside(0.0, 0.0, radius_mm, radius_mm - 2.0)) {
    const bool is_shell = !inside(0.0, 0.0, radius_mm - 3.0, radius_mm - 5.0);
    return is_shell ? 700.0 : 180.0 + 60.0 * std::sin(0.5 * x_mm) * std::cos(0.4 * y_mm + phase);
  }
  if (inside(0.0, 22.0, 22.0, 10.0)) return 550.0 + 3.0 * z_mm;
  if (inside(14.0 + 0.3 * z_mm, -22.0, 8.0, 8.0)) return 160.0;
  if (inside(-25.0, -12.0 - 0.4 * z_mm, 12.0, 9.0)) return -110.0;
  return 55.0;
}

CtVolume trunk(const Mat3& directions, const Vec3& origin_mm, std::uint64_t seed) {
  GridGeometry geometry;
  geometry.size = {kColumns, kRows, kSlices};
  geometry.spacing_mm = Vec3(kColumnMm, kRowMm, kStepMm);
  geometry.directions = directions;
  geometry.origin_mm = origin_mm;
  std::vector<std::int16_t> hu;
  std::uint64_t n = 0;
  for (int k = 0; k < kSlices; ++k) {
    for (int j = 0; j < kRows; ++j) {
      for (int i = 0; i < kColumns; ++i) {
        const double value = trunk_hu((i - 0.5 * kColumns) * kColumnMm, (j - 0.5 * kRows) * kRowMm, k * kStepMm) +
                             14.0 * random_normal(seed, n++);
        hu.push_back(static_cast<std::int16_t>(std::lround(std::max(value, -1024.0))));
      }
    }
  }
  return make_ct_volume(geometry, std::move(hu));
}

std::string decimals(const std::vector<double>& values) {
  std::string text;
  for (const double value : values) text += (text.empty() ? "" : "\\") + to_decimal_string(value);
  return text;
}

struct Storage {
  std::string name;
  bool is_signed = true;
  int bits_stored = 16;
  int intercept = 0;
  bool has_padding = false;  ///< the corners of the picture, as of a round field of view
  bool has_few_attributes = false;
  bool is_implicit = false;
};

HandMadeDicom slice_of(const CtVolume& ct, int k, const Storage& storage) {
  const GridGeometry& geometry = ct.geometry;
  const Vec3 position_mm = geometry.to_patient(Vec3(0.0, 0.0, k));
  const Mat3& axes = geometry.directions;
  HandMadeDicom file;
  file.set(0x00080018, "UI", "1.2.826.0.1.7." + std::to_string(k + 1));
  file.set(0x00080008, "CS", "ORIGINAL\\PRIMARY\\AXIAL");
  file.set(0x0020000e, "UI", "1.2.826.0.1.3");
  file.set(0x00200052, "UI", "1.2.826.0.1.4");
  file.set(0x00200013, "IS", std::to_string(kSlices - k));
  file.set(0x00200032, "DS", decimals({position_mm.x(), position_mm.y(), position_mm.z()}));
  file.set(0x00200037, "DS", decimals({axes(0, 0), axes(1, 0), axes(2, 0), axes(0, 1), axes(1, 1), axes(2, 1)}));
  file.set_short(0x00280010, geometry.size[1]).set_short(0x00280011, geometry.size[0]);
  file.set(0x00280030, "DS", decimals({geometry.spacing_mm.y(), geometry.spacing_mm.x()}));
  file.set_short(0x00280101, storage.bits_stored).set_short(0x00280102, storage.bits_stored - 1);
  file.set_short(0x00280103, storage.is_signed ? 1 : 0);
  file.set(0x00281052, "DS", std::to_string(storage.intercept)).set(0x00281053, "DS", "1");
  file.set(0x00180050, "DS", decimals({kStepMm}));
  if (!storage.has_few_attributes) {
    file.set(0x00080022, "DA", "20200101").set(0x00080032, "TM", "101500.5");
    file.set(0x00180060, "DS", "120").set(0x00181210, "SH", "B30f");
    file.set(0x00181100, "DS", decimals({kColumns * kColumnMm}));
    file.set(0x00185100, "CS", "HFS");
    file.set(0x00200012, "IS", "2");
    file.set(0x00200020, "CS", "L\\P");
    file.set(0x00201041, "DS", decimals({-position_mm.z() + 12.5}));
    file.set(0x00281054, "LO", "HU");
  }
  std::vector<std::uint16_t> pixels;
  const auto first = geometry.offset(0, 0, k);
  for (int j = 0; j < kRows; ++j) {
    for (int i = 0; i < kColumns; ++i) {
      const auto at = first + static_cast<std::size_t>(j) * kColumns + static_cast<std::size_t>(i);
      const bool is_padded = ct.hu[at] == -1024;
      const int stored = storage.has_padding && is_padded ? 0 : ct.hu[at] - storage.intercept;
      pixels.push_back(static_cast<std::uint16_t>(stored & ((1 << storage.bits_stored) - 1)));
    }
  }
  file.set_pixels(pixels);
  if (storage.has_padding) file.set_short(0x00280120, 0);
  if (storage.is_implicit) file.make_implicit();
  return file;
}

struct Attribute {
  std::uint32_t tag;
  const char* name;
};

/// All that a slice's header says of what and where it is. Names of patients and the like are not read.
constexpr std::array<Attribute, 33> kAttributes{{{0x00080008, "ImageType"},
                                                 {0x00080016, "SOPClassUID"},
                                                 {0x00080018, "SOPInstanceUID"},
                                                 {0x00080022, "AcquisitionDate"},
                                                 {0x00080032, "AcquisitionTime"},
                                                 {0x00080060, "Modality"},
                                                 {0x00180050, "SliceThickness"},
                                                 {0x00180060, "KVP"},
                                                 {0x00181100, "ReconstructionDiameter"},
                                                 {0x00181210, "ConvolutionKernel"},
                                                 {0x00185100, "PatientPosition"},
                                                 {0x0020000e, "SeriesInstanceUID"},
                                                 {0x00200012, "AcquisitionNumber"},
                                                 {0x00200013, "InstanceNumber"},
                                                 {0x00200020, "PatientOrientation"},
                                                 {0x00200032, "ImagePositionPatient"},
                                                 {0x00200037, "ImageOrientationPatient"},
                                                 {0x00200052, "FrameOfReferenceUID"},
                                                 {0x00201041, "SliceLocation"},
                                                 {0x00280002, "SamplesPerPixel"},
                                                 {0x00280004, "PhotometricInterpretation"},
                                                 {0x00280010, "Rows"},
                                                 {0x00280011, "Columns"},
                                                 {0x00280030, "PixelSpacing"},
                                                 {0x00280100, "BitsAllocated"},
                                                 {0x00280101, "BitsStored"},
                                                 {0x00280102, "HighBit"},
                                                 {0x00280103, "PixelRepresentation"},
                                                 {0x00280120, "PixelPaddingValue"},
                                                 {0x00281052, "RescaleIntercept"},
                                                 {0x00281053, "RescaleSlope"},
                                                 {0x00281054, "RescaleType"},
                                                 {0x7fe00010, "PixelData"}}};

using Value = HandMadeDicom::Value;

bool is_decimal(const Value& value) { return value.vr == "DS" || value.vr == "IS"; }

/// The decimal number, or the 16-bit one, moved by what the dice say: a little, a lot, another sign, another unit.
Value shifted(Value value, std::mt19937_64& dice) {
  if (value.vr == "US") {
    const auto low = static_cast<unsigned char>(value.bytes[0]), high = static_cast<unsigned char>(value.bytes[1]);
    constexpr std::array<int, 6> kBy{1, -1, 4, -4, 16, 1000};
    const int number = (low | high << 8) + kBy[dice() % kBy.size()];
    value.bytes = {static_cast<char>(number & 0xff), static_cast<char>(number >> 8 & 0xff)};
    return value;
  }
  std::vector<double> numbers = dicom_decimals(value.bytes);
  double& number = numbers[dice() % numbers.size()];
  const std::array<double, 7> kTo{number * 1.25,  number * 2.0,    -number,     number + 1.0,
                                  number + 100.0, number - 1024.0, number * 0.1};
  number = kTo[dice() % kTo.size()];
  value.bytes = value.vr == "IS" ? std::to_string(std::lround(numbers.front())) : decimals(numbers);
  return value;
}

/// Two of its parts in each other's place.
Value turned(Value value, std::mt19937_64& dice) {
  std::vector<std::string> parts{""};
  for (const char c : value.bytes) {
    if (c == '\\') {
      parts.emplace_back();
    } else {
      parts.back() += c;
    }
  }
  if (parts.size() < 2) return value;
  const std::size_t a = dice() % parts.size();
  std::swap(parts[a], parts[(a + 1 + dice() % (parts.size() - 1)) % parts.size()]);
  value.bytes.clear();
  for (const std::string& part : parts) value.bytes += (&part == parts.data() ? "" : "\\") + part;
  return value;
}

Value garbled(Value value, std::mt19937_64& dice) {
  if (value.bytes.empty()) return value;
  char& byte = value.bytes[dice() % value.bytes.size()];
  byte = static_cast<char>(value.vr == "US" || value.vr == "OW" ? byte ^ (1 << static_cast<int>(dice() % 8))
                                                                : ' ' + static_cast<int>(dice() % 95));
  return value;
}

}  // namespace

std::vector<SoundSeries> sound_series() {
  const std::array<Storage, 3> kStorages{
      {{.name = "signed"},
       {.name = "12 bits", .is_signed = false, .bits_stored = 12, .intercept = -1024, .has_padding = true},
       {.name = "few attributes, oblique", .has_few_attributes = true, .is_implicit = true}}};
  std::vector<SoundSeries> all;
  for (const Storage& storage : kStorages) {
    const double turn_rad = storage.has_few_attributes ? 0.3 : 0.0;
    const Mat3 directions = Eigen::AngleAxisd(turn_rad, Vec3::UnitX()).toRotationMatrix();
    const CtVolume ct = trunk(directions, Vec3(-76.8, -60.0, -512.5), all.size() + 1);
    SoundSeries series{storage.name, {}, ct};
    for (int k = 0; k < kSlices; ++k) series.files.push_back(slice_of(ct, k, storage));
    all.push_back(std::move(series));
  }
  return all;
}

Corruption corrupt(SoundSeries& series, std::uint64_t seed) {
  std::mt19937_64 dice(mix_bits(seed));
  const std::array<const char*, 7> kKinds{"dropped", "emptied", "swapped", "shifted", "copied", "mixed", "garbled"};
  while (true) {
    const Attribute attribute = kAttributes[dice() % kAttributes.size()];
    const std::string kind = kKinds[dice() % kKinds.size()];
    std::vector<HandMadeDicom> files = series.files;
    const std::uint32_t tag = attribute.tag;
    const Value* const there = files.front().find(tag);
    if (there == nullptr || (tag == 0x7fe00010 && kind != "dropped" && kind != "emptied" && kind != "shifted"))
      continue;
    Corruption made{attribute.name, kind, {}, {}};
    const std::size_t count = files.size();
    // One file, all, or the last few.
    std::vector<std::size_t> which;
    const std::size_t scope = dice() % 3;
    const std::size_t one = dice() % count;
    for (std::size_t n = 0; n < count; ++n) {
      if (scope == 0 ? n == one : scope == 1 || n > count - 2 - count / 3) which.push_back(n);
    }
    if (kind == "mixed" && scope == 1) continue;  // of one and some: a value of another kind of series
    made.scope = scope == 0 ? "one file" : scope == 1 ? "all files" : "some files";
    const auto put = [&](std::size_t n, const Value& value) { files[n].set(tag, value.vr, value.bytes); };
    const std::uint64_t same_dice = dice();
    const bool is_number = is_decimal(*there) || there->vr == "US";
    if (kind == "dropped") {
      for (const std::size_t n : which) files[n].remove(tag);
    } else if (kind == "emptied") {
      for (const std::size_t n : which) put(n, {there->vr, ""});
    } else if (kind == "swapped") {
      // Between two files; of all, the parts of a value, or all files' values the other way round.
      if (scope == 0) {
        const std::size_t other = (one + 1 + dice() % (count - 1)) % count;
        const Value value = *files[one].find(tag);
        put(one, *files[other].find(tag));
        put(other, value);
      } else {
        for (const std::size_t n : which) {
          std::mt19937_64 same(same_dice);
          put(n, turned(*files[n].find(tag), same));
        }
      }
    } else if (kind == "shifted") {
      if (tag == 0x7fe00010) {  // by a byte or a pixel: its length with it
        for (const std::size_t n : which) put(n, {there->vr, files[n].find(tag)->bytes.substr(2)});
      } else {
        if (!is_number) continue;
        for (const std::size_t n : which) {
          std::mt19937_64 same(same_dice);
          put(n, shifted(*files[n].find(tag), same));
        }
      }
    } else if (kind == "copied") {
      // From another attribute of the same kind of value.
      std::vector<std::uint32_t> like;
      for (const Attribute& other : kAttributes) {
        const Value* const value = files.front().find(other.tag);
        if (value != nullptr && other.tag != tag && value->vr == there->vr) like.push_back(other.tag);
      }
      if (like.empty()) continue;
      const std::uint32_t from = like[dice() % like.size()];
      for (const std::size_t n : which) put(n, *files[n].find(from));
    } else if (kind == "mixed") {
      const std::vector<SoundSeries> others = sound_series();
      const Value* const value = others[dice() % others.size()].files[dice() % count].find(tag);
      if (value == nullptr) continue;
      for (const std::size_t n : which) put(n, *value);
    } else {
      for (const std::size_t n : which) {
        std::mt19937_64 same(same_dice);
        put(n, garbled(*files[n].find(tag), same));
      }
    }
    for (std::size_t n = 0; n < count; ++n) {
      if (files[n].bytes() == series.files[n].bytes()) continue;
      const Value* const before = series.files[n].find(tag);
      const Value* const after = files[n].find(tag);
      const auto text = [](const Value* value) {
        if (value == nullptr) return std::string("none");
        if (value->vr != "US" || value->bytes.size() < 2) return '"' + value->bytes.substr(0, 40) + '"';
        return std::to_string(static_cast<unsigned char>(value->bytes[0]) | static_cast<unsigned char>(value->bytes[1])
                                                                                << 8);
      };
      made.change = text(before) + " -> " + text(after);
      series.files = std::move(files);
      return made;
    }
  }
}

}  // namespace spinaltap::test
