#pragma once

#include <array>
#include <vector>

#include "core/base/statistics.h"
#include "core/study/study_design.h"
#include "core/study/study_row.h"

namespace spinaltap {

/// In how many runs something came about.
struct StudyShare {
  std::size_t runs = 0;  ///< in which it could
  std::size_t count = 0;
  Interval interval;  ///< of its probability: Wilson's, 95 %

  double probability() const { return runs == 0 ? 0.0 : static_cast<double>(count) / static_cast<double>(runs); }
};
StudyShare study_share(std::size_t count, std::size_t runs);

/// Breach among the runs with one value of a factor, or within a range of it.
struct StudyBin {
  double low = 0.0;  ///< lowest and highest value met
  double high = 0.0;
  double middle = 0.0;  ///< mean of the values
  StudyShare breach = {};
  StudyShare canal = {};
};

/// How one column is distributed; not a number where no run has a value.
struct StudySpread {
  static constexpr std::array<double, 7> kShares{0.0, 0.05, 0.25, 0.5, 0.75, 0.95, 1.0};

  StudyColumn column = StudyColumn::run;
  std::size_t runs = 0;  ///< that have a finite value
  double mean = 0.0;
  std::array<double, kShares.size()> quantiles{};
};

struct StudySummary {
  std::size_t runs = 0;
  StudyShare breach, outer, canal;
  std::array<StudyShare, 5> grades{};  ///< A to E
  StudyShare contact, breakthrough, stopped, gave_up, outside_volume;
  std::size_t events_lost = 0;
  std::vector<StudySpread> spreads;
  struct ByFactor {
    StudyFactor factor = StudyFactor::entry_left_mm;
    std::vector<StudyBin> bins;
  };
  std::vector<ByFactor> factors;  ///< those that differ
};

/// What a study's runs come to. Rows in the order of their numbers: the same rows give the same numbers, bit for bit.
StudySummary summarise_study(const std::vector<StudyRow>& rows, const StudyDesign& design);

}  // namespace spinaltap
