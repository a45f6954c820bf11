#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "core/study/study_row.h"
#include "core/study/study_share.h"

namespace spinaltap {

/// What of a screw lies off its plan.
enum class OffPlan : std::uint8_t {
  entry,     ///< to the sides, mm
  direction  ///< degrees
};
/// "entry_mm", "direction_deg".
std::string_view name_of(OffPlan off);

/// How likely a breach is where a screw lies so far off its plan, all else of its errors being as it comes: shares over
/// square cells of StudyMap::kCell to a side.
struct StudyMap {
  static constexpr double kCell = 1.0;  ///< mm or degrees

  struct Cell {
    int medial = 0, cranial = 0;  ///< where its middle is, in cells from the plan
    StudyShare beyond_a;          ///< any breach; intervals are for patients like these
    StudyShare beyond_b;          ///< of 2 mm and more
  };

  std::string what;  ///< "all", "L3", "left": which screws
  OffPlan off = OffPlan::entry;
  std::vector<Cell> cells;  ///< those with runs: from caudal up and, in a row, from lateral on
};

/// Of those rows that have a graded screw, and say where it lies: within 1,000 cells of its plan.
StudyMap study_map(const std::vector<const StudyRow*>& rows, std::string what, OffPlan off);

/// breach_map.csv: a line for each cell of all of them.
std::string study_map_csv(const std::vector<StudyMap>& maps);

}  // namespace spinaltap
