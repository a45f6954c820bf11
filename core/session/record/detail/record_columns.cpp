#include "core/session/record/detail/record_columns.h"

#include <utility>
#include <vector>

#include "core/base/text_fields.h"

namespace spinaltap {
namespace {

template <class Number>
constexpr Hdf5Number kind_of() {
  if constexpr (std::is_same_v<Number, std::uint8_t>) return Hdf5Number::u8;
  if constexpr (std::is_same_v<Number, std::uint32_t>) return Hdf5Number::u32;
  if constexpr (std::is_same_v<Number, std::uint64_t>) return Hdf5Number::u64;
  if constexpr (std::is_same_v<Number, std::int64_t>) return Hdf5Number::i64;
  return Hdf5Number::f64;
}

/// Where a member's numbers lie.
const double* numbers_of(const Vec3& v) { return v.data(); }
double* numbers_of(Vec3& v) { return v.data(); }
template <class Number>
Number* numbers_of(Number& number) {
  return &number;
}

/// `Get` leads from a row to the value.
template <class Row, auto Get>
RecordColumn<Row> column_of(const char* name, std::array<const char*, 3> csv_names) {
  using Value = std::remove_cvref_t<decltype(Get(std::declval<Row&>()))>;
  RecordColumn<Row> made;
  made.name = name;
  made.csv_names = csv_names;
  if constexpr (std::is_same_v<Value, Vec3>) {
    made.width = 3;
    made.row_bytes = 3 * sizeof(double);
  } else {
    static_assert(sizeof(Value) <= sizeof(double) && std::is_trivially_copyable_v<Value>);
    if constexpr (std::is_enum_v<Value>) {
      made.number = kind_of<std::underlying_type_t<Value>>();
    } else {
      made.number = kind_of<Value>();
    }
    made.row_bytes = sizeof(Value);
  }
  constexpr std::size_t kBytes = std::is_same_v<Value, Vec3> ? 3 * sizeof(double) : sizeof(Value);
  made.store = [](const Row& row, void* to) { std::memcpy(to, numbers_of(Get(row)), kBytes); };
  made.load = [](Row& row, const void* from) { std::memcpy(numbers_of(Get(row)), from, kBytes); };
  return made;
}

template <class Row, auto Member>
RecordColumn<Row> column(const char* name, std::array<const char*, 3> csv_names) {
  return column_of < Row, [](auto& row) -> auto& { return row.*Member; }
  > (name, csv_names);
}
template <auto Member>
RecordColumn<RecordedCycle> device_column(const char* name, std::array<const char*, 3> csv_names) {
  return column_of < RecordedCycle, [](auto& row) -> auto& { return row.device.*Member; }
  > (name, csv_names);
}
template <auto Member>
RecordColumn<RecordedCycle> device_pose_column(const char* name, std::array<const char*, 3> csv_names) {
  return column_of < RecordedCycle, [](auto& row) -> auto& { return row.device.pose.*Member; }
  > (name, csv_names);
}

template <auto Member>
RecordColumn<RecordedCycle> cycle_column(const char* name) {
  return column<RecordedCycle, Member>(name, {name});
}
template <auto Member>
RecordColumn<SessionEvent> event_column(const char* name) {
  return column<SessionEvent, Member>(name, {name});
}

}  // namespace

namespace {

std::vector<RecordColumn<RecordedCycle>> made_cycle_columns(RecordParts parts) {
  using Row = RecordedCycle;
  std::vector<RecordColumn<Row>> columns{
      cycle_column<&Row::cycle>("cycle"),
      cycle_column<&Row::time_s>("time_s"),
      cycle_column<&Row::dt_s>("dt_s"),
      column<Row, &Row::tip_mm>("tip_mm", {"tip_x_mm", "tip_y_mm", "tip_z_mm"}),
      column<Row, &Row::axis>("axis", {"axis_x", "axis_y", "axis_z"}),
      cycle_column<&Row::spindle_on>("spindle_on"),
      cycle_column<&Row::state>("state"),
      cycle_column<&Row::removed>("removed_points"),
      cycle_column<&Row::removed_hu>("removed_hu"),
      cycle_column<&Row::work_n_mm>("work_n_mm"),
      column<Row, &Row::force_n>("force_n", {"force_x_n", "force_y_n", "force_z_n"}),
      cycle_column<&Row::thrust_n>("thrust_n"),
      cycle_column<&Row::torque_n_mm>("torque_n_mm"),
      cycle_column<&Row::feed_mm_per_turn>("feed_mm_per_turn"),
      cycle_column<&Row::tip_density_g_cm3>("tip_density_g_cm3"),
      cycle_column<&Row::depth_mm>("depth_mm"),
      cycle_column<&Row::outer_mm>("clearance_outer_mm"),
      cycle_column<&Row::canal_mm>("clearance_canal_mm"),
  };
  if (parts.has_sides) columns.push_back(column<Row, &Row::side>("side", {"side_x", "side_y", "side_z"}));
  if (parts.has_heat) {
    columns.push_back(cycle_column<&Row::temperature_c>("temperature_c"));
    columns.push_back(cycle_column<&Row::max_temperature_c>("max_temperature_c"));
  }
  if (parts.has_device) {
    columns.push_back(device_column<&DeviceSide::status>("device_status", {"device_status"}));
    columns.push_back(device_column<&DeviceSide::buttons>("device_buttons", {"device_buttons"}));
    columns.push_back(
        device_pose_column<&Pose::tip_mm>("device_tip_mm", {"device_tip_x_mm", "device_tip_y_mm", "device_tip_z_mm"}));
    columns.push_back(
        device_pose_column<&Pose::axis>("device_axis", {"device_axis_x", "device_axis_y", "device_axis_z"}));
    columns.push_back(
        device_pose_column<&Pose::side>("device_side", {"device_side_x", "device_side_y", "device_side_z"}));
    columns.push_back(device_column<&DeviceSide::force_n>(
        "device_force_n", {"device_force_x_n", "device_force_y_n", "device_force_z_n"}));
    columns.push_back(device_column<&DeviceSide::torque_n_mm>(
        "device_torque_n_mm", {"device_torque_x_n_mm", "device_torque_y_n_mm", "device_torque_z_n_mm"}));
  }
  return columns;
}

}  // namespace

std::span<const RecordColumn<RecordedCycle>> cycle_columns(RecordParts parts) {
  static const std::array<std::vector<RecordColumn<RecordedCycle>>, 8> columns = [] {
    std::array<std::vector<RecordColumn<RecordedCycle>>, 8> made;
    for (unsigned n = 0; n < made.size(); ++n) {
      made[n] =
          made_cycle_columns({.has_sides = (n & 1U) != 0, .has_heat = (n & 2U) != 0, .has_device = (n & 4U) != 0});
    }
    return made;
  }();
  return columns[(parts.has_sides ? 1U : 0U) + (parts.has_heat ? 2U : 0U) + (parts.has_device ? 4U : 0U)];
}

std::span<const RecordColumn<SessionEvent>> event_columns() {
  using Row = SessionEvent;
  static const std::array columns{
      event_column<&Row::kind>("kind"),
      event_column<&Row::cycle>("cycle"),
      event_column<&Row::time_s>("time_s"),
      event_column<&Row::depth_mm>("depth_mm"),
      column<Row, &Row::place_mm>("place_mm", {"place_x_mm", "place_y_mm", "place_z_mm"}),
      event_column<&Row::value>("value"),
  };
  return columns;
}

std::size_t bytes_of(Hdf5Number number) {
  return number == Hdf5Number::u8    ? sizeof(std::uint8_t)
         : number == Hdf5Number::u32 ? sizeof(std::uint32_t)
         : number == Hdf5Number::f32 ? sizeof(float)
                                     : sizeof(double);
}

namespace {

template <class Number>
Number number_at(const void* from) {
  Number number{};
  std::memcpy(&number, from, sizeof number);
  return number;
}

}  // namespace

void append_number(Hdf5Number number, const void* from, std::string& text) {
  switch (number) {
    case Hdf5Number::u8:
      text += std::to_string(number_at<std::uint8_t>(from));
      break;
    case Hdf5Number::u32:
      text += std::to_string(number_at<std::uint32_t>(from));
      break;
    case Hdf5Number::u64:
      text += std::to_string(number_at<std::uint64_t>(from));
      break;
    case Hdf5Number::i64:
      text += std::to_string(number_at<std::int64_t>(from));
      break;
    case Hdf5Number::f32:
      append_number(static_cast<double>(number_at<float>(from)), text);
      break;
    case Hdf5Number::f64:
      append_number(number_at<double>(from), text);
      break;
  }
}

}  // namespace spinaltap
