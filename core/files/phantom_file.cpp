#include "core/files/phantom_file.h"

#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <variant>

#include "core/base/error.h"
#include "core/base/text_fields.h"
#include "core/files/json_file.h"

namespace spinaltap {
namespace {

constexpr FileFormat kAnatomyFormat{"spinaltap-anatomy", "anatomy", "see docs/data-files.md"};

using Outline = decltype(VertebraAnatomy::Spinous::outline_mm);
using Target = std::variant<double*, Vec3*, Outline*, std::uint64_t*>;
using Group = std::map<std::string, Target>;

Group process_group(VertebraAnatomy::Process& process) {
  return {{"root_mm", &process.root_mm},
          {"tip_mm", &process.tip_mm},
          {"thin_direction", &process.thin_direction},
          {"root_thickness_mm", &process.root_thickness_mm},
          {"tip_thickness_mm", &process.tip_thickness_mm},
          {"width_over_thickness", &process.width_over_thickness},
          {"blend_mm", &process.blend_mm}};
}

Group pedicle_group(VertebraAnatomy::Pedicle& pedicle) {
  return {{"width_mm", &pedicle.width_mm},
          {"height_mm", &pedicle.height_mm},
          {"isthmus_mm", &pedicle.isthmus_mm},
          {"convergence_deg", &pedicle.convergence_deg},
          {"tilt_deg", &pedicle.tilt_deg},
          {"flare_mm", &pedicle.flare_mm},
          {"flare_length_mm", &pedicle.flare_length_mm},
          {"anterior_length_mm", &pedicle.anterior_length_mm},
          {"posterior_length_mm", &pedicle.posterior_length_mm},
          {"blend_mm", &pedicle.blend_mm}};
}

std::map<std::string, Group> groups_of(VertebraAnatomy& a) {
  return {
      {"body",
       {{"width_mm", &a.body.width_mm},
        {"depth_mm", &a.body.depth_mm},
        {"height_mm", &a.body.height_mm},
        {"waist_mm", &a.body.waist_mm},
        {"kidney_mm", &a.body.kidney_mm},
        {"kidney_width_mm", &a.body.kidney_width_mm},
        {"superior_hollow_mm", &a.body.superior_hollow_mm},
        {"inferior_hollow_mm", &a.body.inferior_hollow_mm},
        {"rim_mm", &a.body.rim_mm},
        {"edge_mm", &a.body.edge_mm},
        {"wedge_deg", &a.body.wedge_deg},
        {"side_wedge_deg", &a.body.side_wedge_deg}}},
      {"pedicle", pedicle_group(a.pedicle)},
      {"canal",
       {{"width_mm", &a.canal.width_mm},
        {"front_mm", &a.canal.front_mm},
        {"back_mm", &a.canal.back_mm},
        {"roof_deg", &a.canal.roof_deg},
        {"rounding_mm", &a.canal.rounding_mm},
        {"blend_mm", &a.canal.blend_mm}}},
      {"transverse", process_group(a.transverse)},
      {"superior_articular", process_group(a.superior_articular)},
      {"inferior_articular", process_group(a.inferior_articular)},
      {"pars", process_group(a.pars)},
      {"facet", {{"radius_mm", &a.facet.radius_mm}, {"hollow_mm", &a.facet.hollow_mm}}},
      {"mammillary",
       {{"centre_mm", &a.mammillary.centre_mm},
        {"radius_mm", &a.mammillary.radius_mm},
        {"blend_mm", &a.mammillary.blend_mm}}},
      {"lamina",
       {{"centre_mm", &a.lamina.centre_mm},
        {"slope_deg", &a.lamina.slope_deg},
        {"lean_deg", &a.lamina.lean_deg},
        {"length_mm", &a.lamina.length_mm},
        {"height_mm", &a.lamina.height_mm},
        {"thickness_mm", &a.lamina.thickness_mm},
        {"blend_mm", &a.lamina.blend_mm}}},
      {"spinous",
       {{"outline_mm", &a.spinous.outline_mm},
        {"rounding_mm", &a.spinous.rounding_mm},
        {"root_thickness_mm", &a.spinous.root_thickness_mm},
        {"tip_thickness_mm", &a.spinous.tip_thickness_mm},
        {"blend_mm", &a.spinous.blend_mm}}},
      {"cortex",
       {{"hu", &a.cortex.hu},
        {"body_wall_mm", &a.cortex.body_wall_mm},
        {"endplate_mm", &a.cortex.endplate_mm},
        {"pedicle_mm", &a.cortex.pedicle_mm},
        {"posterior_mm", &a.cortex.posterior_mm}}},
      {"cancellous",
       {{"body_hu", &a.cancellous.body_hu},
        {"pedicle_hu", &a.cancellous.pedicle_hu},
        {"posterior_hu", &a.cancellous.posterior_hu},
        {"texture_hu", &a.cancellous.texture_hu},
        {"texture_scale_mm", &a.cancellous.texture_scale_mm},
        {"texture_stretch", &a.cancellous.texture_stretch},
        {"texture_seed", &a.cancellous.texture_seed}}},
      {"placement", {{"position_mm", &a.placement.position_mm}, {"rotation_deg", &a.placement.rotation_deg}}},
  };
}

/// Where a value stands, for messages.
struct Place {
  std::string file, key;
};

double number(const Json& value, const Place& place) {
  if (!value.is_number() || !std::isfinite(value.get<double>())) {
    fail(place.file, ": ", place.key, ": a finite number expected, found ", shown_value(value));
  }
  return value.get<double>();
}

const Json& list(const Json& value, std::size_t count, const Place& place) {
  if (!value.is_array() || value.size() != count) {
    fail(place.file, ": ", place.key, ": a list of ", count, " expected, found ", shown_value(value));
  }
  return value;
}

void read(const Json& value, double* target, const Place& place) { *target = number(value, place); }

void read(const Json& value, Vec3* target, const Place& place) {
  list(value, 3, place);
  for (std::size_t n = 0; n < 3; ++n) (*target)[static_cast<Eigen::Index>(n)] = number(value[n], place);
}

void read(const Json& value, Outline* target, const Place& place) {
  list(value, target->size(), place);
  for (std::size_t n = 0; n < target->size(); ++n) {
    const Json& corner = list(value[n], 2, place);
    (*target)[n] = Eigen::Vector2d(number(corner[0], place), number(corner[1], place));
  }
}

void read(const Json& value, std::uint64_t* target, const Place& place) {
  if (!value.is_number_unsigned()) {
    fail(place.file, ": ", place.key, ": a whole number not below 0 expected, found ", shown_value(value));
  }
  *target = value.get<std::uint64_t>();
}

void read_group(const Json& object, Group& group, const Place& place) {
  if (!object.is_object()) fail(place.file, ": ", place.key, ": an object expected, found ", shown_value(object));
  for (const auto& item : object.items()) {
    const std::string& key = item.key();
    const Json& value = item.value();
    const Place inner{place.file, place.key + "." + key};
    if (key == "source") {
      if (!value.is_string()) fail(place.file, ": ", inner.key, ": a text expected, found ", shown_value(value));
      continue;
    }
    const auto found = group.find(key);
    if (found == group.end()) fail(place.file, ": unknown key ", place.key, ".", shown(key));
    std::visit([&](auto* target) { read(value, target, inner); }, found->second);
  }
}

}  // namespace

VertebraAnatomy read_anatomy(const std::filesystem::path& path) {
  const std::string file = path.string();
  const Json whole = read_json(path);
  if (!whole.is_object()) fail(file, ": an object expected");
  check_format(whole, kAnatomyFormat, path);
  VertebraAnatomy anatomy;
  std::map<std::string, Group> groups = groups_of(anatomy);
  for (const auto& [key, value] : whole.items()) {
    if (key == "right_pedicle" || key == "format" || key == "version") continue;
    if (key == "name" || key == "source") {
      if (!value.is_string()) fail(file, ": ", key, ": a text expected, found ", shown_value(value));
      continue;
    }
    const auto found = groups.find(key);
    if (found == groups.end()) fail(file, ": unknown key ", shown(key));
    read_group(value, found->second, {file, key});
  }
  // What it leaves out is as in the left one, so that one is read first.
  if (const auto right = whole.find("right_pedicle"); right != whole.end()) {
    Group group = pedicle_group(anatomy.right_pedicle.emplace(anatomy.pedicle));
    read_group(*right, group, {file, "right_pedicle"});
  }
  try {
    check_anatomy(anatomy);
  } catch (const Error& error) {
    fail(file, ": ", error.what());
  }
  return anatomy;
}

}  // namespace spinaltap
