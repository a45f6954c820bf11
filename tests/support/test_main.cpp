#include <gtest/gtest.h>

/// Runs a program's tests. Returns 77, which ctest shows as skipped, where all that ran were skipped.
int main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  const int result = RUN_ALL_TESTS();
  const testing::UnitTest& tests = *testing::UnitTest::GetInstance();
  constexpr int kSkipped = 77;
  return result == 0 && tests.skipped_test_count() > 0 && tests.successful_test_count() == 0 ? kSkipped : result;
}
