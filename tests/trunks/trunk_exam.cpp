// Compiled with optimisation: whole trunks are scanned.
#include "tests/trunks/trunk_exam.h"

#include "core/base/error.h"

namespace spinaltap::test {

std::string TrunkExam::what() const { return "seed " + std::to_string(seed) + " (" + describe(options) + ")"; }

CtVolume scan_trunk(const Spine& spine, const TrunkOptions& options) {
  return scan(spine, TrunkTissue(spine, options.tissue), options.scan);
}

TrunkExam examine_trunk(std::uint64_t seed) {
  TrunkExam exam;
  exam.seed = seed;
  exam.options = random_trunk_options(seed);
  const Spine spine(exam.options.spine);
  exam.ct = scan_trunk(spine, exam.options);
  exam.ground_truth = true_labels(spine, exam.ct.geometry);
  try {
    exam.found = segment_spine(exam.ct);
  } catch (const Error& error) {
    exam.found.labels = {exam.ct.geometry, std::vector<std::uint8_t>(exam.ct.geometry.voxel_count(), 0), {}};
    exam.found.gaps.emplace_back(error.what());
  }
  exam.score = score_trunk(exam.found, spine, exam.ground_truth);
  return exam;
}

std::string warnings_in_line(const LevelReport& report) {
  std::string line;
  for (const LevelWarning& warning : report.warnings) line += (line.empty() ? "" : "; ") + warning.text;
  return line;
}

}  // namespace spinaltap::test
