#include "core/files/bit_file.h"

#include <nlohmann/json.hpp>

#include "core/base/error.h"
#include "core/base/text_fields.h"
#include "core/files/detail/tool_json.h"

namespace spinaltap {
namespace {

constexpr FileFormat kBitsFormat{"spinaltap-bits", "table of bits", "see docs/data-files.md"};

}  // namespace

const std::map<std::string, BitShape>& bit_shapes() {
  static const std::map<std::string, BitShape> shapes{{"drill", BitShape::drill},
                                                      {"round-burr", BitShape::round_burr},
                                                      {"conical-burr", BitShape::conical_burr},
                                                      {"tapered-screw", BitShape::tapered_screw}};
  return shapes;
}

const std::string& name_of(BitShape shape) {
  for (const auto& [name, known] : bit_shapes()) {
    if (known == shape) return name;
  }
  fail("no such shape of a bit");
}

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

}  // namespace spinaltap
