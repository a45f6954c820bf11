#include "core/files/measurements_file.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>
#include <utility>

#include "core/base/error.h"
#include "core/base/file_stream.h"
#include "core/base/text_fields.h"
#include "core/files/data_files.h"

namespace spinaltap {
namespace {

template <class Value, std::size_t count>
using Words = std::array<std::pair<std::string_view, Value>, count>;

constexpr Words<MeasuredTissue, 6> kTissues{{{"bone", MeasuredTissue::bone},
                                             {"cortical", MeasuredTissue::cortical},
                                             {"cancellous", MeasuredTissue::cancellous},
                                             {"vertebra", MeasuredTissue::vertebra},
                                             {"foam", MeasuredTissue::foam},
                                             {"artificial", MeasuredTissue::artificial}}};
constexpr Words<MeasuredProcess, 3> kProcesses{
    {{"drill", MeasuredProcess::drill}, {"ultrasonic", MeasuredProcess::ultrasonic}, {"awl", MeasuredProcess::awl}}};
constexpr Words<MeasuredAs, 3> kForceKinds{
    {{"not_stated", MeasuredAs::not_stated}, {"mean", MeasuredAs::mean}, {"max", MeasuredAs::max}}};
constexpr Words<MeasuredAs, 6> kHeatKinds{{{"not_stated", MeasuredAs::not_stated},
                                           {"mean", MeasuredAs::mean},
                                           {"max", MeasuredAs::max},
                                           {"mean_max", MeasuredAs::mean_max},
                                           {"rise", MeasuredAs::rise},
                                           {"bit", MeasuredAs::bit}}};
constexpr Words<MeasuredTorque, 3> kTorqueKinds{{{"insertion", MeasuredTorque::insertion},
                                                 {"max_insertion", MeasuredTorque::max_insertion},
                                                 {"extraction", MeasuredTorque::extraction}}};
constexpr Words<MeasuredIrrigation, 4> kIrrigations{{{"not_stated", MeasuredIrrigation::not_stated},
                                                     {"none", MeasuredIrrigation::none},
                                                     {"external", MeasuredIrrigation::external},
                                                     {"internal", MeasuredIrrigation::internal}}};
constexpr Words<bool, 2> kReports{{{"own", false}, {"cited", true}}};
constexpr Words<bool, 2> kConditions{{{"read", false}, {"noted", true}}};
constexpr Words<bool, 2> kYesNo{{{"no", false}, {"yes", true}}};

/// What a number may be.
enum class Bound : std::uint8_t { any, not_negative, above_0 };

bool is_within(double number, Bound bound) {
  if (!std::isfinite(number)) return false;
  return bound == Bound::any || (bound == Bound::not_negative ? number >= 0.0 : number > 0.0);
}

std::string_view name_of(Bound bound) {
  switch (bound) {
    case Bound::above_0:
      return "a number above 0";
    case Bound::not_negative:
      return "a number of at least 0";
    case Bound::any:
      break;
  }
  return "a number";
}

/// A CSV file row by row, its cells by their columns' names. Each row is asked for every column that there is.
class MeasurementTable {
 public:
  explicit MeasurementTable(const std::filesystem::path& path) : file_(path) {
    std::string_view line;
    if (!lines_.next_filled(line)) fail("expected a line of column names, found nothing in ", file_.name());
    CsvFields fields(without_byte_order_mark(line));
    for (std::string_view field; fields.next(field);) {
      std::string name = csv_column_name(field);
      if (std::find(names_.begin(), names_.end(), name) != names_.end()) {
        fail("expected one column ", in_quotes(name), ", found two in ", lines_.place());
      }
      names_.push_back(std::move(name));
    }
    is_asked_.assign(names_.size(), false);
  }

  /// Goes to the next row; false when there is none. Throws Error where the row before was not asked for a column.
  bool next() {
    if (!cells_.empty()) {
      const auto unknown = std::find(is_asked_.begin(), is_asked_.end(), false);
      if (unknown != is_asked_.end()) {
        const std::string& name = names_[static_cast<std::size_t>(unknown - is_asked_.begin())];
        fail("expected no column ", in_quotes(name), " in ", file_.name());
      }
    }
    std::string_view line;
    if (!lines_.next_filled(line)) {
      if (cells_.empty()) fail("expected a row at least, found none in ", file_.name());
      return false;
    }
    cells_.clear();
    CsvFields fields(line);
    for (std::string_view field; fields.next(field);) cells_.push_back(field);
    if (cells_.size() != names_.size()) {
      fail("expected ", names_.size(), " columns, found ", cells_.size(), " in ", lines_.place());
    }
    return true;
  }

