// Levels spoilt on purpose, in the CT or on the way: each must be warned of, so that nobody drills what is not there.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <functional>
#include <string>

#include "core/base/error.h"
#include "core/segment/cut_levels.h"
#include "tests/support/spine_scan.h"
#include "tests/support/spine_scores.h"
#include "tests/support/test_kind.h"

namespace spinaltap {
namespace {

enum class Word { none, warning, suspect };  ///< said of a spoilt case; suspect ends a program with an error

/// How many spoilt cases there were, and which were not warned of.
struct Tally {
  int cases = 0;
  std::vector<std::string> missed;
  std::vector<std::string> not_suspect;

  void add(const std::string& what, Word word, const std::string& texts) {
    ++cases;
    if (word == Word::none) missed.push_back(what);
    if (word != Word::suspect) not_suspect.push_back(what);
    const char* const said = word == Word::none ? "NOT TOLD: " : word == Word::warning ? "a word: " : "suspect: ";
    std::printf("%-28s %s%s\n", what.c_str(), said, texts.c_str());
  }
};

SpineOptions t10_to_l2() {
  SpineOptions options;
  options.first = Level{17};
  options.last = Level{21};
  return options;
}

ScanOptions one_mm() {
  ScanOptions options = test::coarse_scan_options();
  options.pixel_mm = 0.8;
  options.slice_step_mm = options.slice_width_mm = 1.0;
  return options;
}

/// Sets voxels of a CT: `hu(centre, number now)`, for places within a box.
CtVolume painted(const CtVolume& ct, const Box3& box_mm, const std::function<double(const Vec3&, double)>& hu) {
  std::vector<std::int16_t> values = ct.hu;
  const VoxelBlock block = block_in_box(ct.geometry, box_mm);
  for (int k = block.first[2]; k <= block.last[2]; ++k) {
    for (int j = block.first[1]; j <= block.last[1]; ++j) {
      for (int i = block.first[0]; i <= block.last[0]; ++i) {
        std::int16_t& value = values[ct.geometry.offset(i, j, k)];
        value = static_cast<std::int16_t>(std::lround(hu(ct.geometry.to_patient(Vec3(i, j, k)), value)));
      }
    }
  }
  return make_ct_volume(ct.geometry, std::move(values));
}

/// Fills gaps under `gap_mm` between bodies that `between` names with bone, to the left of `right_mm`.
CtVolume bridged(const CtVolume& ct, const Spine& spine, double gap_mm, double right_mm,
                 const std::function<bool(std::size_t, std::size_t)>& between) {
  CtVolume result = ct;
  for (std::size_t a = 0; a < spine.part_count(); ++a) {
    for (std::size_t b = a + 1; b < spine.part_count(); ++b) {
      if (!between(a, b)) continue;
      Box3 shared = spine.part(a).solid->bounds_mm().intersection(spine.part(b).solid->bounds_mm());
      if (shared.isEmpty()) continue;
      shared.min() -= Vec3::Constant(gap_mm);
      shared.max() += Vec3::Constant(gap_mm);
      try {
        result = painted(result, shared, [&](const Vec3& p, double hu) {
          const bool in_gap = p.x() > right_mm && spine.part_value_mm(a, p) + spine.part_value_mm(b, p) < gap_mm;
          return in_gap ? std::max(hu, 600.0) : hu;
        });
      } catch (const Error&) {  // beyond the CT
      }
    }
  }
  return result;
}

/// Tells of the levels of a spoilt CT that `is_spoilt` names, with how right they still are.
void tally_levels(const CtVolume& ct, const Spine& spine, const std::string& kind,
                  const std::function<bool(Level)>& is_spoilt, Tally& tally) {
  const SpineSegmentation found = segment_spine(ct);
  const test::SpineScore score = test::score_of(found, spine);
  const SpineGroundTruth ground_truth = spine_ground_truth(spine);
  for (std::size_t n = 0; n < score.levels.size(); ++n) {
    const test::LevelScore& level = score.levels[n];
    if (!is_spoilt(level.level)) continue;
    char figures[64];
    std::snprintf(figures, sizeof figures, "Dice %.3f, of neighbours %.2f %%: ", level.dice,
                  100.0 * level.neighbour_share);
    const bool has_words = level.found && !found.levels[*level.found].warnings.empty();
    const Word word = test::is_told(level, ground_truth.levels[n].body_centre_mm, found) ? Word::suspect
                      : has_words                                                        ? Word::warning
                                                                                         : Word::none;
    tally.add(kind + ", " + level_name(level.level), word,
              level.found ? figures + test::texts_of(found.levels[*level.found]) : "not found");
  }
}

/// A body straddles the disc above the body `n` of a chain: it begins and ends in the middles of two bodies.
void tally_straddled(const CtVolume& ct, const SpineBodies& right, std::size_t n, Tally& tally) {
  SpineBodies spine = right;
  const FloatGrid smooth = gaussian_blur(hu_around_canal(ct, spine.canal), 0.9);
  const WallLevels walls{spine.levels.low_hu};
  const WallProbe probe(smooth, walls);
  const auto middle_end = [&](const BodySpan& span, double outward) {
    BodyEnd end;
    end.s_mm = 0.5 * (span.lower.s_mm + span.upper.s_mm);
    end.centre_mm = 0.5 * (span.lower.centre_mm + span.upper.centre_mm);
    end.up = (span.lower.up + span.upper.up).normalized();
    // As much of an endplate as is there.
    double sum = 0.0;
    double count = 0.0;
    for (double x = -0.7; x <= 0.71; x += 0.1) {
      for (double y = -0.7; y <= 0.71; y += 0.1) {
        if (std::hypot(x, y) > 0.7) continue;
        const Vec3 p =
            end.centre_mm + span.middle.axes * Vec3(x * span.middle.half_width_mm, y * span.middle.half_depth_mm, 0.0);
        sum += probe.edge(p, outward * end.up);
        count += 1.0;
      }
    }
    end.edge = sum / count;
    return end;
  };
  BodySpan& span = spine.chain[n];
  span.lower = middle_end(right.chain[n], -1.0);
  span.upper = middle_end(right.chain[n + 1], 1.0);
  spine.bodies[n] = find_vertebral_body(probe, find_body_cylinders(probe, {span}).front());
  // The next one is gone.
  spine.chain.erase(spine.chain.begin() + static_cast<std::ptrdiff_t>(n) + 1);
  spine.bodies.erase(spine.bodies.begin() + static_cast<std::ptrdiff_t>(n) + 1);
  cut_levels(ct, spine, n, n, {}, [&](CutVertebra&& cut) {
    const std::vector<LevelWarning> warnings =
        check_level(cut.figures, spine.chain, {spine.bodies, spine.canal, cut.index});
    std::string texts;
    for (const LevelWarning& warning : warnings) texts += warning.text + "; ";
    tally.add("straddled disc " + std::to_string(n),
              total_severity(warnings) >= kSuspect ? Word::suspect
              : warnings.empty()                   ? Word::none
                                                   : Word::warning,
              texts);
  });
}

WHOLE_RUNS("SuspectLevels.*");

TEST(SuspectLevels, AreToldWhateverSpoilsThem) {
  const Spine spine(t10_to_l2());
  const SpineGroundTruth ground_truth = spine_ground_truth(spine);
  const CtVolume ct = test::scan_spine(spine, one_mm());
  const auto any = [](Level) { return true; };
  Tally tally;
  Tally joints;  // neighbours' joints and ribs fused: most of a vertebra is right then, and a word names the place

  const SpineBodies bodies = find_spine_bodies(ct);
  ASSERT_EQ(bodies.bodies.size(), ground_truth.levels.size());
  for (std::size_t n = 0; n + 1 < bodies.bodies.size(); ++n) tally_straddled(ct, bodies, n, tally);

  const auto is_vertebra = [&](std::size_t n) { return spine.part(n).label != kRibLabel; };
  // Joints only: discs are higher.
  tally_levels(
      bridged(ct, spine, 3.0, -1e3, [&](std::size_t a, std::size_t b) { return is_vertebra(a) && is_vertebra(b); }),
      spine, "bridged joints", any, joints);
  tally_levels(
      bridged(ct, spine, 4.0, 0.0, [&](std::size_t a, std::size_t b) { return is_vertebra(a) != is_vertebra(b); }),
      spine, "rib left on", [](Level level) { return level_rank(level) <= level_rank(Level::kT12); }, joints);

  for (const bool is_left : {true, false}) {
    CtVolume cut = ct;
    for (const LevelGroundTruth& level : ground_truth.levels) {
      const PedicleGroundTruth& pedicle = is_left ? level.pedicles.left : level.pedicles.right;
      const double reach_mm = 0.5 * pedicle.height_mm + 4.0;
      const Box3 box(pedicle.isthmus_mm - Vec3::Constant(reach_mm + 2.0),
                     pedicle.isthmus_mm + Vec3::Constant(reach_mm + 2.0));
      cut = painted(cut, box, [&](const Vec3& p, double hu) {
        const Vec3 off = p - pedicle.isthmus_mm;
        const double along = off.dot(pedicle.axis);
        const bool in_gap = std::abs(along) < 1.5 && (off - along * pedicle.axis).norm() < reach_mm;
        return in_gap ? std::min(hu, 50.0) : hu;
      });
      ASSERT_LE(sample_hu(cut, pedicle.isthmus_mm), 51.0) << level_name(level.level);
    }
    tally_levels(cut, spine, is_left ? "left pedicle cut" : "right pedicle cut", any, tally);
  }

  SpineOptions with_screws = t10_to_l2();
  with_screws.screws = {Level{17}, Level{18}, Level{19}, Level{20}, Level{21}};
  const Spine screwed(with_screws);
  tally_levels(test::scan_spine(screwed, one_mm()), screwed, "screws", any, tally);

  for (const DiscGroundTruth& disc : ground_truth.discs) {
    std::string words;
    bool told = false;
    try {
      const Segmentation found = segment_vertebra(ct, {.seed_mm = disc.centre_mm});
      words = "body at " + std::to_string(found.report.body_centre_mm.z());
      told = std::any_of(ground_truth.levels.begin(), ground_truth.levels.end(), [&](const LevelGroundTruth& level) {
        return (level.body_centre_mm - found.report.body_centre_mm).norm() < 4.0 &&
               (level.level == disc.above || level.level == level_below(disc.above));
      });
    } catch (const Error& error) {
      words = error.what();
      told = true;
    }
    tally.add("seed in disc below " + level_name(disc.above), told ? Word::suspect : Word::none, words);
  }

  const int cases = tally.cases + joints.cases;
  const std::size_t missed = tally.missed.size() + joints.missed.size();
  std::printf(
      "%zu of %d spoilt cases are not told; of %d fused joints and ribs %zu are not suspect, of %d others %zu\n",
      missed, cases, joints.cases, joints.not_suspect.size(), tally.cases, tally.not_suspect.size());
  EXPECT_GE(cases, 30);
  EXPECT_LE(static_cast<double>(missed), 0.05 * cases);
  EXPECT_LE(static_cast<double>(tally.not_suspect.size()), 0.05 * tally.cases);
}

}  // namespace
}  // namespace spinaltap
