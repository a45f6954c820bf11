#include "core/files/detail/tool_json.h"

#include <algorithm>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/base/error.h"
#include "core/base/text_fields.h"
#include "core/files/bit_file.h"

namespace spinaltap {

namespace {

bool is_hash_letter(char c) { return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'z') || c == '-'; }

Json outline_point_json(const OutlinePoint& point) {
  Json json{{"back_mm", point.back_mm}, {"radius_mm", point.radius_mm}};
  if (point.is_arc) json["arc"] = true;
  return json;
}

OutlinePoint read_outline_point(const Json& json, const std::filesystem::path& file) {
  check_keys(json, {"back_mm", "radius_mm", "arc"}, file, "\"back_mm\", \"radius_mm\" or \"arc\"");
  const JsonObject object(json, file);
  OutlinePoint point{object.number("back_mm"), object.number("radius_mm")};
  if (object.has("arc")) point.is_arc = object.flag("arc");
  return point;
}

}  // namespace

Json to_json(const DrillBit& bit) {
  if (bit.shape == BitShape::profile) {
    // Its sizes follow from the outline.
    Json json{{"shape", name_of(bit.shape)}, {"outline", Json::array()}};
    for (const OutlinePoint& point : bit.outline) json["outline"].push_back(outline_point_json(point));
    return json;
  }
  if (bit.is_plate()) {
    Json json{{"shape", name_of(bit.shape)},
              {"width_mm", bit.diameter_mm},
              {"thickness_mm", bit.thickness_mm},
              {"length_mm", bit.length_mm},
              {"width_along", to_json(bit.width_along)}};
    if (bit.stroke_mm != 0.0) json["stroke_mm"] = bit.stroke_mm;
    return json;
  }
  Json json{{"diameter_mm", bit.diameter_mm}, {"length_mm", bit.length_mm}, {"tip_length_mm", bit.tip_length_mm}};
  // A plain drill stays what programs that know no other shape can read.
  if (bit.shape != BitShape::drill) json["shape"] = name_of(bit.shape);
  if (bit.tip_diameter_mm != 0.0) json["tip_diameter_mm"] = bit.tip_diameter_mm;
  if (bit.shank_diameter_mm != 0.0) json["shank_diameter_mm"] = bit.shank_diameter_mm;
  const DrillBit usual;
  if (bit.helix_deg != usual.helix_deg) json["helix_deg"] = bit.helix_deg;
  if (bit.wear_mm != usual.wear_mm) json["wear_mm"] = bit.wear_mm;
  return json;
}

Json to_json(const PedicleScrew& screw) {
  Json json{{"name", screw.name},
            {"diameter_mm", screw.diameter_mm},
            {"length_mm", screw.length_mm},
            {"tip_length_mm", screw.tip_length_mm},
            {"head", to_json(screw.head)}};
  if (screw.thread) json["thread"] = to_json(*screw.thread);
  return json;
}

Json to_json(const ScrewHead& head) {
  return {{"diameter_mm", head.diameter_mm},
          {"length_mm", head.length_mm},
          {"driver_diameter_mm", head.driver_diameter_mm},
          {"driver_cone_deg", head.driver_cone_deg},
          {"driver_length_mm", head.driver_length_mm}};
}

Json to_json(const ScrewThread& thread) {
  const ScrewThread usual;
  Json json{{"core_diameter_mm", thread.core_diameter_mm}, {"pitch_mm", thread.pitch_mm}};
  if (thread.tip_core_diameter_mm != 0.0) json["tip_core_diameter_mm"] = thread.tip_core_diameter_mm;
  if (thread.starts != usual.starts) json["starts"] = thread.starts;
  if (thread.crest_mm != usual.crest_mm) json["crest_mm"] = thread.crest_mm;
  if (thread.flank_deg != usual.flank_deg) json["flank_deg"] = thread.flank_deg;
  return json;
}