  /// The cell as it is, without the quotes around it.
  std::string text(std::string_view column) {
    std::string_view cell = trimmed(cells_[place_of(column)]);
    if (cell.size() >= 2 && cell.front() == '"' && cell.back() == '"') cell = cell.substr(1, cell.size() - 2);
    for (std::size_t i = 0, length = 0; i < cell.size(); i += length) {
      length = utf8_length(cell, i);
      if (length == 0 || is_control(cell.substr(i, length)) || cell[i] == '"') rejects(column, "a plain text", cell);
    }
    return std::string(cell);
  }

  std::string text_there(std::string_view column) {
    std::string cell = text(column);
    if (cell.empty()) fail("expected a text as ", column, ", found none in ", lines_.place());
    return cell;
  }

  std::optional<double> number(std::string_view column, Bound bound) {
    const std::string cell = text(column);
    if (cell.empty()) return std::nullopt;
    const std::optional<double> found = parse_number(cell);
    if (!found || !is_within(*found, bound)) rejects(column, name_of(bound), cell);
    return found;
  }

  std::optional<int> whole(std::string_view column) {
    const std::optional<double> found = number(column, Bound::above_0);
    if (!found) return std::nullopt;
    if (*found != std::floor(*found) || *found > 1e6)
      rejects(column, "a whole number of at most 1,000,000", text(column));
    return static_cast<int>(*found);
  }

  /// A number, or two with "to" between them.
  std::optional<MeasuredRange> range(std::string_view column, Bound bound) {
    const std::string cell = text(column);
    if (cell.empty()) return std::nullopt;
    constexpr std::string_view kTo = " to ";
    const std::size_t to = cell.find(kTo);
    const std::string_view all = cell;
    const std::optional<double> low = parse_number(all.substr(0, to));
    const std::optional<double> high = to == std::string::npos ? low : parse_number(all.substr(to + kTo.size()));
    if (!low || !high || !is_within(*low, bound) || !is_within(*high, bound) || !(*low <= *high)) {
      rejects(column, "a number or two that rise, like \"1 to 2\"", cell);
    }
    return MeasuredRange{*low, *high};
  }

  template <class Value, std::size_t count>
  Value word(std::string_view column, const Words<Value, count>& words) {
    const std::string cell = text(column);
    for (const auto& [name, value] : words) {
      if (cell == name) return value;
    }
    std::string known;
    for (const auto& [name, value] : words) known += (known.empty() ? "" : ", ") + std::string(name);
    rejects(column, "one of " + known, cell);
  }

  /// A figure of what `kind` tells stands in the row, or neither does.
  template <class Value, std::size_t count>
  std::optional<Value> word_where(bool is_there, std::string_view column, const Words<Value, count>& words) {
    if (is_there) return word(column, words);
    if (const std::string cell = text(column); !cell.empty()) rejects(column, "no word without its figure", cell);
    return std::nullopt;
  }

  /// A deviation, only beside what deviates.
  std::optional<double> deviation(std::string_view column, bool is_there) {
    const std::optional<double> found = number(column, Bound::not_negative);
    if (found && !is_there) rejects(column, "no deviation without its figure", text(column));
    return found;
  }

  /// Where the figure and its range stand both, one lies in the other.
  std::optional<MeasuredRange> range_around(const std::optional<double>& figure, std::string_view column, Bound bound) {
    const std::optional<MeasuredRange> found = range(column, bound);
    if (found && figure && !(found->low <= *figure && *figure <= found->high)) {
      rejects(column, "a range around the figure", text(column));
    }
    return found;
  }

  [[noreturn]] void rejects(std::string_view column, std::string_view expected, std::string_view found) const {
    fail("expected ", expected, " as ", column, ", found ", in_quotes(found), " in ", lines_.place());
  }
  std::string place() const { return lines_.place(); }

