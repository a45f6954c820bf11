#pragma once

#include <string>

#include "core/ct/level.h"

namespace spinaltap {

/// Which vertebra of which CT a plan, a registration or a record is of. Holds nothing that identifies a patient.
struct BoneIdentity {
  /// CtVolume::whole_hash of the CT that the bone was baked from, at whatever voxel size; of a bone without a CT, of a
  /// mesh for example, its own (Bone::identity()). Empty: not known.
  std::string ct_hash = {};
  Level level = Level::kNone;  ///< kNone: not known

  bool names_ct() const { return !ct_hash.empty(); }
  bool is_empty() const { return ct_hash.empty() && level == Level::kNone; }
  bool operator==(const BoneIdentity&) const = default;
};

/// "L3 of the CT 0123456789abcdef", with what is not known left out.
std::string words_of(const BoneIdentity& identity);

/// Whether both may be one bone: what either does not know speaks against nothing.
bool may_be_same(const BoneIdentity& a, const BoneIdentity& b);

/// Throws Error, of the kind "plan "left" is of L4 of the CT 01.., the bone is L3 of the CT 89..", where they are not
/// the same. `what` names what names a bone; `remedy`: what to do where that is meant, added to the words.
void check_same_bone(const std::string& what, const BoneIdentity& named, const BoneIdentity& bone,
                     const std::string& remedy = "");

}  // namespace spinaltap
