#pragma once

#include <cstddef>
#include <functional>
#include <string_view>

#include "core/base/progress.h"

namespace spinaltap {

/// Runs `work` for 0 to `count` - 1 on all cores. Of the Errors thrown, the one of the lowest number is thrown on, so
/// that the message does not depend on the threads; Cancelled stops at once. `stage` names the work for `progress`.
void for_each_file(std::size_t count, std::string_view stage, const Progress& progress,
                   const std::function<void(std::size_t)>& work);

}  // namespace spinaltap
