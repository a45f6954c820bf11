#include "core/study/study_row.h"

#include <charconv>
#include <cmath>
#include <limits>
#include <optional>

#include "core/base/error.h"
#include "core/base/text_fields.h"
#include "core/ct/level.h"
#include "core/grading/path_side.h"

namespace spinaltap {
namespace {

enum class Kind : std::uint8_t {
  real,
  whole,   ///< written without an exponent
  letter,  ///< A, B, ...
  level,   ///< L3
  hand,    ///< left or right
  side     ///< medial, ...
};
struct Column {
  std::string_view name;
  Kind kind;
};

/// Those after the factors, as StudyColumn has them.
constexpr std::array<Column, kStudyColumns - kStudyFactors> kResults{{{"run", Kind::whole},
                                                                      {"patient", Kind::whole},
                                                                      {"screw", Kind::whole},
                                                                      {"level", Kind::level},
                                                                      {"side", Kind::hand},
                                                                      {"seed", Kind::whole},
                                                                      {"contact", Kind::whole},
                                                                      {"breach", Kind::whole},
                                                                      {"breach_outer_mm", Kind::real},
                                                                      {"breach_canal_mm", Kind::real},
                                                                      {"min_clearance_outer_mm", Kind::real},
                                                                      {"min_clearance_canal_mm", Kind::real},
                                                                      {"grade", Kind::letter},
                                                                      {"max_thrust_n", Kind::real},
                                                                      {"max_torque_n_mm", Kind::real},
                                                                      {"plunge_depth_mm", Kind::real},
                                                                      {"depth_mm", Kind::real},
                                                                      {"time_s", Kind::real},
                                                                      {"outer_cortical_mm", Kind::real},
                                                                      {"cancellous_mm", Kind::real},
                                                                      {"transitional_mm", Kind::real},
                                                                      {"inner_cortical_mm", Kind::real},
                                                                      {"breakthrough_mm", Kind::real},
                                                                      {"stop_mm", Kind::real},
                                                                      {"gave_up_mm", Kind::real},
                                                                      {"removed_points", Kind::whole},
                                                                      {"removed_mm3", Kind::real},
                                                                      {"screw_pullout_n", Kind::real},
                                                                      {"screw_torque_n_mm", Kind::real},
                                                                      {"max_temperature_c", Kind::real},
                                                                      {"outside_volume_mm", Kind::real},
                                                                      {"events_lost", Kind::whole},
                                                                      {"error_medial_mm", Kind::real},
                                                                      {"error_cranial_mm", Kind::real},
                                                                      {"error_along_mm", Kind::real},
                                                                      {"error_medial_deg", Kind::real},
                                                                      {"error_cranial_deg", Kind::real},
                                                                      {"turn_left_deg", Kind::real},
                                                                      {"turn_back_deg", Kind::real},
                                                                      {"turn_head_deg", Kind::real},
                                                                      {"shift_left_mm", Kind::real},
                                                                      {"shift_back_mm", Kind::real},
                                                                      {"shift_head_mm", Kind::real},
                                                                      {"off_medial_mm", Kind::real},
                                                                      {"off_cranial_mm", Kind::real},
                                                                      {"off_medial_deg", Kind::real},
                                                                      {"off_cranial_deg", Kind::real},
                                                                      {"off_entry_mm", Kind::real},
                                                                      {"off_target_mm", Kind::real},
                                                                      {"off_angle_deg", Kind::real},
                                                                      {"screw_grade", Kind::letter},
                                                                      {"screw_breach_mm", Kind::real},
                                                                      {"screw_breach_side", Kind::side},
                                                                      {"screw_breach_depth_mm", Kind::real},
                                                                      {"screw_canal_mm", Kind::real},
                                                                      {"screw_anterior_mm", Kind::real},
                                                                      {"screw_neighbour_mm", Kind::real}}};

constexpr auto kFirstResult = static_cast<std::size_t>(StudyColumn::run);

/// In a file the run's number leads: place n of a line holds this column.
std::size_t column_at(std::size_t place) {
  if (place == 0) return kFirstResult;
  return place <= kStudyFactors ? place - 1 : place;
}

Column column(std::size_t n) {
  return n < kStudyFactors ? Column{name_of(static_cast<StudyFactor>(n)), Kind::real} : kResults.at(n - kStudyFactors);
}

constexpr std::array<std::string_view, 2> kHands{"left", "right"};

/// The word for a cell's number, and the number for a word.
std::string word_of(double value, Kind kind) {
  const auto n = static_cast<std::size_t>(value);
  switch (kind) {
    case Kind::letter:
      return {static_cast<char>('A' + n)};
    case Kind::level:
      return level_name(static_cast<Level>(n));
    case Kind::hand:
      return std::string(kHands.at(n));
    default:
      return name_of(static_cast<PathSide>(n));
  }
}
std::optional<double> number_of(std::string_view word, Kind kind) {
  if (kind == Kind::level) {
    const std::optional<Level> level = level_from_name(word);
    return level ? std::optional<double>(static_cast<double>(*level)) : std::nullopt;
  }
  const std::size_t most = kind == Kind::hand ? kHands.size() : 5;  // grades and sides
  for (std::size_t n = 0; n < most; ++n) {
    if (word_of(static_cast<double>(n), kind) == word) return static_cast<double>(n);
  }
  return std::nullopt;
}

void append_cell(double value, Kind kind, std::string& text) {
  if (std::isnan(value)) return;
  switch (kind) {
    case Kind::letter:
    case Kind::level:
    case Kind::hand:
    case Kind::side:
      text += word_of(value, kind);
      return;
    case Kind::whole: {
      std::array<char, 32> digits{};
      const auto end = std::to_chars(digits.data(), digits.data() + digits.size(), static_cast<std::int64_t>(value));
      text.append(digits.data(), end.ptr);
      return;
    }
    case Kind::real:
      append_number(value == 0.0 ? 0.0 : value, text);  // no "-0"
      return;
  }
}

double read_cell(std::string_view text, const Column& known) {
  if (text.empty()) return std::numeric_limits<double>::quiet_NaN();
  const bool is_number = known.kind == Kind::real || known.kind == Kind::whole;
  const std::optional<double> number = is_number ? parse_number(text) : number_of(text, known.kind);
  if (!number || (known.kind == Kind::whole && *number != std::floor(*number))) {
    fail("expected another value for \"", known.name, "\" of a study's table, found ", in_quotes(text));
  }
  return *number;
}

}  // namespace

std::string_view name_of(StudyColumn which) { return column(static_cast<std::size_t>(which)).name; }

std::string study_csv_head() {
  std::string text;
  for (std::size_t place = 0; place < kStudyColumns; ++place) {
    if (place > 0) text += ',';
    text += column(column_at(place)).name;
  }
  return text;
}

std::string study_csv(const StudyRow& row) {
  constexpr std::size_t kLong = 1024;  // longer than most
  std::string text;
  text.reserve(kLong);
  for (std::size_t place = 0; place < kStudyColumns; ++place) {
    if (place > 0) text += ',';
    const std::size_t n = column_at(place);
    append_cell(row[static_cast<StudyColumn>(n)], column(n).kind, text);
  }
  return text;
}

std::string study_csv_for_others(std::string_view row) {
  std::string text;
  text.reserve(row.size());
  while (true) {
    const std::size_t comma = row.find(',');
    const std::string_view field = row.substr(0, comma);
    if (field != "inf" && field != "-inf") text += field;
    if (comma == std::string_view::npos) return text;
    text += ',';
    row.remove_prefix(comma + 1);
  }
}

StudyRow read_study_csv(std::string_view text) {
  StudyRow row;
  for (std::size_t place = 0; place < kStudyColumns; ++place) {
    const std::size_t comma = text.find(',');
    const bool is_last = place + 1 == kStudyColumns;
    if ((comma == std::string_view::npos) != is_last) {
      fail("expected ", kStudyColumns, " columns in a row of a study's table, found ", is_last ? "more" : "fewer");
    }
    const std::size_t n = column_at(place);
    row[static_cast<StudyColumn>(n)] = read_cell(text.substr(0, comma), column(n));
    if (!is_last) text.remove_prefix(comma + 1);
  }
  for (const StudyColumn counted : {StudyColumn::patient, StudyColumn::screw}) {
    const double number = row[counted];
    if (std::isnan(number) || (number >= 0.0 && number <= static_cast<double>(StudyRuns::kMaxRuns))) continue;
    fail("expected a number up to ", StudyRuns::kMaxRuns, " for \"", name_of(counted), "\" of a study's table, found ",
         number);
  }
  if (!(row[StudyColumn::run] >= 0.0)) fail("expected the number of a run in a study's table, found none");
  return row;
}

}  // namespace spinaltap
