#include "core/ct/bone_identity.h"

#include "core/base/error.h"

namespace spinaltap {

std::string words_of(const BoneIdentity& identity) {
  const std::string ct = identity.names_ct() ? "the CT " + identity.ct_hash : "a CT that is not named";
  return identity.level == Level::kNone ? ct : level_name(identity.level) + " of " + ct;
}

bool may_be_same(const BoneIdentity& a, const BoneIdentity& b) {
  const bool other_ct = a.names_ct() && b.names_ct() && a.ct_hash != b.ct_hash;
  const bool other_level = a.level != Level::kNone && b.level != Level::kNone && a.level != b.level;
  return !other_ct && !other_level;
}

void check_same_bone(const std::string& what, const BoneIdentity& named, const BoneIdentity& bone,
                     const std::string& remedy) {
  if (may_be_same(named, bone)) return;
  const bool same_ct = named.ct_hash == bone.ct_hash;
  fail(what, " is of ", words_of(named), ", the bone is ", words_of(bone), ": ",
       same_ct ? "another vertebra of the same CT" : "another patient's, or another scan of the same one",
       "; take what was made for this bone", remedy);
}

}  // namespace spinaltap
