#pragma once

#include <pybind11/pybind11.h>

#include <functional>
#include <optional>
#include <type_traits>
#include <utility>

#include "core/base/progress.h"

namespace spinaltap {

/// Runs work that may take long in a thread of its own, without Python's lock, while the calling thread waits: it
/// hands what the work reports to `tell` (a callable of stage and fraction, or None) and looks for signals, so that
/// Ctrl-C cancels. What `tell` or a signal's handler raises ends the work and goes on to the caller; so does what the
/// work throws. The work must not touch Python's objects.
void run_long(const pybind11::object& tell, const std::function<void(const Progress&)>& work);

/// The same, for work that gives something.
template <class Work>
auto long_call(const pybind11::object& tell, const Work& work) {
  using Result = std::invoke_result_t<Work, const Progress&>;
  std::optional<Result> result;
  run_long(tell, [&](const Progress& progress) { result.emplace(work(progress)); });
  return std::move(*result);
}

}  // namespace spinaltap
