#pragma once

#include <string>
#include <string_view>

#include "core/ct/level.h"

namespace spinaltap::detail {

/// A concept as DICOM codes it (PS3.3, section 8).
struct DicomCode {
  std::string value;    ///< "36470004"
  std::string scheme;   ///< "SCT": SNOMED CT; "SRT" or "SNM3": SNOMED's older codes
  std::string meaning;  ///< "L3 vertebra"
};

/// The vertebra that a code stands for (PS3.16, CID 7603, and the sacrum); kNone for other codes.
Level level_of_code(const DicomCode& code);

/// Whether a code says no more than that something is a vertebra, or bone: which one is then said elsewhere.
bool is_any_bone_code(const DicomCode& code);

/// Whether a code of SNOMED's says that something is neither a vertebra nor a bone whose level may be said elsewhere: a
/// rib, a disc, a tumour. Not "tissue", "organ" and "anatomical structure", which writers put by default, and not codes
/// of schemes that are not SNOMED's.
bool is_other_code(const DicomCode& code);

/// The code to write for what a label is: of the vertebra where there is one, of any vertebra for T13 and L6, which
/// SNOMED CT has no code for; "Rib" for names that say so, else "Bone".
DicomCode code_to_write(Level level, std::string_view name);

}  // namespace spinaltap::detail