ScrewThread read_screw_thread(const Json& json, const std::filesystem::path& file) {
  check_keys(json, {"core_diameter_mm", "pitch_mm", "tip_core_diameter_mm", "starts", "crest_mm", "flank_deg"}, file,
             "a screw's thread");
  const JsonObject object(json, file);
  ScrewThread thread;
  thread.core_diameter_mm = object.number("core_diameter_mm");
  thread.pitch_mm = object.number("pitch_mm");
  if (object.has("tip_core_diameter_mm")) thread.tip_core_diameter_mm = object.number("tip_core_diameter_mm");
  constexpr std::uint64_t kTooMany = 1000;  // which no screw has: told when the screw is checked
  if (object.has("starts")) thread.starts = static_cast<int>(std::min(object.whole_number("starts"), kTooMany));
  if (object.has("crest_mm")) thread.crest_mm = object.number("crest_mm");
  if (object.has("flank_deg")) thread.flank_deg = object.number("flank_deg");
  return thread;
}

ScrewHead read_screw_head(const Json& json, const std::filesystem::path& file) {
  check_keys(json, {"diameter_mm", "length_mm", "driver_diameter_mm", "driver_cone_deg", "driver_length_mm"}, file,
             "a screw's head");
  const JsonObject object(json, file);
  return {object.number("diameter_mm"), object.number("length_mm"), object.number("driver_diameter_mm"),
          object.number("driver_cone_deg"), object.number("driver_length_mm")};
}

DrillBit read_outline(const Json& places, const std::filesystem::path& file) {
  if (!places.is_array()) {
    fail("expected places as \"outline\" in ", file.string(), ", found ", shown_value(places));
  }
  std::vector<OutlinePoint> outline;
  for (const Json& place : places) {
    try {
      outline.push_back(read_outline_point(place, file));
    } catch (const Error& error) {
      fail("place ", outline.size() + 1, " of \"outline\": ", error.what());
    }
  }
  try {
    return profile_bit(std::move(outline));
  } catch (const Error& error) {
    fail("\"outline\" in ", file.string(), ": ", error.what());
  }
}

DrillBit read_plate(const Json& json, const std::filesystem::path& file) {
  check_keys(json, {"shape", "width_mm", "thickness_mm", "length_mm", "width_along", "stroke_mm"}, file,
             "\"width_mm\", \"thickness_mm\", \"length_mm\", \"width_along\" or \"stroke_mm\" of a plate");
  const JsonObject object(json, file);
  DrillBit plate{object.number("width_mm"), object.number("length_mm"), 0.0, BitShape::plate};
  plate.thickness_mm = object.number("thickness_mm");
  if (object.has("width_along")) plate.width_along = object.vector("width_along");
  if (object.has("stroke_mm")) plate.stroke_mm = object.number("stroke_mm");
  return plate;
}

DrillBit read_bit(const Json& json, const std::filesystem::path& file) {
  const JsonObject object(json, file);
  if (object.has("shape") && object.text("shape") == name_of(BitShape::plate)) return read_plate(json, file);
  if (object.has("shape") && object.text("shape") == name_of(BitShape::profile)) {
    check_keys(json, {"shape", "outline"}, file, "\"shape\" and \"outline\" of a profile");
    return read_outline(object.at("outline"), file);
  }
  for (const char* key : {"width_mm", "thickness_mm", "stroke_mm", "width_along"}) {
    if (object.has(key)) fail("expected \"", key, "\" of a bit of the shape plate only in ", file.string());
  }
  if (object.has("outline")) fail("expected \"outline\" of the shape profile only in ", file.string());
  DrillBit bit{object.number("diameter_mm"), object.number("length_mm"), object.number("tip_length_mm")};
  if (object.has("shape")) {
    const std::string name = object.text("shape");
    const auto shape = bit_shapes().find(name);
    if (shape == bit_shapes().end()) {
      fail("expected the bit's shape to be drill, round-burr, conical-burr, tapered-screw, profile or plate in ",
           file.string(), ", found ", in_quotes(name));
    }
    bit.shape = shape->second;
  }
  if (object.has("tip_diameter_mm")) bit.tip_diameter_mm = object.number("tip_diameter_mm");
  if (object.has("shank_diameter_mm")) bit.shank_diameter_mm = object.number("shank_diameter_mm");
  bit.helix_deg = object.number_or("helix_deg", bit.helix_deg);
  bit.wear_mm = object.number_or("wear_mm", bit.wear_mm);
  return bit;
}

