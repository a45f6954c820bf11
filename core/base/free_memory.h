#pragma once

#include <vector>

namespace spinaltap {

/// Empties lists and gives back their memory, which `list = {}` keeps: that assigns an empty list of values.
template <class... T>
void free_memory(std::vector<T>&... lists) noexcept {
  (std::vector<T>().swap(lists), ...);
}

}  // namespace spinaltap
