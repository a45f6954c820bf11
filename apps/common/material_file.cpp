#include "apps/common/material_file.h"

#include "apps/common/json_file.h"
#include "core/base/error.h"

namespace spinaltap {

Material read_material(const std::filesystem::path& path) {
  const Json json = read_json(path);
  const JsonObject object(json, path);
  const Material material{object.number("density_at_0_hu_g_cm3"), object.number("density_per_hu_g_cm3"),
                          object.number("pressure_at_1_g_cm3_mpa"), object.number("pressure_exponent")};
  try {
    check_material(material);
  } catch (const Error& error) {
    fail(path.string(), ": ", error.what());
  }
  return material;
}

}  // namespace spinaltap
