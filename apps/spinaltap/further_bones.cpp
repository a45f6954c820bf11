#include "apps/spinaltap/further_bones.h"

#include <algorithm>
#include <optional>

#include "core/base/error.h"

namespace spinaltap {

CLI::Option* add_also(CLI::App& app, std::vector<std::string>& also) {
  return app
      .add_option("--additional-bone", also,
                  "A further bone of the same patient that is drilled wherever the tool meets it, with the level where "
                  "the file holds several; may come again. Voxels only")
      ->allow_extra_args(false)
      ->type_name("FILE[:LEVEL]");
}

std::vector<Bone> load_bones(const std::filesystem::path& bone, Level level, std::span<const std::string> also) {
  std::vector<Bone> bones{Bone::load(bone, level)};
  for (const std::string& text : also) {
    const std::size_t colon = text.rfind(':');
    const bool has_level = colon != std::string::npos && !std::filesystem::exists(text);
    const std::optional<Level> its_level = has_level ? level_from_name(text.substr(colon + 1)) : Level::kNone;
    if (!its_level) fail("expected --additional-bone FILE or FILE:LEVEL, such as spine.vdb:L5; found \"", text, "\"");
    bones.push_back(Bone::load(text.substr(0, has_level ? colon : std::string::npos), *its_level));
  }
  return bones;
}

std::vector<std::string> names_of_further(std::span<const Bone> bones) {
  std::vector<std::string> names;
  for (std::size_t n = 1; n < bones.size(); ++n) {
    const Level level = bones[n].level();
    const bool is_its_own = level != Level::kNone && std::ranges::count(bones, level, &Bone::level) == 1;
    names.push_back(is_its_own ? level_name(level) : std::to_string(n + 1));
  }
  return names;
}

void FieldOfBones::evaluate(std::span<const Vec3> points_mm, std::span<double> values_mm,
                            std::span<Vec3> gradients) const {
  fields_.front().evaluate(points_mm, values_mm, gradients);
  std::vector<double> others_mm(points_mm.size());
  std::vector<Vec3> slopes(gradients.size());
  for (const BoneField& field : std::span(fields_).subspan(1)) {
    field.evaluate(points_mm, others_mm, slopes);
    for (std::size_t n = 0; n < points_mm.size(); ++n) {
      if (!(others_mm[n] < values_mm[n])) continue;
      values_mm[n] = others_mm[n];
      if (!gradients.empty()) gradients[n] = slopes[n];
    }
  }
}

}  // namespace spinaltap
