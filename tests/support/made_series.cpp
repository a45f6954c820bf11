#include "tests/support/made_series.h"

#include <gdcmFile.h>
#include <gdcmImage.h>
#include <gdcmImageChangeTransferSyntax.h>
#include <gdcmSequenceOfItems.h>
#include <gdcmTrace.h>
#include <gdcmWriter.h>

#include <cmath>
#include <sstream>
#include <stdexcept>

#include "core/base/random.h"
#include "core/base/staged_output.h"
#include "core/ct/detail/dicom_values.h"

namespace spinaltap::test {
namespace {

using gdcm::TransferSyntax;
using gdcm::VR;

constexpr int kPadding = -2000;  // as scanners write it

void put(gdcm::DataSet& data, const gdcm::Tag& tag, VR::VRType vr, std::string value) {
  if (value.size() % 2 != 0) value.push_back(vr == VR::UI ? '\0' : ' ');
  gdcm::DataElement element(tag);
  element.SetVR(vr);
  element.SetByteValue(value.data(), static_cast<std::uint32_t>(value.size()));
  data.Replace(element);
}

/// GDCM's writer turns the bytes of numbers over itself where the syntax is big endian.
void put_short(gdcm::DataSet& data, const gdcm::Tag& tag, int value, VR::VRType vr = VR::US) {
  put(data, tag, vr, {static_cast<char>(value & 0xff), static_cast<char>(value >> 8 & 0xff)});
}

/// A sequence of one item.
void put_item(gdcm::DataSet& data, const gdcm::Tag& tag, const std::vector<gdcm::DataSet>& items) {
  const gdcm::SmartPointer<gdcm::SequenceOfItems> sequence = new gdcm::SequenceOfItems;
  sequence->SetLengthToUndefined();
  for (const gdcm::DataSet& nested : items) {
    gdcm::Item item;
    item.SetVLToUndefined();
    item.SetNestedDataSet(nested);
    sequence->AddItem(item);
  }
  gdcm::DataElement element(tag);
  element.SetVR(VR::SQ);
  element.SetValue(*sequence);
  element.SetVLToUndefined();
  data.Replace(element);
}

std::string decimals(std::initializer_list<double> values) {
  std::string text;
  for (const double value : values) text += (text.empty() ? "" : "\\") + to_decimal_string(value);
  return text;
}
std::string decimals(const Vec3& v) { return decimals({v.x(), v.y(), v.z()}); }

CtVolume make_ground_truth(const SeriesRecipe& recipe) {
  GridGeometry geometry;
  geometry.size = {20, 16, 6};
  geometry.spacing_mm = Vec3(0.5, 0.75, 2.0);
  geometry.directions = recipe.directions;
  geometry.origin_mm = Vec3(-30.5, 12.25, 100.0);
  std::vector<std::int16_t> hu(geometry.voxel_count());
  const int low = recipe.is_signed ? -(1 << (recipe.bits_stored - 1)) : 0;
  const int high = low + (1 << recipe.bits_stored) - 1;
  std::uint64_t n = 0;
  for (std::int16_t& value : hu) {
    const auto i = static_cast<double>(n % 20);
    const auto j = static_cast<double>(n / 20 % 16);
    const auto k = static_cast<double>(n / 320);
    const double depth = 5.0 - std::hypot(i - 10.0, j - 8.0, 2.0 * (k - 2.5));
    const double texture = recipe.tolerance_hu > 0 ? 0.0 : 40.0 * random_uniform(3, n);
    const double wanted = (depth > 0.0 ? 60.0 + 200.0 * depth : 60.0) + texture;
    const auto stored = std::lround((wanted - recipe.intercept) / recipe.slope);
    value = static_cast<std::int16_t>(std::clamp<long>(stored, low, high) * recipe.slope + recipe.intercept);
    ++n;
  }
  return make_ct_volume(geometry, std::move(hu));
}

bool is_corner(const GridGeometry& geometry, int i, int j) {
  return (i == 0 || i == geometry.size[0] - 1) && (j == 0 || j == geometry.size[1] - 1);
}

/// Stored values of `slices` slices from `first`, little endian.
std::string stored_bytes(const CtVolume& ground_truth, const SeriesRecipe& recipe, int first, int slices) {
  std::string bytes;
  for (int k = first; k < first + slices; ++k) {
    for (int j = 0; j < ground_truth.geometry.size[1]; ++j) {
      for (int i = 0; i < ground_truth.geometry.size[0]; ++i) {
        const bool is_padding = recipe.has_padding && is_corner(ground_truth.geometry, i, j);
        const int value = is_padding ? kPadding : (ground_truth.at(i, j, k) - recipe.intercept) / recipe.slope;
        for (int byte = 0; byte < recipe.bits_allocated / 8; ++byte) {
          bytes.push_back(static_cast<char>(value >> (8 * byte) & 0xff));
        }
      }
    }
  }
  return bytes;
}

gdcm::DataElement pixel_element(std::string bytes, VR::VRType vr) {
  if (bytes.size() % 2 != 0) bytes.push_back('\0');
  gdcm::DataElement element(gdcm::Tag(0x7fe0, 0x0010));
  element.SetVR(vr);
  element.SetByteValue(bytes.data(), static_cast<std::uint32_t>(bytes.size()));
  return element;
}

gdcm::DataElement pixels_of(const CtVolume& ground_truth, const SeriesRecipe& recipe, int first, int slices) {
  const auto bits = [](int value) { return static_cast<unsigned short>(value); };
  const gdcm::DataElement plain =
      pixel_element(stored_bytes(ground_truth, recipe, first, slices), recipe.bits_allocated == 8 ? VR::OB : VR::OW);
  if (!TransferSyntax(recipe.syntax).IsEncapsulated()) return plain;
  const gdcm::SmartPointer<gdcm::Image> made = new gdcm::Image;  // the filter holds on to it
  gdcm::Image& image = *made;
  image.SetNumberOfDimensions(slices > 1 ? 3 : 2);
  image.SetDimension(0, static_cast<unsigned>(ground_truth.geometry.size[0]));
  image.SetDimension(1, static_cast<unsigned>(ground_truth.geometry.size[1]));
  if (slices > 1) image.SetDimension(2, static_cast<unsigned>(slices));
  image.SetPixelFormat(gdcm::PixelFormat(1, bits(recipe.bits_allocated), bits(recipe.bits_stored),
                                         bits(recipe.bits_stored - 1), recipe.is_signed ? 1 : 0));
  image.SetPhotometricInterpretation(gdcm::PhotometricInterpretation::MONOCHROME2);
  image.SetTransferSyntax(TransferSyntax::ExplicitVRLittleEndian);
  image.SetDataElement(plain);
  gdcm::ImageChangeTransferSyntax change;
  change.SetTransferSyntax(recipe.syntax);
  change.SetInput(image);
  if (!change.Change()) throw std::runtime_error("GDCM cannot write " + recipe.name);
  return change.GetOutput().GetDataElement();
}

void put_rescale(gdcm::DataSet& data, const SeriesRecipe& recipe) {
  put(data, {0x0028, 0x1052}, VR::DS, to_decimal_string(recipe.intercept));
  put(data, {0x0028, 0x1053}, VR::DS, to_decimal_string(recipe.slope));
}
void put_spacing(gdcm::DataSet& data, const GridGeometry& geometry) {
  put(data, {0x0028, 0x0030}, VR::DS, decimals({geometry.spacing_mm.y(), geometry.spacing_mm.x()}));
}
void put_orientation(gdcm::DataSet& data, const GridGeometry& geometry) {
  put(data, {0x0020, 0x0037}, VR::DS,
      decimals(geometry.directions.col(0)) + "\\" + decimals(geometry.directions.col(1)));
}

template <class Fill>
void put_group(gdcm::DataSet& groups, const gdcm::Tag& tag, const Fill& fill) {
  gdcm::DataSet nested;
  fill(nested);
  put_item(groups, tag, {nested});
}

void put_common_groups(gdcm::DataSet& groups, const GridGeometry& geometry, const SeriesRecipe& recipe) {
  put_group(groups, {0x0020, 0x9116}, [&](gdcm::DataSet& data) { put_orientation(data, geometry); });
  put_group(groups, {0x0028, 0x9110}, [&](gdcm::DataSet& data) { put_spacing(data, geometry); });
  put_group(groups, {0x0028, 0x9145}, [&](gdcm::DataSet& data) { put_rescale(data, recipe); });
}

/// Frames last to first, so that their order in the file says nothing.
void put_functional_groups(gdcm::DataSet& data, const GridGeometry& geometry, const SeriesRecipe& recipe) {
  gdcm::DataSet shared;
  if (recipe.shares_groups) put_common_groups(shared, geometry, recipe);
  put_item(data, {0x5200, 0x9229}, {shared});
  std::vector<gdcm::DataSet> frames;
  for (int k = 0; k < geometry.size[2]; ++k) {
    gdcm::DataSet frame;
    put_group(frame, {0x0020, 0x9113}, [&](gdcm::DataSet& nested) {
      put(nested, {0x0020, 0x0032}, VR::DS, decimals(geometry.to_patient(Vec3(0, 0, k))));
    });
    if (!recipe.shares_groups) put_common_groups(frame, geometry, recipe);
    frames.push_back(frame);
  }
  put_item(data, {0x5200, 0x9230}, frames);
  put(data, {0x0028, 0x0008}, VR::IS, std::to_string(geometry.size[2]));
}

std::string encode(const CtVolume& ground_truth, const SeriesRecipe& recipe, int first, int slices) {
  gdcm::Writer writer;
  gdcm::DataSet& data = writer.GetFile().GetDataSet();
  const GridGeometry& geometry = ground_truth.geometry;
  const std::string sop_class = recipe.is_enhanced ? "1.2.840.10008.5.1.4.1.1.2.1" : "1.2.840.10008.5.1.4.1.1.2";
  put(data, {0x0008, 0x0016}, VR::UI, sop_class);
  put(data, {0x0008, 0x0018}, VR::UI, "1.2.3." + std::to_string(first + 1));
  put(data, {0x0008, 0x0060}, VR::CS, "CT");
  put(data, {0x0010, 0x0010}, VR::PN, "Secret^Name");
  put(data, {0x0010, 0x0020}, VR::LO, "SECRET-ID");
  put(data, {0x0018, 0x0050}, VR::DS, "5");  // SliceThickness: not the step
  put(data, {0x0020, 0x000e}, VR::UI, "1.2.3");
  put_short(data, {0x0028, 0x0002}, 1);
  put(data, {0x0028, 0x0004}, VR::CS, "MONOCHROME2");
  put_short(data, {0x0028, 0x0010}, geometry.size[1]);
  put_short(data, {0x0028, 0x0011}, geometry.size[0]);
  put_short(data, {0x0028, 0x0100}, recipe.bits_allocated);
  put_short(data, {0x0028, 0x0101}, recipe.bits_stored);
  put_short(data, {0x0028, 0x0102}, recipe.bits_stored - 1);
  put_short(data, {0x0028, 0x0103}, recipe.is_signed ? 1 : 0);
  if (recipe.has_padding) put_short(data, {0x0028, 0x0120}, kPadding, recipe.is_signed ? VR::SS : VR::US);
  if (recipe.is_enhanced) {
    put_functional_groups(data, geometry, recipe);
  } else {
    put(data, {0x0020, 0x0032}, VR::DS, decimals(geometry.to_patient(Vec3(0, 0, first))));
    put_orientation(data, geometry);
    put_spacing(data, geometry);
    put_rescale(data, recipe);
  }
  data.Replace(pixels_of(ground_truth, recipe, first, slices));

  gdcm::FileMetaInformation& meta = writer.GetFile().GetHeader();
  meta.SetDataSetTransferSyntax(recipe.syntax);
  put(meta, {0x0002, 0x0010}, VR::UI, TransferSyntax::GetTSString(recipe.syntax));
  std::ostringstream stream;
  writer.SetStream(stream);
  if (!writer.Write() || !stream) throw std::runtime_error("GDCM cannot write " + recipe.name);
  return stream.str();
}

}  // namespace

void MadeSeries::write(const std::filesystem::path& folder) const {
  for (const File& file : files) write_whole_file(folder / file.name, file.bytes);
}

MadeSeries make_series(const SeriesRecipe& recipe) {
  gdcm::Trace::WarningOff();
  gdcm::Trace::ErrorOff();
  MadeSeries series;
  series.name = recipe.name;
  series.tolerance_hu = recipe.tolerance_hu;
  series.ground_truth = make_ground_truth(recipe);
  const GridGeometry geometry = series.ground_truth.geometry;
  if (recipe.is_enhanced) {
    series.files.push_back({"enhanced.dcm", encode(series.ground_truth, recipe, 0, geometry.size[2])});
  } else {
    for (int k = 0; k < geometry.size[2]; ++k) {
      // Names against the order of positions.
      series.files.push_back(
          {std::string(1, static_cast<char>('f' - k)) + ".dcm", encode(series.ground_truth, recipe, k, 1)});
    }
  }
  if (recipe.has_padding) {
    std::vector<std::int16_t> hu = series.ground_truth.hu;
    for (int k = 0; k < geometry.size[2]; ++k) {
      for (int j = 0; j < geometry.size[1]; ++j) {
        for (int i = 0; i < geometry.size[0]; ++i) {
          if (is_corner(geometry, i, j)) hu[geometry.offset(i, j, k)] = -1024;
        }
      }
    }
    series.ground_truth = make_ct_volume(geometry, std::move(hu));
  }
  return series;
}

}  // namespace spinaltap::test
