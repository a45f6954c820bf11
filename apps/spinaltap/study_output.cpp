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

}  // namespace

void print_study(const StudySummary& summary, const std::filesystem::path& folder) {
  print_figure("runs", static_cast<double>(summary.runs), "", 0);
  print_figure("in brackets", "95 % interval (Wilson); count");
  print_share("breach, any wall", summary.breach);
  print_share("breach, outer surface", summary.outer);
  print_share("breach, canal", summary.canal);
  for (std::size_t n = 0; n < summary.grades.size(); ++n) {
    print_share(std::string("grade ") + static_cast<char>('A' + n), summary.grades[n]);
  }
  print_share("bit met bone", summary.contact);
  print_share("tip left at the far side", summary.breakthrough);
  print_share("asked to stop", summary.stopped);
  print_share("gave up short of the target", summary.gave_up);
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
