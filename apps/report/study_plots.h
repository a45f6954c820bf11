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

/// "scale of the entry's errors", or "scale of all these errors together".
std::string name_of(const StudyTolerance& tolerance);
/// "0.62", "more than 2", or that the share is less even at the smallest scale.
std::string words_of(const StudyTolerance& tolerance);

/// The share of grade A over a scale of errors, with its 95 % intervals.
Plot tolerance_plot(const StudyTolerance& tolerance);

/// Breach probability over a factor, with its 95 % intervals.
Plot breach_plot(const StudySummary::ByFactor& by_factor);

/// How many runs had which value of a column, in about 30 bins of round width.
Plot histogram(const std::vector<StudyRow>& rows, StudyColumn column);

/// Runs by two factors, those with a breach told from those without; of the first `max` runs.
Plot scatter(const std::vector<StudyRow>& rows, StudyFactor across, StudyFactor up, std::size_t max);

}  // namespace spinaltap
