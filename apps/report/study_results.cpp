#include "apps/report/study_results.h"

#include <nlohmann/json.hpp>
#include <string>
#include <utility>

#include "apps/report/study_inputs.h"
#include "apps/report/study_report.h"
#include "core/base/error.h"
#include "core/base/staged_output.h"
#include "core/files/study_summary_json.h"

namespace spinaltap {

StudySummary write_study_results(const std::filesystem::path& folder, const StudyIdentity& identity,
                                 const StudyRows& rows) {
  if (rows.size() != identity.runs) {
    std::size_t missing = 0;
    while (rows.contains(missing)) ++missing;
    fail("expected all ", identity.runs, " runs of the study, found ", rows.size(), "; run ", missing,
         " is the first that is missing: let every shard finish, and name all their folders");
  }
  std::string csv = study_csv_head() + "\n";
  StudyReportData report;
  for (const auto& [run, text] : rows) {
    csv += text + "\n";
    report.rows.push_back(read_study_csv(text));
  }
  const StudyInputs inputs = study_inputs(identity, folder / "study.json");
  report.title = inputs.title;
  report.inputs = inputs.rows;
  report.summary = summarise_study(report.rows, inputs.design);
  StagedOutput output;
  output.write(folder / "runs.csv", csv);
  output.write(folder / "summary.json", to_json(report.summary).dump(2) + "\n");
  output.write(folder / "report.html", study_report(report));
  output.commit();
  return std::move(report.summary);
}

}  // namespace spinaltap
