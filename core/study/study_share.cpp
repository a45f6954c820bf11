#include "core/study/study_share.h"

#include <cmath>
#include <vector>

namespace spinaltap {

StudyShare study_share(std::size_t count, std::size_t runs) { return {runs, count, wilson_interval(count, runs)}; }

void ScrewCount::add(const StudyRow& row, bool has_it) {
  const double number = row[StudyColumn::patient];
  PatientCount& patient = of_patient_[std::isnan(number) ? 0 : static_cast<std::size_t>(number)];
  ++patient.runs;
  if (has_it) ++patient.met;
}

StudyShare ScrewCount::share() const {
  StudyShare share;
  std::vector<PatientCount> counts;
  counts.reserve(of_patient_.size());
  for (const auto& [number, patient] : of_patient_) {
    share.runs += patient.runs;
    share.count += patient.met;
    counts.push_back(patient);
  }
  share.interval = clustered_share(counts).interval;
  return share;
}

}  // namespace spinaltap
