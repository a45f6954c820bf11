#pragma once

#include <cstddef>
#include <map>

#include "core/base/statistics.h"
#include "core/study/clustered_share.h"
#include "core/study/study_row.h"

namespace spinaltap {

/// In how many runs something came about.
struct StudyShare {
  std::size_t runs = 0;  ///< in which it could
  std::size_t count = 0;
  Interval interval;  ///< of its probability: Wilson's, 95 %; of a ScrewCount for patients like these

  double probability() const { return runs == 0 ? 0.0 : static_cast<double>(count) / static_cast<double>(runs); }
};
StudyShare study_share(std::size_t count, std::size_t runs);

/// Counts the runs in which a screw has a property, patient by patient.
class ScrewCount {
 public:
  void add(const StudyRow& row, bool has_it);
  /// With clustered_share()'s interval. Throws Error where nothing was added.
  StudyShare share() const;
  std::size_t patients() const { return of_patient_.size(); }

 private:
  std::map<std::size_t, PatientCount> of_patient_;  ///< 0: rows without a patient
};

}  // namespace spinaltap
