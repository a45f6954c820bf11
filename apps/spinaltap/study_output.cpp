#include "apps/spinaltap/study_output.h"

#include <cmath>
#include <string>

#include "apps/report/study_plots.h"
#include "apps/report/text.h"
#include "apps/spinaltap/command.h"

namespace spinaltap {
namespace {

void print_share(const std::string& name, const StudyShare& share) {
  const auto percent = [](double probability) { return readable_number(100.0 * probability, 2); };
  print_figure(name, percent(share.probability()) + " %  (" + percent(share.interval.low) + " to " +
                         percent(share.interval.high) + "; " + std::to_string(share.count) + " of " +
                         std::to_string(share.runs) + ")");
}

void print_grades(const std::string& of, const std::array<StudyShare, 5>& grades) {
  for (std::size_t n = 0; n < grades.size(); ++n) print_share(of + " grade " + static_cast<char>('A' + n), grades[n]);
}

void print_screws(const StudyScrews& screws) {
  print_figure("screws of patients", static_cast<double>(screws.patients), "", 0);
  print_grades("screw,", screws.grades);
  print_share("screw, grade A or B", screws.acceptable);
  print_share("screw in the canal", screws.canal);
  if (screws.neighbour.runs > 0) print_share("screw in another vertebra", screws.neighbour);
}

void print_bit(const StudySummary& summary) {
  print_share("bit's breach, any wall", summary.breach);
  print_share("bit's breach, outer surface", summary.outer);
  print_share("bit's breach, canal", summary.canal);
  print_grades("bit,", summary.grades);
  print_share("bit met bone", summary.contact);
  print_share("tip left at the far side", summary.breakthrough);
  print_share("asked to stop", summary.stopped);
  print_share("gave up short of the target", summary.gave_up);
}

void print_tolerance(const StudyTolerance& tolerance) {
  print_figure("95 % grade A up to a " + name_of(tolerance), words_of(tolerance));
}

void print_sensitivity(const StudySensitivity& sensitivity, const std::vector<std::string>& inputs) {
  for (std::size_t n = 0; n < inputs.size(); ++n) {
    const SobolIndex& index = sensitivity.indices.groups.at(n);
    print_figure(sensitivity.result + ", by " + inputs[n], readable_number(index.first_order, 2) + " alone, " +
                                                               readable_number(index.total, 2) + " with others  (" +
                                                               readable_number(index.total_interval.low, 2) + " to " +
                                                               readable_number(index.total_interval.high, 2) + ")");
  }
}

}  // namespace

void print_study(const StudySummary& summary, const std::filesystem::path& folder) {
  print_figure("runs", static_cast<double>(summary.runs), "", 0);
  print_figure("in brackets", "95 % interval; count");
  if (!summary.screws.empty()) print_screws(summary.screws.front());
  if (summary.has_drilled) print_bit(summary);
  for (const StudyTolerance& tolerance : summary.tolerances) print_tolerance(tolerance);
  for (const StudySensitivity& one : summary.sensitivities) print_sensitivity(one, summary.inputs);
  for (const StudySpread& spread : summary.spreads) {
    if (spread.runs == 0) continue;
    const StudyTitle title = title_of(spread.column);
    print_figure(title.name + ", median", spread.quantiles[3], title.unit);
    print_figure("  5 % to 95 %",
                 readable_number(spread.quantiles[1], 2) + " to " + readable_number(spread.quantiles[5], 2));
  }
  if (summary.outside_volume.count > 0) print_share("left the cylinder of points", summary.outside_volume);
  print_figure("report", (folder / "report.html").string());
}

}  // namespace spinaltap