PedicleScrew read_screw(const Json& json, const std::filesystem::path& file) {
  const JsonObject object(json, file);
  PedicleScrew screw{object.text("name"), object.number("diameter_mm"), object.number("length_mm"),
                     object.number("tip_length_mm")};
  if (object.has("head")) screw.head = read_screw_head(object.at("head"), file);
  if (object.has("thread")) screw.thread = read_screw_thread(object.at("thread"), file);
  return screw;
}

Json to_json(const DrillPath& path) {
  Json json{{"name", path.name},
            {"entry_mm", to_json(path.entry_mm)},
            {"target_mm", to_json(path.target_mm)},
            {"bit", to_json(path.bit)}};
  if (path.screw) json["screw"] = to_json(*path.screw);
  // A straight path stays what programs that know no other can read.
  if (path.is_curved()) {
    json["via_mm"] = Json::array();
    for (const Vec3& via_mm : path.via_mm) json["via_mm"].push_back(to_json(via_mm));
  }
  if (!path.bone.is_empty()) json["bone"] = to_json(path.bone);
  return json;
}

Json to_json(const BoneIdentity& bone) {
  Json json = Json::object();
  if (bone.names_ct()) json["ct"] = bone.ct_hash;
  if (bone.level != Level::kNone) json["level"] = level_name(bone.level);
  return json;
}

BoneIdentity read_bone_identity(const Json& json, const std::filesystem::path& file) {
  check_keys(json, {"ct", "level"}, file, "\"ct\" or \"level\" of a \"bone\"");
  const JsonObject object(json, file);
  BoneIdentity bone;
  if (object.has("ct")) {
    bone.ct_hash = object.text("ct");
    constexpr std::size_t kLongest = 64;
    const bool is_hash = !bone.ct_hash.empty() && bone.ct_hash.size() <= kLongest &&
                         std::ranges::all_of(bone.ct_hash, [](char c) { return is_hash_letter(c); });
    if (!is_hash) {
      fail("expected the hash of a CT, letters a to z, digits and \"-\", for \"ct\" of \"bone\" in ", file.string(),
           ", found ", in_quotes(bone.ct_hash));
    }
  }
  if (object.has("level")) {
    const std::optional<Level> level = level_from_name(object.text("level"));
    if (!level) {
      fail("expected a vertebra such as \"L3\" for \"level\" of \"bone\" in ", file.string(), ", found ",
           in_quotes(object.text("level")));
    }
    bone.level = *level;
  }
  return bone;
}

DrillPath read_path(const Json& json, const std::filesystem::path& file) {
  const JsonObject object(json, file);
  DrillPath path;
  path.name = object.text("name");
  path.entry_mm = object.vector("entry_mm");
  path.target_mm = object.vector("target_mm");
  path.bit = read_bit(object.at("bit"), file);
  if (object.has("screw")) path.screw = read_screw(object.at("screw"), file);
  if (object.has("bone")) path.bone = read_bone_identity(object.at("bone"), file);
  if (object.has("via_mm")) {
    const Json& places = object.at("via_mm");
    if (!places.is_array() || places.size() > kMaxVias) {
      fail("expected up to ", kMaxVias, " places as \"via_mm\" in ", file.string(), ", found ",
           places.is_array() ? std::to_string(places.size()) : shown_value(places));
    }
    for (const Json& place : places) {
      const Json named{{"via_mm", place}};
      path.via_mm.push_back(JsonObject(named, file).vector("via_mm"));
    }
  }
  return path;
}

}  // namespace spinaltap
