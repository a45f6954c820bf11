#include "vdb/sim/bone_identity.h"

#include "core/base/text_fields.h"
#include "vdb/grid/bone_hash.h"

namespace spinaltap {
namespace {

std::string text_in(const BoneModel& bone, const char* key) {
  const auto found = bone.metadata().find(key);
  return found == bone.metadata().end() ? std::string() : found->second;
}

}  // namespace

BoneIdentity identity_of(const BoneModel& bone) {
  BoneIdentity identity;
  identity.ct_hash = text_in(bone, kWholeCtHash);
  if (identity.ct_hash.empty()) identity.ct_hash = text_in(bone, kSourceHash);
  if (identity.ct_hash.empty()) identity.ct_hash = "bone-" + bone_hash(before_drilling(bone));
  identity.level = level_from_name(text_in(bone, "level")).value_or(Level::kNone);
  return identity;
}

void check_path_is_of(const DrillPath& path, const BoneIdentity& bone, const std::string& remedy) {
  check_same_bone("plan, path " + in_quotes(path.name) + ",", path.bone, bone, remedy);
}

}  // namespace spinaltap
