#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "core/study/sobol_indices.h"
#include "core/study/study_design.h"
#include "core/study/study_map.h"
#include "core/study/study_row.h"
#include "core/study/study_share.h"

namespace spinaltap {

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

/// How screws came out, of those that have something in common. Intervals know that runs of one patient belong
/// together: clustered_share().
struct StudyScrews {
  std::string what;  ///< "all", "patient 3", "L3", "left"
  std::size_t runs = 0;
  std::size_t patients = 0;
  std::array<StudyShare, 5> grades{};  ///< A to E
  StudyShare acceptable;               ///< A or B
  StudyShare canal;                    ///< breach into the canal
  StudyShare anterior;                 ///< tip beyond the anterior wall
  StudyShare neighbour;                ///< into another vertebra; of no runs where none was known
};

/// How small errors must be: the share of grade A over what scales them.
struct StudyTolerance {
  static constexpr double kWanted = 0.95;

  /// Scales that go together, those of other errors at 1: one of them, or all that the study has at levels.
  std::vector<StudyFactor> factors;
  std::vector<double> scales;
  std::vector<StudyShare> a;  ///< of each
  /// Up to which scale the share is kWanted, linear between levels; nothing where it is less at the smallest one, and
  /// infinite where it is no less at the largest.
  std::optional<double> up_to;
};

/// What of a result's variance each input is to blame for.
struct StudySensitivity {
  std::string result;  ///< a column's name, or "screw_beyond_a", "screw_beyond_b": 1 where a grade is worse
  SobolIndices indices;
};

struct StudySummary {
  std::size_t runs = 0;
  bool has_drilled = false;  ///< what follows is of the bit; nothing in a study of geometry alone
  StudyShare breach, outer, canal;
  std::array<StudyShare, 5> grades{};  ///< A to E
  StudyShare contact, breakthrough, stopped, gave_up, outside_volume;
  std::size_t events_lost = 0;
  std::vector<StudySpread> spreads;
  struct ByFactor {
    StudyFactor factor = StudyFactor::entry_left_mm;
    std::vector<StudyBin> bins;
  };
  std::vector<ByFactor> factors;  ///< those that differ; breaches of the bit or, where none drilled, of the screw
  /// All of them first, then by patient, level and side where there are several; none where none were graded.
  std::vector<StudyScrews> screws;
  /// Breaches over where screws lie: of all by entry and by direction, then of each level and side where there are
  /// several.
  std::vector<StudyMap> maps;
  /// Of each factor that scales errors at levels, and of all of them together where there are several.
  std::vector<StudyTolerance> tolerances;
  std::vector<std::string> inputs;  ///< of Saltelli's design
  std::vector<StudySensitivity> sensitivities;
};

/// What a study's runs come to. Rows in the order of their numbers: the same rows give the same numbers, bit for bit.
StudySummary summarise_study(const std::vector<StudyRow>& rows, const StudyRuns& runs);

}  // namespace spinaltap
