#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/ct/made_up_slices.h"
#include "core/tool/drill_path.h"

namespace spinaltap {

/// Of a bone: where it is open whether there is bone, or whose it is.
struct DoubtfulBone {
  std::optional<MadeUpSlices> made_up = {};
  std::vector<Vec3> unsure_mm = {};  ///< places of bone that may be another vertebra's or a rib's, patient LPS

  bool is_empty() const { return !made_up && unsure_mm.empty(); }
};

/// Something that a path's grade leans on and that may not be so.
struct PathDoubt {
  enum class Kind {
    made_up_slices,  ///< the tool lies in slices that were filled in
    unsure_bone      ///< beside the tool is bone that may be another's
  };
  Kind kind = Kind::made_up_slices;
  double length_mm = 0.0;        ///< of the path where it is so
  double depth_mm = 0.0;         ///< of the first such place, from the entry
  Vec3 place_mm = Vec3::Zero();  ///< there, patient LPS
  double without_mm = 0.0;       ///< of unsure bone: clearance that is left where it is another's; negative: breach
};

/// "3.2 mm of it lie in slices that were made up", to stand behind "A, but ".
std::string in_words(const PathDoubt& doubt);

/// What a path's screw or, where it has none, its bit leans on, at steps of 0.25 mm from the entry to the target:
/// slices that were made up, and unsure bone without which the tool would stand out by more than 1 mm. Throws Error on
/// a path that makes no sense.
std::vector<PathDoubt> path_doubts(const DoubtfulBone& bone, const DrillPath& path);

}  // namespace spinaltap
