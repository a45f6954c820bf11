#include "core/files/milling_file.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>
#include <utility>

#include "core/base/error.h"
#include "core/base/text_fields.h"
#include "core/files/json_file.h"

namespace spinaltap {
namespace {

constexpr FileFormat kMillingFormat{"spinaltap-milling", "milling", "see docs/milling.md"};

constexpr std::array<std::pair<const char*, Milling::Way>, 2> kMillingWays{
    {{"raster", Milling::Way::raster}, {"contour", Milling::Way::contour}}};
constexpr std::array<std::pair<const char*, Milling::Depth>, 2> kMillingDepths{
    {{"below surface", Milling::Depth::below_surface}, {"floor", Milling::Depth::floor}}};

template <class Names, class Value>
const char* word_of(const Names& names, Value value) {
  for (const auto& [word, known] : names) {
    if (known == value) return word;
  }
  fail("milling: expected a way and a depth that have names");
}

template <class Names>
auto value_of(const Names& names, const JsonObject& object, const char* key, const std::filesystem::path& file) {
  const std::string text = object.text(key);
  for (const auto& [word, value] : names) {
    if (text == word) return value;
  }
  fail("expected \"", names[0].first, "\" or \"", names[1].first, "\" as \"", key, "\", found ", in_quotes(text),
       " in ", file.string());
}

Json milling_json(const Milling& milling) {
  Json json = format_head(kMillingFormat);
  json.update(Json{{"frame", "LPS"}, {"unit", "mm"}, {"name", milling.name}, {"outline", Json::array()}});
  for (const Vec3& corner : milling.outline_mm) json["outline"].push_back(to_json(corner));
  json.update(Json{{"into", to_json(milling.into)},
                   {"way", word_of(kMillingWays, milling.way)},
                   {"depth", word_of(kMillingDepths, milling.depth)},
                   {"depth_mm", milling.depth_mm},
                   {"layer_mm", milling.layer_mm},
                   {"apart_mm", milling.apart_mm},
                   {"feed_mm_s", milling.feed_mm_s},
                   {"travel_mm_s", milling.travel_mm_s},
                   {"lift_mm", milling.lift_mm}});
  return json;
}

Milling milling_of(const Json& json, const std::filesystem::path& path) {
  check_format(json, kMillingFormat, path);
  check_keys(json,
             {"format", "version", "frame", "unit", "name", "outline", "into", "way", "depth", "depth_mm", "layer_mm",
              "apart_mm", "feed_mm_s", "travel_mm_s", "lift_mm"},
             path, "a part of a milling");
  const JsonObject object(json, path);
  if (object.text("frame") != "LPS" || object.text("unit") != "mm") {
    fail("expected a milling in the frame LPS and the unit mm in ", path.string());
  }
  Milling milling;
  milling.name = object.text("name");
  constexpr std::size_t kMaxName = 100;  // reports and records repeat it
  const bool is_name = milling.name.size() <= kMaxName &&
                       std::none_of(milling.name.begin(), milling.name.end(), [](unsigned char c) { return c < ' '; });
  if (!is_name) fail("expected a name of at most 100 letters in ", path.string(), ", found ", in_quotes(milling.name));
  const Json& outline = object.at("outline");
  if (!outline.is_array()) fail("expected corners as \"outline\" in ", path.string());
  for (const Json& corner : outline) {
    const Json one{{"corner", corner}};
    milling.outline_mm.push_back(JsonObject(one, path).vector("corner"));
  }
  milling.into = object.vector("into");
  const double length = milling.into.norm();
  if (!(length > 1e-9 && std::isfinite(length))) {
    fail("expected a direction that is not zero as \"into\" in ", path.string());
  }
  milling.into /= length;
  milling.way = value_of(kMillingWays, object, "way", path);
  milling.depth = value_of(kMillingDepths, object, "depth", path);
  milling.depth_mm = object.number("depth_mm");
  milling.layer_mm = object.number_or("layer_mm", milling.layer_mm);
  milling.apart_mm = object.number_or("apart_mm", milling.apart_mm);
  milling.feed_mm_s = object.number_or("feed_mm_s", milling.feed_mm_s);
  milling.travel_mm_s = object.number_or("travel_mm_s", milling.travel_mm_s);
  milling.lift_mm = object.number_or("lift_mm", milling.lift_mm);
  return milling;
}

}  // namespace

void write_milling(const Milling& milling, const std::filesystem::path& path) {
  write_json(milling_json(milling), path);
}

Milling read_milling(const std::filesystem::path& path) { return milling_of(read_json(path), path); }

std::string milling_text(const Milling& milling) { return milling_json(milling).dump(2) + "\n"; }

Milling milling_of_text(const std::string& text, const std::filesystem::path& file) {
  return milling_of(parse_json(text, file.string()), file);
}

}  // namespace spinaltap
