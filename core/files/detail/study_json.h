#pragma once

#include <cstdint>
#include <filesystem>

#include "core/files/json_file.h"
#include "core/study/study_design.h"

namespace spinaltap {

/// Who holds the bit in a study.
struct StudyHand {
  enum class Kind : std::uint8_t {
    feed,  ///< goes on evenly, whatever the bone
    push   ///< pushes with a force: how fast it goes follows from the bone, and it plunges at a breakthrough
  };
  Kind kind = Kind::feed;
  double feed_mm_s = 1.0;
  double step_mm = 0.01;  ///< of a hand that feeds: advance a cycle
  double push_n = 20.0;
  double rate_hz = 1000.0;     ///< of a hand that pushes: cycles a second
  double reaction_s = 0.2;     ///< as PushOptions has them, and the next
  double noticed_share = 0.2;  ///< of the push
  double tremor_mm = 0.0;      ///< as Tremor has it
};

/// What check_keys() says of SPEC.json.
constexpr std::string_view kStudyKey = "a key of a study";

/// The hand and the design, as SPEC.json has them.
Json to_json(const StudyHand& hand);
Json to_json(const StudyDesign& design);

/// Reads what to_json() made, and "hand" and the design's keys of SPEC.json. Throw Error that names the file and the
/// key at fault.
StudyHand read_study_hand(const Json& json, const std::filesystem::path& file);
StudyDesign read_study_design(const Json& json, const std::filesystem::path& file);

}  // namespace spinaltap
