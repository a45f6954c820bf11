#pragma once

#include <pybind11/pybind11.h>

namespace spinaltap {

// What each file adds to the module spinaltap._core.
void bind_plan(pybind11::module_& module);
void bind_view(pybind11::module_& module);
void bind_bone(pybind11::module_& module);
void bind_registration(pybind11::module_& module);
void bind_session(pybind11::module_& module);
void bind_record(pybind11::module_& module);
void bind_study(pybind11::module_& module);
void bind_drill_task(pybind11::module_& module);

}  // namespace spinaltap
