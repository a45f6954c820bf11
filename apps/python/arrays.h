#pragma once

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <string_view>
#include <vector>

#include "core/base/geometry.h"
#include "core/base/triangle_mesh.h"
#include "core/session/cycle.h"
#include "core/session/operator/operator.h"
#include "core/session/record/session_record.h"
#include "core/study/study_row.h"

namespace spinaltap {

/// Any array or sequence of numbers that Python has; one of doubles in C's order is not copied.
using Numbers = pybind11::array_t<double, pybind11::array::c_style | pybind11::array::forcecast>;

/// Three numbers. Throws Error that calls them `what`.
Vec3 vec3_of(const Numbers& numbers, std::string_view what);
/// Positions, N by 3, or a single one. Throws Error that says the shape found.
std::vector<Vec3> points_of(const Numbers& numbers);
pybind11::array_t<double> array_of(const Vec3& v);
pybind11::array_t<double> array_of(const Mat3& m);

/// Poses with the time since the last. `tips`: N by 3, with `axes` N by 3 or one axis for all; or N by 6, both, without
/// `axes`. `dt_s` and `spindle_on`: one, or N. `sides`: of a plate, N by 3 or one for all; None: not said.
std::vector<ToolInput> inputs_of(const Numbers& tips, const pybind11::object& axes, const pybind11::object& dt_s,
                                 const pybind11::object& spindle_on, const pybind11::object& sides);

/// Structured types, with a record's, or a study's, names of columns.
pybind11::dtype cycle_dtype();
pybind11::dtype event_dtype();
pybind11::dtype study_dtype();

/// Hands a vector over to an array, which shows its memory and frees it.
template <class T>
pybind11::array owned_array(std::vector<T>&& values, const pybind11::dtype& type,
                            const std::vector<pybind11::ssize_t>& shape) {
  auto kept = std::make_unique<std::vector<T>>(std::move(values));
  const void* const data = kept->data();
  const pybind11::capsule owner(kept.get(), [](void* vector) { delete static_cast<std::vector<T>*>(vector); });
  kept.release();  // NOLINT(bugprone-unused-return-value): the capsule has it
  return pybind11::array(type, shape, {}, data, owner);
}
pybind11::array array_of(std::vector<RecordedCycle>&& cycles);
pybind11::array array_of(std::vector<SessionEvent>&& events);
pybind11::array array_of(std::vector<StudyRow>&& rows);
pybind11::array array_of(std::vector<float>&& values);
pybind11::array array_of(std::vector<Vec3>&& points);
pybind11::array array_of(std::vector<Eigen::Vector3f>&& points);
/// Vertices (N by 3, float32, patient LPS, mm) and triangles (M by 3, uint32).
pybind11::tuple arrays_of(TriangleMesh&& mesh);

}  // namespace spinaltap
