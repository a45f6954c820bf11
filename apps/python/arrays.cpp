#include "apps/python/arrays.h"

#include <algorithm>
#include <cstddef>
#include <string>

#include "core/base/error.h"

namespace py = pybind11;

namespace spinaltap {

namespace {

std::string shape_of(const py::array& array) {
  std::string text = "(";
  for (py::ssize_t n = 0; n < array.ndim(); ++n) text += (n == 0 ? "" : ", ") + std::to_string(array.shape(n));
  return text + (array.ndim() == 1 ? ",)" : ")");
}

/// Rows of a given width, or a single one.
bool has_rows_of(const py::array& array, py::ssize_t width) {
  return (array.ndim() == 1 || array.ndim() == 2) && array.shape(array.ndim() - 1) == width;
}

Vec3 vec3_at(const double* numbers) { return {numbers[0], numbers[1], numbers[2]}; }

/// One value for all, or one for each of `count`.
template <class T>
class OneOrEach {
 public:
  using Array = py::array_t<T, py::array::c_style | py::array::forcecast>;

  OneOrEach(const py::object& given, std::size_t count, std::string_view what)
      : values_(Array::ensure(given)), is_one_(values_ && values_.size() == 1) {
    if (!values_) {
      PyErr_Clear();
      fail("expected ", what, " as a number or an array, found ", std::string(py::str(py::type::of(given))));
    }
    if (!is_one_ && (values_.ndim() != 1 || static_cast<std::size_t>(values_.size()) != count)) {
      fail("expected one ", what, ", or one for each of ", count, " poses, found an array of shape ",
           shape_of(values_));
    }
  }
  T operator[](std::size_t n) const { return values_.data()[is_one_ ? 0 : n]; }

 private:
  Array values_;
  bool is_one_;
};

/// One direction for all, one for each of `count`, or None: zero.
class OneOrEachDirection {
 public:
  OneOrEachDirection(const py::object& given, std::size_t count, std::string_view what) {
    if (given.is_none()) return;
    values_ = Numbers::ensure(given);
    if (!values_) throw py::error_already_set();
    is_given_ = true;
    is_one_ = values_.size() == 3;
    if (!has_rows_of(values_, 3) || (!is_one_ && static_cast<std::size_t>(values_.size()) != 3 * count)) {
      fail("expected one ", what, ", or one for each of ", count, " tips, found an array of shape ", shape_of(values_));
    }
  }
  Vec3 operator[](std::size_t n) const {
    return is_given_ ? vec3_at(values_.data() + (is_one_ ? 0 : 3 * n)) : Vec3(Vec3::Zero());
  }

 private:
  Numbers values_;
  bool is_given_ = false;
  bool is_one_ = false;
};

/// The columns of a structured type.
class Columns {
 public:
  void add(std::string_view name, const char* format, std::size_t offset) {
    names_.append(std::string(name));
    formats_.append(format);
    offsets_.append(offset);
  }
  py::dtype type(std::size_t row_bytes) const {
    py::dict fields;
    fields["names"] = names_;
    fields["formats"] = formats_;
    fields["offsets"] = offsets_;
    fields["itemsize"] = row_bytes;
    return py::dtype::from_args(fields);
  }

