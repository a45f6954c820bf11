#include "core/files/planning_json.h"

#include <nlohmann/json.hpp>

#include "core/files/detail/tool_json.h"
#include "core/files/landmarks_text.h"

namespace spinaltap {
namespace {

Json json_of(const PedicleLandmarks& pedicle) {
  return {{"isthmus_mm", to_json(pedicle.isthmus_mm)},
          {"axis", to_json(pedicle.axis)},
          {"width_axis", to_json(pedicle.width_axis)},
          {"height_axis", to_json(pedicle.height_axis)},
          {"width_mm", pedicle.width_mm},
          {"height_mm", pedicle.height_mm}};
}

Json json_of(const EndplateLandmarks& plate) {
  return {{"centre_mm", to_json(plate.centre_mm)}, {"normal", to_json(plate.normal)}};
}

}  // namespace

Json to_json(const Landmarks& landmarks) {
  const Landmarks::Body& body = landmarks.body;
  return {{"frame", "LPS"},
          {"origin_mm", to_json(landmarks.origin_mm)},
          {"left", to_json(landmarks.left())},
          {"posterior", to_json(landmarks.posterior())},
          {"superior", to_json(landmarks.superior())},
          {"canal",
           {{"centre_mm", to_json(landmarks.canal.centre_mm)},
            {"axis", to_json(landmarks.canal.axis)},
            {"width_mm", landmarks.canal.width_mm},
            {"depth_mm", landmarks.canal.depth_mm}}},
          {"body",
           {{"centre_mm", to_json(body.centre_mm)},
            {"width_mm", body.width_mm},
            {"depth_mm", body.depth_mm},
            {"height_mm", body.height_mm},
            {"upper_endplate", json_of(body.upper)},
            {"lower_endplate", json_of(body.lower)}}},
          {"left_pedicle", json_of(landmarks.left_pedicle)},
          {"right_pedicle", json_of(landmarks.right_pedicle)},
          {"warnings", landmarks.warnings}};
}

std::string landmarks_text(const Landmarks& landmarks) { return to_json(landmarks).dump(); }

Json to_json(const Suggestion& suggestion) {
  if (!suggestion.best) return {{"side", suggestion.side}, {"rejection", suggestion.rejection}};
  const SuggestedPath& best = *suggestion.best;
  const SafeZone& safe = best.safe;
  std::vector<std::string> warnings;
  for (const Finding& finding : best.grade.findings) {
    if (finding.is_warning) warnings.push_back(finding.words);
  }
  return {{"side", suggestion.side},
          {"grade", std::string(1, letter_of(best.grade.grade))},
          {"grade_in_words", grade_in_words(best.grade)},
          {"breach_mm", best.grade.breach_mm},
          {"warnings", warnings},
          {"entry_mm", to_json(best.path.entry_mm)},
          {"target_mm", to_json(best.path.target_mm)},
          {"screw", to_json(*best.path.screw)},
          {"technique", name_of(best.technique)},
          {"margin_mm", best.margin_mm},
          {"reasons", best.reasons},
          {"score", best.score},
          {"convergence_deg", best.angles.convergence_deg},
          {"inclination_deg", best.angles.inclination_deg},
          {"trajectories_tried", best.trajectories_tried},
          {"safe_zone",
           {{"medial_mm", safe.medial_mm},
            {"lateral_mm", safe.lateral_mm},
            {"cranial_mm", safe.cranial_mm},
            {"caudal_mm", safe.caudal_mm},
            {"medial_deg", safe.medial_deg},
            {"lateral_deg", safe.lateral_deg},
            {"cranial_deg", safe.cranial_deg},
            {"caudal_deg", safe.caudal_deg}}}};
}

}  // namespace spinaltap
