#include "core/study/study_map.h"

#include <cmath>
#include <map>
#include <utility>

#include "core/base/text_fields.h"

namespace spinaltap {
namespace {

constexpr double kMostCells = 1000.0;  ///< from the plan: no screw is further off by mistake

struct OffColumns {
  StudyColumn medial, cranial;
};

OffColumns columns_of(OffPlan off) {
  return off == OffPlan::entry ? OffColumns{StudyColumn::off_medial_mm, StudyColumn::off_cranial_mm}
                               : OffColumns{StudyColumn::off_medial_deg, StudyColumn::off_cranial_deg};
}

void append_share(const StudyShare& share, std::string& text) {
  for (const double number : {share.probability(), share.interval.low, share.interval.high}) {
    text += ',';
    append_csv_number(number, text);
  }
}

}  // namespace

std::string_view name_of(OffPlan off) { return off == OffPlan::entry ? "entry_mm" : "direction_deg"; }

StudyMap study_map(const std::vector<const StudyRow*>& rows, std::string what, OffPlan off) {
  struct Counts {
    ScrewCount beyond_a, beyond_b;
  };
  const auto [medial, cranial] = columns_of(off);
  std::map<std::pair<int, int>, Counts> cells;  // by cranial, then medial
  for (const StudyRow* row : rows) {
    const double grade = (*row)[StudyColumn::screw_grade];
    const double to_medial = (*row)[medial] / StudyMap::kCell, to_cranial = (*row)[cranial] / StudyMap::kCell;
    // Not a number is within nothing.
    const bool is_in_reach = std::abs(to_medial) < kMostCells && std::abs(to_cranial) < kMostCells;
    if (std::isnan(grade) || !is_in_reach) continue;
    Counts& cell = cells[{static_cast<int>(std::lround(to_cranial)), static_cast<int>(std::lround(to_medial))}];
    cell.beyond_a.add(*row, grade > 0.0);
    cell.beyond_b.add(*row, grade > 1.0);
  }
  StudyMap made{std::move(what), off, {}};
  made.cells.reserve(cells.size());
  for (const auto& [place, counts] : cells) {
    made.cells.push_back({place.second, place.first, counts.beyond_a.share(), counts.beyond_b.share()});
  }
  return made;
}

std::string study_map_csv(const std::vector<StudyMap>& maps) {
  std::string text =
      "of,off,medial,cranial,runs,beyond_a,beyond_a_low,beyond_a_high,beyond_b,beyond_b_low,beyond_b_high\n";
  for (const StudyMap& map : maps) {
    for (const StudyMap::Cell& cell : map.cells) {
      text += map.what + "," + std::string(name_of(map.off));
      for (const double number :
           {StudyMap::kCell * cell.medial, StudyMap::kCell * cell.cranial, static_cast<double>(cell.beyond_a.runs)}) {
        text += ',';
        append_csv_number(number, text);
      }
      append_share(cell.beyond_a, text);
      append_share(cell.beyond_b, text);
      text += '\n';
    }
  }
  return text;
}

}  // namespace spinaltap
