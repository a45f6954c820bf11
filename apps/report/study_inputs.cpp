#include "apps/report/study_inputs.h"

#include <cmath>

#include "apps/report/study_plots.h"
#include "apps/report/text.h"
#include "core/base/number_text.h"

namespace spinaltap {
namespace {

std::string text_of(double number) {
  std::string text;
  append_number(number, text);
  return text;
}

ReportRow row_of(const FactorLaw& law) {
  const StudyTitle title = title_of(law.factor);
  std::string name = title.name;
  name[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(name[0])));
  switch (law.kind) {
    case FactorLaw::Kind::normal:
      return {name, "normal, mean " + text_of(law.a) + ", deviation " + text_of(law.b), title.unit};
    case FactorLaw::Kind::uniform:
      return {name, "even, " + text_of(law.a) + " to " + text_of(law.b), title.unit};
    case FactorLaw::Kind::levels:
      break;
  }
  std::string levels;
  for (const double level : law.levels) levels += (levels.empty() ? "" : ", ") + text_of(level);
  return {name, levels, title.unit};
}

}  // namespace

StudyInputs study_inputs(const StudyIdentity& identity, const std::filesystem::path& file) {
  const IdentifiedStudy study = study_of(identity, file);
  const SessionSetup& setup = study.setup;
  const StudyHand& hand = study.hand;
  StudyInputs inputs{study.name, study.design, {}};
  const auto add = [&](const std::string& name, const std::string& value, const std::string& unit) {
    inputs.rows.push_back({name, value, unit});
  };
  if (!setup.path.name.empty()) add("Path", setup.path.name, "");
  add("Length, entry to target", readable_number(setup.path.length_mm(), 1), "mm");
  add("Bit, diameter × length", text_of(setup.path.bit.diameter_mm) + " × " + text_of(setup.path.bit.length_mm), "mm");
  add("Spindle", text_of(setup.options.spindle.rpm), "rpm");
  if (hand.kind == StudyHand::Kind::feed) {
    add("Hand", "feeds at " + text_of(hand.feed_mm_s) + " mm/s in steps of " + text_of(hand.step_mm) + " mm", "");
  } else {
    add("Hand", "pushes with " + text_of(hand.push_n) + " N, " + text_of(hand.rate_hz) + " cycles a second", "");
  }
  if (hand.tremor_mm > 0.0) add("Tremor", text_of(hand.tremor_mm), "mm");
  const StopRules& stop = setup.options.stop;
  if (std::isfinite(stop.thrust_n)) add("Asked to stop at a thrust of", text_of(stop.thrust_n), "N");
  if (std::isfinite(stop.clearance_mm)) add("Asked to stop at a clearance of", text_of(stop.clearance_mm), "mm");
  if (stop.on_breach) add("Asked to stop", "on a breach", "");
  add("Points, spacing", text_of(setup.volume.spacing_mm), "mm");
  add("Points, radius of the cylinder", readable_number(setup.volume.radius_mm, 2), "mm");
  for (const FactorLaw& law : inputs.design.laws) inputs.rows.push_back(row_of(law));
  add("Runs", std::to_string(identity.runs), "");
  add("Sampling", inputs.design.is_latin ? "Latin hypercube" : "random", "");
  add("Seed", std::to_string(inputs.design.seed), "");
  add("Bone, fingerprint", setup.bone_hash, "");
  add("Study, fingerprint", identity.hash(), "");
  return inputs;
}

}  // namespace spinaltap