 private:
  std::size_t place_of(std::string_view column) {
    const auto place = static_cast<std::size_t>(std::find(names_.begin(), names_.end(), column) - names_.begin());
    if (place == names_.size()) fail("expected a column ", column, ", found none in ", file_.name());
    is_asked_[place] = true;
    return place;
  }

  FileReader file_;
  TextLines lines_{file_};
  std::vector<std::string> names_;
  std::vector<bool> is_asked_;
  std::vector<std::string_view> cells_;  ///< of the row that is read
};

std::vector<MeasurementSource> sources_of(const std::filesystem::path& path) {
  std::vector<MeasurementSource> sources;
  MeasurementTable table(path);
  while (table.next()) {
    MeasurementSource source;
    source.key = table.text_there("key");
    for (const MeasurementSource& other : sources) {
      if (other.key == source.key) table.rejects("key", "each key once", source.key);
    }
    source.is_cited = table.word("report", kReports);
    source.authors = table.text("authors");
    source.title = table.text("title");
    source.journal = table.text("journal");
    source.year = table.whole("year");
    source.doi = table.text("doi");
    source.url = table.text_there("url");
    source.read = table.text_there("read");
    source.quote = table.text_there("quote");
    sources.push_back(std::move(source));
  }
  return sources;
}

void read_common(MeasurementTable& table, const std::vector<MeasurementSource>& sources, MeasurementRow& row) {
  row.source = table.text_there("source");
  const auto has_its_key = [&row](const MeasurementSource& source) { return source.key == row.source; };
  if (std::none_of(sources.begin(), sources.end(), has_its_key)) {
    table.rejects("source", "a key of sources.csv", row.source);
  }
  row.species = table.text("species");
  row.tissue = table.word("tissue", kTissues);
  row.site = table.text("site");
  row.n = table.whole("n");
  row.n_of = table.text("n_of");
  row.is_fitted = table.word("fitted", kYesNo);
  row.note = table.text("note");
}

DrillingMeasurement drilling_row(MeasurementTable& table, const std::vector<MeasurementSource>& sources) {
  DrillingMeasurement row;
  read_common(table, sources, row);
  row.density_g_cm3 = table.number("density_g_cm3", Bound::above_0);
  row.density_known_by = table.text("density_known_by");
  row.process = table.word("process", kProcesses);
  row.tool = table.text("tool");
  row.diameter_mm = table.number("diameter_mm", Bound::above_0);
  row.point_angle_deg = table.number("point_angle_deg", Bound::above_0);
  row.web_mm = table.number("web_mm", Bound::above_0);
  row.helix_deg = table.number("helix_deg", Bound::not_negative);
  row.rpm = table.range("rpm", Bound::above_0);
  row.feed_mm_min = table.range("feed_mm_min", Bound::above_0);
  row.pilot_mm = table.number("pilot_mm", Bound::above_0);
  row.thrust_n = table.number("thrust_n", Bound::above_0);
  row.thrust_sd_n = table.deviation("thrust_sd_n", row.thrust_n.has_value());
  row.thrust_range_n = table.range_around(row.thrust_n, "thrust_range_n", Bound::not_negative);
  const bool has_thrust = row.thrust_n || row.thrust_range_n;
  row.thrust_kind = table.word_where(has_thrust, "thrust_kind", kForceKinds).value_or(MeasuredAs::not_stated);
  row.torque_n_mm = table.number("torque_n_mm", Bound::above_0);
  row.torque_sd_n_mm = table.deviation("torque_sd_n_mm", row.torque_n_mm.has_value());
  row.torque_range_n_mm = table.range_around(row.torque_n_mm, "torque_range_n_mm", Bound::not_negative);
  const bool has_torque = row.torque_n_mm || row.torque_range_n_mm;
  row.torque_kind = table.word_where(has_torque, "torque_kind", kForceKinds).value_or(MeasuredAs::not_stated);
  row.has_noted_conditions = table.word("conditions", kConditions);
  if (!has_thrust && !has_torque) fail("expected a thrust or a torque, found neither in ", table.place());
  return row;
}

ScrewMeasurement screw_row(MeasurementTable& table, const std::vector<MeasurementSource>& sources) {
  ScrewMeasurement row;
  read_common(table, sources, row);
  row.group = table.text("group");
  row.hu = table.number("hu", Bound::any);
  row.hu_sd = table.deviation("hu_sd", row.hu.has_value());
  row.t_score = table.number("t_score", Bound::any);
  row.t_score_sd = table.deviation("t_score_sd", row.t_score.has_value());
  row.bmd_g_cm2 = table.number("bmd_g_cm2", Bound::above_0);
  row.density_g_cm3 = table.number("density_g_cm3", Bound::above_0);
  row.density_known_by = table.text("density_known_by");
  row.screw = table.text("screw");
  row.outer_diameter_mm = table.number("outer_diameter_mm", Bound::above_0);
  row.core_diameter_mm = table.number("core_diameter_mm", Bound::above_0);
  row.pitch_mm = table.number("pitch_mm", Bound::above_0);
  row.length_mm = table.number("length_mm", Bound::above_0);
  row.inserted_mm = table.number("inserted_mm", Bound::above_0);
  row.pilot_mm = table.number("pilot_mm", Bound::above_0);
  row.torque_n_mm = table.number("torque_n_mm", Bound::above_0);
  row.torque_sd_n_mm = table.deviation("torque_sd_n_mm", row.torque_n_mm.has_value());
  row.torque_kind = table.word_where(row.torque_n_mm.has_value(), "torque_kind", kTorqueKinds);
  row.pullout_n = table.number("pullout_n", Bound::above_0);
  row.pullout_sd_n = table.deviation("pullout_sd_n", row.pullout_n.has_value());
  row.stiffness_n_mm = table.number("stiffness_n_mm", Bound::above_0);
  if (!row.torque_n_mm && !row.pullout_n)
    fail("expected a torque or a pull-out force, found neither in ", table.place());
  return row;
}

HeatMeasurement heat_row(MeasurementTable& table, const std::vector<MeasurementSource>& sources) {
  HeatMeasurement row;
  read_common(table, sources, row);
  row.process = table.word("process", kProcesses);
  row.tool = table.text("tool");
  row.diameter_mm = table.range("diameter_mm", Bound::above_0);
  row.rpm = table.range("rpm", Bound::above_0);
  row.feed_mm_min = table.range("feed_mm_min", Bound::above_0);
  row.feed_mm_rev = table.number("feed_mm_rev", Bound::above_0);
  row.axial_force_n = table.number("axial_force_n", Bound::above_0);
  row.pilot_mm = table.number("pilot_mm", Bound::above_0);
  row.irrigation = table.word("irrigation", kIrrigations);
  row.distance_mm = table.number("distance_mm", Bound::not_negative);
  row.depth_mm = table.number("depth_mm", Bound::not_negative);
  row.temperature_c = table.number("temperature_c", Bound::any);
  row.temperature_sd_c = table.deviation("temperature_sd_c", row.temperature_c.has_value());
  row.temperature_range_c = table.range_around(row.temperature_c, "temperature_range_c", Bound::any);
  row.temperature_kind = table.word("temperature_kind", kHeatKinds);
  if (!row.temperature_c && !row.temperature_range_c) fail("expected a temperature, found none in ", table.place());
  return row;
}

template <class Row>
std::vector<Row> rows_of(const std::filesystem::path& path, const std::vector<MeasurementSource>& sources,
                         Row (*row_of)(MeasurementTable&, const std::vector<MeasurementSource>&)) {
  std::vector<Row> rows;
  MeasurementTable table(path);
  while (table.next()) rows.push_back(row_of(table, sources));
  return rows;
}

}  // namespace

Measurements read_measurements(const std::filesystem::path& folder) {
  Measurements all;
  all.sources = sources_of(folder / "sources.csv");
  all.drilling = rows_of(folder / "drilling.csv", all.sources, drilling_row);
  all.screws = rows_of(folder / "screws.csv", all.sources, screw_row);
  all.heat = rows_of(folder / "heat.csv", all.sources, heat_row);
  return all;
}

Measurements shipped_measurements() { return read_measurements(data_file("measurements/sources.csv").parent_path()); }

}  // namespace spinaltap
