// Compiled with optimisation: whole trunks are scanned and segmented.
//
// Random patients in random scanners (core/phantom/random_trunk.h), whole or in part, against their ground truth.
// SPINALTAP_TRUNKS=50 takes fifty, SPINALTAP_TRUNKS_FIRST=0 from that seed on, every second seed: the method may be
// made on even seeds, odd ones are kept to judge it.

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <cstdlib>
#include <string>

#include "core/segment/level_names.h"
#include "tests/support/test_kind.h"
#include "tests/trunks/trunk_exam.h"

namespace spinaltap {
namespace {

WHOLE_RUNS("Trunks.*");

std::uint64_t trunk_number(const char* name, std::uint64_t otherwise) {
  const char* const asked = std::getenv(name);
  return asked == nullptr ? otherwise : std::strtoull(asked, nullptr, 10);
}

struct TrunkCounts {
  int whole = 0, found = 0, right = 0, wrong = 0, untold = 0, missed_untold = 0, suspect = 0, extra = 0;
  int named = 0, unnamed = 0, misnamed = 0;

  void add(const TrunkCounts& other) {
    for (int TrunkCounts::*const count :
         {&TrunkCounts::whole, &TrunkCounts::found, &TrunkCounts::right, &TrunkCounts::wrong, &TrunkCounts::untold,
          &TrunkCounts::missed_untold, &TrunkCounts::suspect, &TrunkCounts::extra, &TrunkCounts::named,
          &TrunkCounts::unnamed, &TrunkCounts::misnamed}) {
      this->*count += other.*count;
    }
  }
};

/// Right and wrong levels by their severity.
struct Reliability {
  static constexpr std::array<double, 6> kTo{0.05, 0.2, 0.35, 0.5, 0.75, 1.01};
  std::array<int, 6> all{}, wrong{};

  void add(double severity, bool is_wrong) {
    const auto bin = static_cast<std::size_t>(std::upper_bound(kTo.begin(), kTo.end() - 1, severity) - kTo.begin());
    ++all[bin];
    wrong[bin] += is_wrong ? 1 : 0;
  }
  void print() const {
    std::printf("severity   levels  wrong\n");
    for (std::size_t n = 0; n < kTo.size(); ++n) {
      std::printf("to %-7.2f %6d %6d  %5.1f %%\n", std::min(kTo[n], 1.0), all[n], wrong[n],
                  100.0 * wrong[n] / std::max(1, all[n]));
    }
  }
};

/// One patient. Prints a line for each level that is missed or wrong.
TrunkCounts examine(std::uint64_t seed, Reliability& reliability) {
  const test::TrunkExam exam = test::examine_trunk(seed);
  const std::string what = exam.what();
  TrunkCounts counts;
  for (const test::WholeLevelScore& level : exam.score.levels) {
    ++counts.whole;
    if (!level.found) {
      counts.missed_untold += level.is_told ? 0 : 1;
      std::printf("%s %s: missed%s\n", what.c_str(), level_name(level.level).c_str(), level.is_told ? "" : ", NO WORD");
      continue;
    }
    const LevelReport& report = exam.report_of(level);
    const bool is_wrong = exam.is_wrong(level);
    ++counts.found;
    reliability.add(report.severity, is_wrong);
    if (report.level == Level::kNone) {
      ++counts.unnamed;
    } else {
      const bool is_right = report.level == level.level;
      ++(is_right ? counts.named : counts.misnamed);
      if (!is_right && counts.misnamed == 1) {
        std::printf("%s %s: named %s, likely %s\n", what.c_str(), level_name(level.level).c_str(), report.name.c_str(),
                    in_words(report.name_probabilities).c_str());
      }
    }
    if (!is_wrong) {
      ++counts.right;
      counts.suspect += level.is_told ? 1 : 0;
      continue;
    }
    ++counts.wrong;
    counts.untold += level.is_told ? 0 : 1;
    std::printf("%s %s: Dice %.3f, centre %.1f mm, severity %.2f%s %s\n", what.c_str(), level_name(level.level).c_str(),
                level.dice, level.centre_mm, report.severity, level.is_told ? "" : ", NO WORD",
                test::warnings_in_line(report).c_str());
  }
  for (const std::size_t n : exam.score.extra) {
    ++counts.extra;
    std::printf("%s: %s is no level, severity %.2f\n", what.c_str(), exam.found.levels[n].name.c_str(),
                exam.found.levels[n].severity);
  }
  if (counts.misnamed > 0) std::printf("%s: %d named wrongly\n", what.c_str(), counts.misnamed);
  std::printf("%s: %d whole, %d found, %d right\n", what.c_str(), counts.whole, counts.found, counts.right);
  std::fflush(stdout);
  return counts;
}

void print_row(const char* what, const TrunkCounts& c) {
  std::printf("%-10s %5d %6d %6d %6d %8d %8d %8d %6d %7d %8d %9d\n", what, c.whole, c.found, c.right, c.wrong, c.untold,
              c.missed_untold, c.suspect, c.extra, c.named, c.unnamed, c.misnamed);
}

TEST(Trunks, OfRandomPatientsAreFoundOrTold) {
  const std::uint64_t count = trunk_number("SPINALTAP_TRUNKS", 3), first = trunk_number("SPINALTAP_TRUNKS_FIRST", 0);
  constexpr std::array<double, 3> kThickMm{1.65, 3.05, 1e3};
  constexpr std::array<const char*, 3> kNames{"<= 1.6 mm", "<= 3 mm", "<= 5 mm"};
  std::array<TrunkCounts, 3> by_thickness;
  Reliability reliability;
  for (std::uint64_t n = 0; n < count; ++n) {
    const std::uint64_t seed = first + 2 * n;
    const double step_mm = random_trunk_options(seed).scan.slice_step_mm;
    const auto row =
        static_cast<std::size_t>(std::upper_bound(kThickMm.begin(), kThickMm.end(), step_mm) - kThickMm.begin());
    by_thickness[row].add(examine(seed, reliability));
  }
  std::printf("%-10s %5s %6s %6s %6s %8s %8s %8s %6s %7s %8s %9s\n", "slices", "whole", "found", "right", "wrong",
              "no word", "missed", "suspect", "extra", "named", "unnamed", "misnamed");
  TrunkCounts all;
  for (std::size_t row = 0; row < by_thickness.size(); ++row) {
    print_row(kNames[row], by_thickness[row]);
    all.add(by_thickness[row]);
  }
  print_row("all", all);
  std::printf("no word: wrong ones without a warning; missed: without a word; suspect: of right ones\n");
  reliability.print();
  // Of even seeds 0 to 10, 42 of 45 were found.
  EXPECT_GE(all.found, all.whole * 8 / 10);
  EXPECT_GT(all.whole, 0);
}

}  // namespace
}  // namespace spinaltap
