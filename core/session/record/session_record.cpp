#include "core/session/record/session_record.h"

#include <cmath>
#include <ostream>

#include "core/base/hash.h"
#include "core/session/record/detail/record_columns.h"

namespace spinaltap {
namespace {

using Bytes = std::array<std::byte, 24>;
constexpr RecordParts kAllParts{.has_sides = true, .has_heat = true, .has_device = true};

/// A quantity's number in a row of CSV: nothing where it is infinite or none, as append_csv_number() has it.
template <class Row>
void append_field(const RecordColumn<Row>& column, const Bytes& bytes, std::size_t n, std::string& text) {
  const std::byte* from = bytes.data() + n * bytes_of(column.number);
  if (column.number == Hdf5Number::f64) {
    double value = 0.0;
    std::memcpy(&value, from, sizeof value);
    if (!std::isfinite(value)) return;
  }
  append_number(column.number, from, text);
}

/// `name_column` names the one whose numbers are shown as `name` has them.
template <class Row, class Name>
void write_csv(std::span<const RecordColumn<Row>> columns, std::span<const Row> rows, std::string_view name_column,
               const Name& name, std::ostream& csv) {
  std::string text;
  for (const RecordColumn<Row>& column : columns) {
    for (std::size_t n = 0; n < column.width; ++n) {
      if (!text.empty()) text += ',';
      text += column.csv_names[n];
    }
  }
  csv << text << '\n';
  for (const Row& row : rows) {
    text.clear();
    for (const RecordColumn<Row>& column : columns) {
      Bytes bytes{};
      column.store(row, bytes.data());
      for (std::size_t n = 0; n < column.width; ++n) {
        if (&column != columns.data() || n > 0) text += ',';
        if (column.name == name_column) {
          text += name(row);
        } else {
          append_field(column, bytes, n, text);
        }
      }
    }
    csv << text << '\n';
  }
}

}  // namespace

RecordedCycle recorded(const Cycle& cycle) {
  RecordedCycle row;
  row.cycle = cycle.index;
  row.time_s = cycle.time_s;
  row.dt_s = cycle.input.dt_s;
  row.tip_mm = cycle.input.pose.tip_mm;
  row.axis = cycle.input.pose.axis;
  row.spindle_on = cycle.input.spindle_on ? 1 : 0;
  row.state = static_cast<std::uint8_t>(cycle.state);
  row.removed = static_cast<std::uint32_t>(cycle.step.removed);
  row.removed_hu = cycle.step.removed_hu;
  row.work_n_mm = cycle.step.work_n_mm;
  row.force_n = cycle.force.force_n;
  row.thrust_n = cycle.force.thrust_n;
  row.torque_n_mm = cycle.force.torque_n_mm;
  row.feed_mm_per_turn = cycle.force.feed_mm_per_turn;
  row.tip_density_g_cm3 = cycle.force.tip_density_g_cm3;
  row.depth_mm = cycle.depth_mm;
  row.outer_mm = cycle.clearance.outer_mm;
  row.canal_mm = cycle.clearance.canal_mm;
  row.side = cycle.input.pose.side;
  row.device = cycle.input.device;
  // Rows are compared by value too, which numbers that are none would not bear.
  if (!std::isnan(cycle.heat.temperature_c)) {
    row.temperature_c = cycle.heat.temperature_c;
    row.max_temperature_c = cycle.heat.max_temperature_c;
  }
  return row;
}

RecordParts record_parts(const DrillBit& tool, const SessionOptions& options) {
  return {.has_sides = tool.is_plate() || options.has_device,
          .has_heat = options.heat.has_value(),
          .has_device = options.has_device};
}

bool operator==(const RecordedCycle& a, const RecordedCycle& b) { return same_bits(cycle_columns(kAllParts), a, b); }

std::string difference(const RecordedCycle& a, const RecordedCycle& b) {
  for (const RecordColumn<RecordedCycle>& column : cycle_columns(kAllParts)) {
    Bytes of_a{};
    Bytes of_b{};
    column.store(a, of_a.data());
    column.store(b, of_b.data());
    const std::size_t bytes = bytes_of(column.number);
    for (std::size_t n = 0; n < column.width; ++n) {
      if (std::memcmp(of_a.data() + n * bytes, of_b.data() + n * bytes, bytes) == 0) continue;
      std::string text = column.csv_names[n];
      text += ' ';
      append_number(column.number, of_a.data() + n * bytes, text);
      text += " and ";
      append_number(column.number, of_b.data() + n * bytes, text);
      return text;
    }
  }
  return "";
}

std::string hash_of(const SessionRecord& record) {
  WordHash64 hash;
  const auto add = [&hash](const auto& columns, const auto& row) {
    for (const auto& column : columns) {
      Bytes bytes{};
      column.store(row, bytes.data());
      hash.add(bytes.data(), column.width * bytes_of(column.number));
    }
  };
  for (const RecordedCycle& row : record.cycles) add(cycle_columns(record.parts), row);
  for (const SessionEvent& event : record.events) {
    if (event.kind != EventKind::record_lost) add(event_columns(), event);
  }
  for (const RecordedTool& tool : record.tools) hash.add(tool.tool.data(), tool.tool.size());
  return hash.hex();
}

void write_record_csv(const SessionRecord& record, std::ostream& csv) {
  write_csv(
      cycle_columns(record.parts), std::span<const RecordedCycle>(record.cycles), "state",
      [](const RecordedCycle& row) { return name_of(static_cast<DrillState>(row.state)); }, csv);
}

void write_events_csv(const SessionRecord& record, std::ostream& csv) {
  write_csv(
      event_columns(), std::span<const SessionEvent>(record.events), "kind",
      [](const SessionEvent& row) { return name_of(row.kind); }, csv);
}

}  // namespace spinaltap
