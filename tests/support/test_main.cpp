#include <gtest/gtest.h>

#include <cstdio>
#include <cstdlib>
#include <map>
#include <string>

#include "tests/support/test_kind.h"

namespace spinaltap::test {
namespace {

/// Of each kind, GoogleTest's patterns with a colon behind each. In a function: sources note theirs before main().
std::map<TestKind, std::string>& patterns_of() {
  static std::map<TestKind, std::string> patterns;
  return patterns;
}

/// The filter that leaves what SPINALTAP_TESTS names: quick (neither slow nor whole runs), slow, or whole. Empty where
/// that is none of these.
std::string filter_of(const std::string& which, const std::string& given) {
  const std::string slow = patterns_of()[TestKind::slow], whole = patterns_of()[TestKind::whole_run];
  if (which == "quick") return given + (given.find('-') == std::string::npos ? "-" : ":") + slow + whole;
  if (which == "slow") return (slow.empty() ? "none" : slow) + "-" + whole;
  if (which == "whole") return whole.empty() ? "none" : whole;
  return "";
}

}  // namespace

TestsOfKind::TestsOfKind(TestKind kind, std::initializer_list<const char*> patterns) {
  for (const char* pattern : patterns) {
    patterns_of()[kind] += std::string(pattern) + ":*/" + pattern + ":";
  }
}

}  // namespace spinaltap::test

/// Runs a program's tests: all that its filter names, or of these only what SPINALTAP_TESTS does. Returns 77, which
/// ctest shows as skipped, where all that ran were skipped.
int main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  if (const char* which = std::getenv("SPINALTAP_TESTS")) {
    const std::string filter = spinaltap::test::filter_of(which, GTEST_FLAG_GET(filter));
    if (filter.empty()) {
      std::fprintf(stderr, "SPINALTAP_TESTS: expected quick, slow or whole, found \"%s\"\n", which);
      return 2;
    }
    GTEST_FLAG_SET(filter, filter);
  }
  const int result = RUN_ALL_TESTS();
  const testing::UnitTest& tests = *testing::UnitTest::GetInstance();
  constexpr int kSkipped = 77;
  return result == 0 && tests.skipped_test_count() > 0 && tests.successful_test_count() == 0 ? kSkipped : result;
}
