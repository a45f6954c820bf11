#pragma once

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>

namespace spinaltap::test {

/// Folder of the real CTs that some tests need: $SPINALTAP_TEST_DATA, empty when it is not set.
inline std::filesystem::path test_data_folder() {
  const char* folder = std::getenv("SPINALTAP_TEST_DATA");
  return folder != nullptr ? folder : "";
}

/// Whether a missing data folder is a failure and not a reason to skip.
inline bool test_data_required() {
  const char* required = std::getenv("SPINALTAP_REQUIRE_TEST_DATA");
  return required != nullptr && std::string_view(required) == "1";
}

}  // namespace spinaltap::test

/// Sets `folder` to the real CT `name`, or skips the test; fails it where the data are required.
#define SPINALTAP_NEED_TEST_DATA(folder, name)                                            \
  const std::filesystem::path folder = spinaltap::test::test_data_folder() / (name);      \
  if (spinaltap::test::test_data_folder().empty() || !std::filesystem::exists(folder)) {  \
    if (spinaltap::test::test_data_required()) FAIL() << "test data missing: " << folder; \
    GTEST_SKIP() << "needs the real CT " << (name) << ": set SPINALTAP_TEST_DATA";        \
  }
