#include "core/study/study_row.h"

#include <charconv>
#include <cmath>
#include <limits>

#include "core/base/error.h"
#include "core/base/text_fields.h"

namespace spinaltap {
namespace {

enum class Kind : std::uint8_t {
  real,
  whole,  ///< written without an exponent
  letter  ///< A, B, ...
};
struct Column {
  std::string_view name;
  Kind kind;
};

/// Those after the factors, as StudyColumn has them.
constexpr std::array<Column, kStudyColumns - kStudyFactors> kResults{{{"run", Kind::whole},
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
                                                                      {"events_lost", Kind::whole}}};

constexpr auto kFirstResult = static_cast<std::size_t>(StudyColumn::run);

/// In a file the run's number leads: place n of a line holds this column.
std::size_t column_at(std::size_t place) {
  if (place == 0) return kFirstResult;
  return place <= kStudyFactors ? place - 1 : place;
}

Column column(std::size_t n) {
  return n < kStudyFactors ? Column{name_of(static_cast<StudyFactor>(n)), Kind::real} : kResults.at(n - kStudyFactors);
}

void append_cell(double value, Kind kind, std::string& text) {
  if (std::isnan(value)) return;
  switch (kind) {
    case Kind::letter:
      text += static_cast<char>('A' + static_cast<int>(value));
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
  if (known.kind == Kind::letter && text.size() == 1 && text[0] >= 'A' && text[0] <= 'E') return text[0] - 'A';
  const auto number = known.kind == Kind::letter ? std::nullopt : parse_number(text);
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
  std::string text;
  for (std::size_t place = 0; place < kStudyColumns; ++place) {
    if (place > 0) text += ',';
    const std::size_t n = column_at(place);
    append_cell(row[static_cast<StudyColumn>(n)], column(n).kind, text);
  }
  return text;
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
  if (!(row[StudyColumn::run] >= 0.0)) fail("expected the number of a run in a study's table, found none");
  return row;
}

}  // namespace spinaltap
