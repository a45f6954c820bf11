#include "core/files/bit_file.h"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "core/base/error.h"
#include "core/base/text_fields.h"
#include "core/files/bit_json.h"
#include "core/files/data_files.h"
#include "core/files/detail/tool_json.h"

namespace spinaltap {
namespace {

constexpr FileFormat kBitsFormat{"spinaltap-bits", "table of bits", "see docs/data-files.md"};
constexpr FileFormat kProfileFormat{"spinaltap-bit-profile", "profile of a bit", "see docs/data-files.md"};

NamedBit read_profile_file(const std::filesystem::path& path) {
  const Json json = read_json(path);
  check_format(json, kProfileFormat, path);
  check_keys(json, {"format", "version", "unit", "name", "outline", "sources"}, path, "a key of a bit's profile");
  const JsonObject object(json, path);
  if (object.text("unit") != "mm") fail("expected \"mm\" as \"unit\" in ", path.string());
  return {object.text("name"), read_outline(object.at("outline"), path)};
}

}  // namespace

const std::map<std::string, BitShape>& bit_shapes() {
  static const std::map<std::string, BitShape> shapes = [] {
    std::map<std::string, BitShape> by_sizes;
    for (const BitShapeTraits& traits : bit_shape_traits()) {
      if (traits.shape != BitShape::profile) by_sizes[traits.name] = traits.shape;
    }
    return by_sizes;
  }();
  return shapes;
}

Json bit_json(const DrillBit& bit) { return to_json(bit); }

std::vector<NamedBit> read_bits(const std::filesystem::path& path) {
  const Json json = read_json(path);
  check_format(json, kBitsFormat, path);
  const Json& list = JsonObject(json, path).at("bits");
  if (!list.is_array() || list.empty()) fail("expected one bit or more in ", path.string(), ", found none");
  std::vector<NamedBit> bits;
  for (const Json& item : list) {
    const JsonObject object(item, path);
    bits.push_back({object.text("name"), read_bit(object.at("bit"), path)});
    try {
      check_bit(bits.back().bit);
    } catch (const Error& error) {
      fail(path.string(), ", ", in_quotes(bits.back().name), ": ", error.what());
    }
  }
  return bits;
}

std::vector<std::string> bit_profiles() { return data_names("profiles"); }

NamedBit read_bit_profile(const std::string& name_or_file) {
  const std::vector<std::string> shipped = bit_profiles();
  if (std::find(shipped.begin(), shipped.end(), name_or_file) != shipped.end()) {
    return read_profile_file(data_file("profiles/" + name_or_file + ".json"));
  }
  if (!std::filesystem::exists(name_or_file)) {
    std::string names;
    for (const std::string& name : shipped) names += (names.empty() ? "" : ", ") + name;
    fail("expected the profile of a bit (", names, ") or a file, found ", in_quotes(name_or_file));
  }
  return read_profile_file(name_or_file);
}

std::vector<NamedBit> shipped_bits() {
  std::vector<NamedBit> bits = read_bits(data_file("bits/pedicle.json"));
  for (const std::string& name : bit_profiles()) bits.push_back(read_bit_profile(name));
  return bits;
}

}  // namespace spinaltap
