#include "core/files/material_file.h"

#include <array>
#include <nlohmann/json.hpp>
#include <utility>

#include "core/base/error.h"
#include "core/files/density_file.h"
#include "core/files/detail/material_json.h"

namespace spinaltap {
namespace {

constexpr std::array kNumbers{std::pair{"cutting_mpa", &Material::cutting_mpa},
                              std::pair{"cutting_exponent", &Material::cutting_exponent},
                              std::pair{"reference_feed_mm", &Material::reference_feed_mm},
                              std::pair{"feed_exponent", &Material::feed_exponent},
                              std::pair{"lip_thrust_share", &Material::lip_thrust_share},
                              std::pair{"chisel_mpa", &Material::chisel_mpa},
                              std::pair{"chisel_exponent", &Material::chisel_exponent},
                              std::pair{"chisel_share", &Material::chisel_share},
                              std::pair{"contact_n_mm", &Material::contact_n_mm},
                              std::pair{"contact_exponent", &Material::contact_exponent}};
static_assert(sizeof(Material) == sizeof(DensityLaw) + kNumbers.size() * sizeof(double), "a number has no key");

}  // namespace

Json to_json(const Material& material) {
  Json json{{kAtZero, material.density.at_0_hu}, {kPerHu, material.density.per_hu}};
  for (const auto& [key, member] : kNumbers) json[key] = material.*member;
  return json;
}

Material material_of(const Json& json, const std::filesystem::path& file) {
  const JsonObject object(json, file);
  Material material;
  material.density = {object.number(kAtZero), object.number(kPerHu)};
  for (const auto& [key, member] : kNumbers) material.*member = object.number(key);
  return material;
}

Material read_material(const std::filesystem::path& path, const DensityLaw& density) {
  const Json json = read_json(path);
  const JsonObject object(json, path);
  const auto refuse = [&](const char* key, const char* why) {
    // Left unread, it would change nothing without a word.
    if (object.has(key)) fail("expected no \"", key, "\" in ", path.string(), ": ", why);
  };
  refuse(kAtZero, "the density's law has its own file");
  refuse(kPerHu, "the density's law has its own file");
  refuse("pressure_at_1_g_cm3_mpa", "it is now \"cutting_mpa\", at \"reference_feed_mm\"; see docs/forces.md");
  refuse("pressure_exponent", "it is now \"cutting_exponent\"; see docs/forces.md");

  Material material;
  material.density = density;
  for (const auto& [key, member] : kNumbers) material.*member = object.number(key);
  try {
    check_material(material);
  } catch (const Error& error) {
    fail(path.string(), ": ", error.what());
  }
  return material;
}

}  // namespace spinaltap
