#include "core/files/bit_file.h"

#include <nlohmann/json.hpp>

#include "core/base/error.h"
#include "core/files/detail/tool_json.h"

namespace spinaltap {

std::vector<NamedBit> read_bits(const std::filesystem::path& path) {
  const Json json = read_json(path);
  const Json& list = JsonObject(json, path).at("bits");
  if (!list.is_array() || list.empty()) fail("expected one bit or more in ", path.string(), ", found none");
  std::vector<NamedBit> bits;
  for (const Json& item : list) {
    const JsonObject object(item, path);
    bits.push_back({object.text("name"), read_bit(object.at("bit"), path)});
    try {
      check_bit(bits.back().bit);
    } catch (const Error& error) {
      fail(path.string(), ", \"", bits.back().name, "\": ", error.what());
    }
  }
  return bits;
}

}  // namespace spinaltap
