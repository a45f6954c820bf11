#pragma once

#include <string>

#include "core/base/error.h"

namespace spinaltap::test {

/// The message of the Error that `work` throws, or "" when it throws none.
template <class Work>
std::string error_of(const Work& work) {
  try {
    work();
  } catch (const Error& error) {
    return error.what();
  }
  return {};
}

}  // namespace spinaltap::test
