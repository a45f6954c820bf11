#include "core/files/detail/session_json.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <optional>

#include "core/base/error.h"
#include "core/base/text_fields.h"
#include "core/files/detail/material_json.h"
#include "core/files/detail/tool_json.h"
#include "core/session/choose_engine.h"

namespace spinaltap {
namespace {

namespace fs = std::filesystem;

JsonObject part_of(const JsonObject& object, const char* key, const fs::path& file) {
  const Json& part = object.at(key);
  if (!part.is_object())
    fail("expected a JSON object for \"", key, "\" in ", file.string(), ", found ", shown_value(part));
  return {part, file};
}

/// JSON has no infinity: a limit that is one is left out.
void add_limit(Json& json, const char* key, double value) {
  if (!std::isinf(value)) json[key] = value;
}

double limit(const JsonObject& object, const char* key, double without) {
  return object.has(key) && !object.at(key).is_null() ? object.number(key) : without;
}

Json json_of(const PointVolumeOptions& volume) {
  return {{"radius_mm", volume.radius_mm},
          {"spacing_mm", volume.spacing_mm},
          {"lead_in_mm", volume.lead_in_mm},
          {"hu_bits", volume.hu_bits == HuBits::eight ? 8U : 16U},
          {"subdivision", volume.subdivision == DiscSubdivision::rings ? "rings" : "hexagons"},
          {"jitter", volume.jitter},
          {"jitter_seed", volume.jitter_seed}};
}

PointVolumeOptions read_volume_part(const JsonObject& object, const fs::path& file) {
  PointVolumeOptions volume;
  volume.radius_mm = object.number("radius_mm");
  volume.spacing_mm = object.number("spacing_mm");
  volume.lead_in_mm = object.number("lead_in_mm");
  const std::uint64_t bits = object.whole_number("hu_bits");
  if (bits != 8 && bits != 16) fail("expected 8 or 16 for \"hu_bits\" in ", file.string(), ", found ", bits);
  volume.hu_bits = bits == 8 ? HuBits::eight : HuBits::sixteen;
  const std::string subdivision = object.text("subdivision");
  if (subdivision != "rings" && subdivision != "hexagons") {
    fail("expected rings or hexagons for \"subdivision\" in ", file.string(), ", found ", in_quotes(subdivision));
  }
  volume.subdivision = subdivision == "rings" ? DiscSubdivision::rings : DiscSubdivision::hexagons;
  volume.jitter = object.number("jitter");
  volume.jitter_seed = object.whole_number("jitter_seed");
  return volume;
}

// In the units of ThermalBone: those of its file would not come back to the last bit.
Json json_of(const ThermalTissue& tissue) {
  return {{"conductivity_w_mm_k", tissue.conductivity_w_mm_k}, {"capacity_j_mm3_k", tissue.capacity_j_mm3_k}};
}

Json json_of(const HeatOptions& heat) {
  const ThermalBone& bone = heat.bone;
  return {{"bone",
           {{"cancellous_density_g_cm3", bone.cancellous_density_g_cm3},
            {"cortical_density_g_cm3", bone.cortical_density_g_cm3},
            {"cancellous", json_of(bone.cancellous)},
            {"cortical", json_of(bone.cortical)},
            {"temperature_c", bone.temperature_c},
            {"shear_angle_deg", bone.shear_angle_deg},
            {"water_w_mm2_k", bone.water_w_mm2_k}}},
          {"is_irrigated", heat.is_irrigated},
          {"distance_mm", heat.distance_mm},
          {"limit_c", heat.limit_c}};
}

Json json_of(const SessionOptions& options) {
  Json stop{{"on_breach", options.stop.on_breach}};
  add_limit(stop, "thrust_n", options.stop.thrust_n);
  add_limit(stop, "clearance_mm", options.stop.clearance_mm);
  Json json{{"spindle", {{"rpm", options.spindle.rpm}, {"is_clockwise", options.spindle.is_clockwise}}},
            {"stop", stop},
            {"states",
             {{"contact_g_cm3", options.states.contact_g_cm3},
              {"cancellous_g_cm3", options.states.cancellous_g_cm3},
              {"cortical_g_cm3", options.states.cortical_g_cm3},
              {"near_mm", options.states.near_mm},
              {"rise", options.states.rise},
              {"hold_mm", options.states.hold_mm},
              {"no_cortex_mm", options.states.no_cortex_mm}}},
            {"max_jump_mm", options.max_jump_mm}};
  if (!options.follows_path) json["follows_path"] = false;
  if (!options.has_path) json["has_path"] = false;
  if (options.has_device) json["has_device"] = true;
  if (!options.has_support) json["has_support"] = false;
  if (options.heat) json["heat"] = json_of(*options.heat);
  if (options.compliance.is_on) {
    const ComplianceOptions& of = options.compliance;
    json["compliance"] = {{"free_length_mm", of.free_length_mm},
                          {"young_gpa", of.young_gpa},
                          {"flutes_share", of.flutes_share},
                          {"friction", of.friction},
                          {"bite_mm", of.bite_mm},
                          {"stall_n_mm", of.stall_n_mm},
                          {"spin_up_s", of.spin_up_s}};
  }
  return json;
}

ThermalTissue read_tissue(const JsonObject& bone, const char* key, const fs::path& file) {
  const JsonObject tissue = part_of(bone, key, file);
  return {tissue.number("conductivity_w_mm_k"), tissue.number("capacity_j_mm3_k")};
}

HeatOptions read_heat_part(const JsonObject& object, const fs::path& file) {
  const JsonObject bone = part_of(object, "bone", file);
  HeatOptions heat;
  heat.bone.cancellous_density_g_cm3 = bone.number("cancellous_density_g_cm3");
  heat.bone.cortical_density_g_cm3 = bone.number("cortical_density_g_cm3");
  heat.bone.cancellous = read_tissue(bone, "cancellous", file);
  heat.bone.cortical = read_tissue(bone, "cortical", file);
  heat.bone.temperature_c = bone.number("temperature_c");
  heat.bone.shear_angle_deg = bone.number("shear_angle_deg");
  heat.bone.water_w_mm2_k = bone.number("water_w_mm2_k");
  heat.is_irrigated = object.flag("is_irrigated");
  heat.distance_mm = object.number("distance_mm");
  heat.limit_c = object.number("limit_c");
  return heat;
}

SessionOptions read_options_part(const JsonObject& object, const fs::path& file) {
  constexpr double kInfinite = std::numeric_limits<double>::infinity();
  SessionOptions options;
  const JsonObject spindle = part_of(object, "spindle", file);
  options.spindle = {spindle.number("rpm"), spindle.flag("is_clockwise")};
  const JsonObject stop = part_of(object, "stop", file);
  options.stop.thrust_n = limit(stop, "thrust_n", kInfinite);
  options.stop.clearance_mm = limit(stop, "clearance_mm", -kInfinite);
  options.stop.on_breach = stop.flag("on_breach");
  const JsonObject states = part_of(object, "states", file);
  options.states.contact_g_cm3 = states.number("contact_g_cm3");
  options.states.cortical_g_cm3 = states.number("cortical_g_cm3");
  options.states.hold_mm = states.number("hold_mm");
  // Records of before knew neither; their states do not come again.
  if (states.has("near_mm")) {
    options.states.cancellous_g_cm3 = states.number("cancellous_g_cm3");
    options.states.near_mm = states.number("near_mm");
    options.states.rise = states.number("rise");
    options.states.no_cortex_mm = states.number("no_cortex_mm");
  }
  options.max_jump_mm = object.number("max_jump_mm");
  if (object.has("compliance")) {
    const JsonObject of = part_of(object, "compliance", file);
    options.compliance = {.is_on = true,
                          .free_length_mm = of.number("free_length_mm"),
                          .young_gpa = of.number("young_gpa"),
                          .flutes_share = of.number("flutes_share"),
                          .friction = of.number("friction"),
                          .bite_mm = of.number("bite_mm"),
                          .stall_n_mm = of.number("stall_n_mm"),
                          .spin_up_s = of.number("spin_up_s")};
  }
  if (object.has("has_device")) options.has_device = object.flag("has_device");
  if (object.has("has_support")) options.has_support = object.flag("has_support");
  if (object.has("follows_path")) options.follows_path = object.flag("follows_path");
  if (object.has("has_path")) options.has_path = object.flag("has_path");
  if (object.has("heat")) options.heat = read_heat_part(part_of(object, "heat", file), file);
  return options;
}

Json json_of(const DrilledHole& hole) {
  // A pose is the tip's place, mm, and the axis, of a plate its side too, where it is another than the pose before had.
  const bool has_sides = hole.bit.is_plate();
  Json ways = Json::array();
  for (const std::vector<Pose>& way : hole.ways) {
    Json poses = Json::array();
    for (std::size_t n = 0; n < way.size(); ++n) {
      Json pose = to_json(way[n].tip_mm);
      if (n == 0 || way[n].axis != way[n - 1].axis || way[n].side != way[n - 1].side) {
        for (const double one : way[n].axis) pose.push_back(one);
        if (has_sides) {
          for (const double one : way[n].side) pose.push_back(one);
        }
      }
      poses.push_back(std::move(pose));
    }
    ways.push_back(std::move(poses));
  }
  return {{"bit", to_json(hole.bit)}, {"ways", ways}};
}

const Json& list_of(const JsonObject& object, const char* key, const fs::path& file) {
  const Json& list = object.at(key);
  if (!list.is_array()) fail("expected an array for \"", key, "\" in ", file.string(), ", found ", shown_value(list));
  return list;
}

Pose read_pose(const Json& json, const DrillBit& bit, const Pose& before, const fs::path& file) {
  constexpr double kMaxMm = 1e4;
  const bool has_sides = bit.is_plate();
  const std::size_t whole = has_sides ? 9 : 6;
  const bool is_pose = json.is_array() && (json.size() == 3 || json.size() == whole) &&
                       std::ranges::all_of(json, [](const Json& one) { return one.is_number(); });
  if (!is_pose) {
    fail("expected [x, y, z] or [x, y, z, axis", has_sides ? ", side" : "", "] for a pose in ", file.string(),
         ", found ", shown_value(json));
  }
  const auto three = [&](std::size_t first) {
    return Vec3(json[first].get<double>(), json[first + 1].get<double>(), json[first + 2].get<double>());
  };
  const bool is_whole = json.size() == whole;
  const Pose pose{three(0), is_whole ? three(3) : before.axis, is_whole && has_sides ? three(6) : before.side};
  const std::optional<Pose> sound = valid_pose(pose, bit);
  if (!sound || sound->tip_mm.cwiseAbs().maxCoeff() > kMaxMm) {
    fail("expected poses within 10 m and with axes of length 1 in ", file.string(), ", found ", shown_value(json));
  }
  return *sound;
}

std::vector<Pose> read_way(const Json& json, const DrillBit& bit, const fs::path& file) {
  std::vector<Pose> way;
  if (!json.is_array()) fail("expected an array for a way in ", file.string(), ", found ", shown_value(json));
  for (const Json& pose : json) {
    way.push_back(read_pose(pose, bit, way.empty() ? Pose{Vec3::Zero(), Vec3::Zero()} : way.back(), file));
  }
  return way;
}

Box3 read_region(const JsonObject& object, const fs::path& file) {
  const Json& corners = list_of(object, "region_mm", file);
  const auto is_corner = [](const Json& one) {
    return one.is_array() && one.size() == 3 &&
           std::ranges::all_of(one, [](const Json& number) { return number.is_number(); });
  };
  if (corners.size() != 2 || !std::ranges::all_of(corners, is_corner)) {
    fail("expected two corners, [[x, y, z], [x, y, z]], for \"region_mm\" in ", file.string(), ", found ",
         shown_value(corners));
  }
  const auto corner = [&](std::size_t n) {
    return Vec3(corners[n][0].get<double>(), corners[n][1].get<double>(), corners[n][2].get<double>());
  };
  return {corner(0), corner(1)};
}

DrilledHole read_hole(const Json& json, const fs::path& file) {
  const JsonObject object(json, file);
  DrilledHole hole;
  hole.bit = read_bit(object.at("bit"), file);
  for (const Json& way : list_of(object, "ways", file)) hole.ways.push_back(read_way(way, hole.bit, file));
  return hole;
}

}  // namespace

Json to_json(const SessionSetup& setup) {
  Json json{
      {"bone_hash", setup.bone_hash},
      {"path", to_json(setup.path)},
      {"material", to_json(setup.material)},
      {"volume", json_of(setup.volume)},
      {"fine", {{"spacing_mm", setup.fine_spacing_mm}, {"near_mm", setup.fine_near_mm}, {"tip_mm", setup.fine_tip_mm}}},
      {"engine", name_of(chosen_engine(setup))},
      {"options", json_of(setup.options)},
      {"has_clearances", setup.has_clearances}};
  if (!setup.bone.is_empty()) json["bone"] = to_json(setup.bone);
  if (setup.takes_other_ct) json["takes_other_ct"] = true;
  if (setup.region_mm) json["region_mm"] = {to_json(setup.region_mm->min()), to_json(setup.region_mm->max())};
  for (const DrilledHole& hole : setup.holes) json["holes"].push_back(json_of(hole));
  if (!setup.further_bone_hashes.empty()) json["further_bone_hashes"] = setup.further_bone_hashes;
  return json;
}

EngineKind read_engine(const JsonObject& object, const std::filesystem::path& file) {
  const std::string engine = object.text("engine");
  const auto kind = engine_kinds().find(engine);
  if (kind == engine_kinds().end()) {
    fail("expected the name of a drilling engine for \"engine\" in ", file.string(), ", found ", in_quotes(engine));
  }
  return kind->second;
}

SessionSetup read_session_setup(const Json& json, const std::filesystem::path& file) {
  const JsonObject object(json, file);
  SessionSetup setup;
  setup.bone_hash = object.text("bone_hash");
  if (object.has("bone")) setup.bone = read_bone_identity(object.at("bone"), file);
  if (object.has("takes_other_ct")) setup.takes_other_ct = object.flag("takes_other_ct");
  setup.path = read_path(object.at("path"), file);
  setup.material = material_of(object.at("material"), file);
  setup.volume = read_volume_part(part_of(object, "volume", file), file);
  const JsonObject fine = part_of(object, "fine", file);
  setup.fine_spacing_mm = fine.number("spacing_mm");
  setup.fine_near_mm = fine.number("near_mm");
  setup.fine_tip_mm = fine.number("tip_mm");
  setup.engine = read_engine(object, file);
  if (object.has("region_mm")) setup.region_mm = read_region(object, file);
  setup.options = read_options_part(part_of(object, "options", file), file);
  setup.has_clearances = object.flag("has_clearances");
  if (object.has("holes")) {
    for (const Json& hole : list_of(object, "holes", file)) setup.holes.push_back(read_hole(hole, file));
  }
  if (object.has("further_bone_hashes")) {
    for (const Json& hash : list_of(object, "further_bone_hashes", file)) {
      if (!hash.is_string()) fail("expected texts for \"further_bone_hashes\" in ", file.string());
      setup.further_bone_hashes.push_back(hash.get<std::string>());
    }
  }
  try {
    check_path(setup.path);
    check_material(setup.material);
    if (setup.region_mm) check_region(*setup.region_mm);
    for (const DrilledHole& hole : setup.holes) check_bit(hole.bit);
  } catch (const Error& error) {
    fail(file.string(), ": ", error.what());
  }
  return setup;
}

}  // namespace spinaltap
