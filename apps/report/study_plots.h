#pragma once

#include <string>
#include <vector>

#include "apps/report/svg_plot.h"
#include "core/study/study_summary.h"

namespace spinaltap {

/// A column's or factor's name and unit for people.
struct StudyTitle {
  std::string name;
  std::string unit;  ///< may be empty
};
StudyTitle title_of(StudyColumn column);
StudyTitle title_of(StudyFactor factor);

/// Breach probability over a factor, with its 95 % intervals.
Plot breach_plot(const StudySummary::ByFactor& by_factor);

/// How many runs had which value of a column, in about 30 bins of round width.
Plot histogram(const std::vector<StudyRow>& rows, StudyColumn column);

/// Runs by two factors, those with a breach told from those without; of the first `max` runs.
Plot scatter(const std::vector<StudyRow>& rows, StudyFactor across, StudyFactor up, std::size_t max);

}  // namespace spinaltap
