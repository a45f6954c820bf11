#include "apps/common/material_file.h"

#include "apps/common/json_file.h"
#include "core/base/error.h"

namespace spinaltap {

Material read_material(const std::filesystem::path& path, const DensityLaw& density) {
  const Json json = read_json(path);
  const JsonObject object(json, path);
  for (const char* key : {"density_at_0_hu_g_cm3", "density_per_hu_g_cm3"}) {
    // Left unread, it would change nothing without a word.
    if (object.has(key)) fail("expected no \"", key, "\" in ", path.string(), ": the density's law has its own file");
  }
  const Material material{density, object.number("pressure_at_1_g_cm3_mpa"), object.number("pressure_exponent")};
  try {
    check_material(material);
  } catch (const Error& error) {
    fail(path.string(), ": ", error.what());
  }
  return material;
}

}  // namespace spinaltap
