#pragma once

#include <CLI/CLI.hpp>

#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "core/base/scalar_field.h"
#include "vdb/grid/bone_field.h"
#include "vdb/grid/bone_model.h"
#include "vdb/sim/bone.h"

namespace spinaltap {

/// Adds --additional-bone: further bones of the same patient, each FILE or FILE:LEVEL. `also` must outlive the app.
CLI::Option* add_also(CLI::App& app, std::vector<std::string>& also);
/// The bone, then those of --additional-bone, in order. Throws Error as Bone::load() does.
std::vector<Bone> load_bones(const std::filesystem::path& bone, Level level, std::span<const std::string> also);
/// For each bone but the first a name for its files: its level, or which one it is where it has none of its own.
std::vector<std::string> names_of_further(std::span<const Bone> bones);

/// The distance to what lies in any of several bones.
class FieldOfBones final : public ScalarField {
 public:
  explicit FieldOfBones(std::span<const Bone> bones) {
    for (const Bone& bone : bones) fields_.emplace_back(bone.model());
  }
  void evaluate(std::span<const Vec3> points_mm, std::span<double> values_mm, std::span<Vec3> gradients) const override;

 private:
  std::vector<BoneField> fields_;
};

}  // namespace spinaltap