 private:
  py::list names_, formats_, offsets_;
};

/// Made once, and never given back: it must outlive whatever Python keeps.
template <py::dtype (*make)()>
py::dtype kept() {
  static const py::handle type = make().release();
  return py::reinterpret_borrow<py::dtype>(type);
}

py::dtype make_cycle_dtype() {
  using Row = RecordedCycle;
  Columns columns;
  columns.add("cycle", "u8", offsetof(Row, cycle));
  columns.add("time_s", "f8", offsetof(Row, time_s));
  columns.add("dt_s", "f8", offsetof(Row, dt_s));
  columns.add("tip_mm", "(3,)f8", offsetof(Row, tip_mm));
  columns.add("axis", "(3,)f8", offsetof(Row, axis));
  columns.add("spindle_on", "u1", offsetof(Row, spindle_on));
  columns.add("state", "u1", offsetof(Row, state));
  columns.add("removed_points", "u4", offsetof(Row, removed));
  columns.add("removed_hu", "i8", offsetof(Row, removed_hu));
  columns.add("work_n_mm", "f8", offsetof(Row, work_n_mm));
  columns.add("force_n", "(3,)f8", offsetof(Row, force_n));
  columns.add("thrust_n", "f8", offsetof(Row, thrust_n));
  columns.add("torque_n_mm", "f8", offsetof(Row, torque_n_mm));
  columns.add("feed_mm_per_turn", "f8", offsetof(Row, feed_mm_per_turn));
  columns.add("tip_density_g_cm3", "f8", offsetof(Row, tip_density_g_cm3));
  columns.add("depth_mm", "f8", offsetof(Row, depth_mm));
  columns.add("clearance_outer_mm", "f8", offsetof(Row, outer_mm));
  columns.add("clearance_canal_mm", "f8", offsetof(Row, canal_mm));
  columns.add("side", "(3,)f8", offsetof(Row, side));
  columns.add("temperature_c", "f8", offsetof(Row, temperature_c));
  columns.add("max_temperature_c", "f8", offsetof(Row, max_temperature_c));
  return columns.type(sizeof(Row));
}

py::dtype make_event_dtype() {
  using Row = SessionEvent;
  Columns columns;
  columns.add("kind", "u1", offsetof(Row, kind));
  columns.add("cycle", "u8", offsetof(Row, cycle));
  columns.add("time_s", "f8", offsetof(Row, time_s));
  columns.add("depth_mm", "f8", offsetof(Row, depth_mm));
  columns.add("place_mm", "(3,)f8", offsetof(Row, place_mm));
  columns.add("value", "f8", offsetof(Row, value));
  return columns.type(sizeof(Row));
}

// The number of the run comes first, as in the table's files.
py::dtype make_study_dtype() {
  static_assert(sizeof(StudyRow) == kStudyColumns * sizeof(double));
  Columns columns;
  const auto add = [&columns](StudyColumn column, std::string_view name) {
    columns.add(name, "f8", static_cast<std::size_t>(column) * sizeof(double));
  };
  add(StudyColumn::run, name_of(StudyColumn::run));
  for (std::size_t n = 0; n < kStudyFactors; ++n) {
    add(static_cast<StudyColumn>(n), name_of(static_cast<StudyFactor>(n)));
  }
  for (std::size_t n = kStudyFactors + 1; n < kStudyColumns; ++n) {
    add(static_cast<StudyColumn>(n), name_of(static_cast<StudyColumn>(n)));
  }
  return columns.type(sizeof(StudyRow));
}

template <class T>
std::vector<py::ssize_t> length_of(const std::vector<T>& values) {
  return {static_cast<py::ssize_t>(values.size())};
}
template <class T>
std::vector<py::ssize_t> by_three(const std::vector<T>& values) {
  return {static_cast<py::ssize_t>(values.size()), 3};
}

}  // namespace

Vec3 vec3_of(const Numbers& numbers, std::string_view what) {
  if (numbers.ndim() != 1 || numbers.size() != 3) {
    fail("expected ", what, " as 3 numbers, found an array of shape ", shape_of(numbers));
  }
  return vec3_at(numbers.data());
}

std::vector<Vec3> points_of(const Numbers& numbers) {
  if (!has_rows_of(numbers, 3)) fail("expected points as an array of shape (n, 3), found ", shape_of(numbers));
  std::vector<Vec3> points(static_cast<std::size_t>(numbers.size() / 3));
  for (std::size_t n = 0; n < points.size(); ++n) points[n] = vec3_at(numbers.data() + 3 * n);
  return points;
}

py::array_t<double> array_of(const Vec3& v) { return py::array_t<double>(3, v.data()); }

py::array_t<double> array_of(const Mat3& m) {
  py::array_t<double> array({3, 3});
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) array.mutable_at(row, column) = m(row, column);
  }
  return array;
}

std::vector<ToolInput> inputs_of(const Numbers& tips, const py::object& axes, const py::object& dt_s,
                                 const py::object& spindle_on, const py::object& sides) {
  const bool has_axes = !axes.is_none();
  const py::ssize_t width = has_axes ? 3 : 6;
  if (!has_rows_of(tips, width)) {
    fail("expected poses as an array of shape (n, 6), tips and axes, or two of shape (n, 3), found ", shape_of(tips),
         has_axes ? " for the tips" : " and no axes");
  }
  const auto count = static_cast<std::size_t>(tips.size() / width);
  const OneOrEachDirection given_axes(axes, count, "axis"), given_sides(sides, count, "side");
  const OneOrEach<double> times(dt_s, count, "dt_s");
  const OneOrEach<bool> spindles(spindle_on, count, "spindle_on");
  std::vector<ToolInput> inputs(count);
  for (std::size_t n = 0; n < count; ++n) {
    const double* const tip = tips.data() + n * static_cast<std::size_t>(width);
    inputs[n] = {{vec3_at(tip), has_axes ? given_axes[n] : vec3_at(tip + 3), given_sides[n]}, spindles[n], times[n]};
  }
  return inputs;
}

py::dtype cycle_dtype() { return kept<make_cycle_dtype>(); }
py::dtype event_dtype() { return kept<make_event_dtype>(); }
py::dtype study_dtype() { return kept<make_study_dtype>(); }

py::array array_of(std::vector<RecordedCycle>&& cycles) {
  const std::vector<py::ssize_t> shape = length_of(cycles);
  return owned_array(std::move(cycles), cycle_dtype(), shape);
}
py::array array_of(std::vector<SessionEvent>&& events) {
  const std::vector<py::ssize_t> shape = length_of(events);
  return owned_array(std::move(events), event_dtype(), shape);
}
py::array array_of(std::vector<StudyRow>&& rows) {
  const std::vector<py::ssize_t> shape = length_of(rows);
  return owned_array(std::move(rows), study_dtype(), shape);
}
py::array array_of(std::vector<float>&& values) {
  const std::vector<py::ssize_t> shape = length_of(values);
  return owned_array(std::move(values), py::dtype::of<float>(), shape);
}
py::array array_of(std::vector<Vec3>&& points) {
  const std::vector<py::ssize_t> shape = by_three(points);
  return owned_array(std::move(points), py::dtype::of<double>(), shape);
}
py::array array_of(std::vector<Eigen::Vector3f>&& points) {
  const std::vector<py::ssize_t> shape = by_three(points);
  return owned_array(std::move(points), py::dtype::of<float>(), shape);
}

py::tuple arrays_of(TriangleMesh&& mesh) {
  const std::vector<py::ssize_t> shape = by_three(mesh.triangles);
  py::array triangles = owned_array(std::move(mesh.triangles), py::dtype::of<std::uint32_t>(), shape);
  return py::make_tuple(array_of(std::move(mesh.vertices_mm)), std::move(triangles));
}

}  // namespace spinaltap
