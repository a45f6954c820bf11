#pragma once

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/base/staged_output.h"
#include "core/base/text_fields.h"
#include "core/rbf/value_file.h"
#include "tests/cli/program.h"
#include "tests/support/temporary_folder.h"

namespace spinaltap::test {

inline constexpr double kRadiusMm = 8.0;
inline const Vec3 kCentreMm(12.0, -180.0, 900.0);

/// Directions spread evenly by the golden angle.
inline std::vector<Vec3> directions(int count) {
  std::vector<Vec3> result;
  for (int i = 0; i < count; ++i) {
    const double z = 1.0 - 2.0 * (i + 0.5) / count;
    const double angle = std::numbers::pi * (3.0 - std::sqrt(5.0)) * i;
    result.emplace_back(std::sqrt(1.0 - z * z) * std::cos(angle), std::sqrt(1.0 - z * z) * std::sin(angle), z);
  }
  return result;
}

/// A ball's surface points, and one on each side of every one, 1 mm away, with their distances.
inline RbfValues ball(int count) {
  RbfValues values;
  for (const double value_mm : {0.0, -1.0, 1.0}) {
    for (const Vec3& out : directions(count)) {
      values.points_mm.push_back(kCentreMm + (kRadiusMm + value_mm) * out);
      values.values_mm.push_back(value_mm);
    }
  }
  return values;
}

inline std::string csv(const RbfValues& values) {
  std::string text;
  for (std::size_t i = 0; i < values.points_mm.size(); ++i) {
    for (const double number : values.points_mm[i]) {
      append_number(number, text);
      text += ',';
    }
    append_number(values.values_mm[i], text);
    if (!values.error_bars_mm.empty()) {
      text += ',';
      append_number(values.error_bars_mm[i], text);
    }
    text += '\n';
  }
  return text;
}

/// A folder with ball.csv, and an empty folder work/ in it.
class RbfFolder : public testing::Test {
 protected:
  RbfFolder() {
    write("ball.csv", csv(ball(150)));
    std::filesystem::create_directory(folder_.path() / "work");
  }

  std::filesystem::path in(const std::string& name) const { return folder_.path() / name; }
  void write(const std::string& name, const std::string& bytes) const { write_whole_file(in(name), bytes); }

  std::string run(const std::string& arguments) const {
    const ProgramRun done = run_program(arguments + " --force", folder_.path());
    EXPECT_EQ(done.exit_code, 0) << arguments << ": " << done.errors;
    EXPECT_THAT(done.errors, testing::IsEmpty());
    return done.output;
  }

  /// Expects one line of error, an exit that is not 0, and no file in the empty folder work/.
  std::string rejected(const std::string& arguments, const std::string& before = "") const {
    const ProgramRun done = run_program(arguments + " --force", in("work"), before);
    EXPECT_NE(done.exit_code, 0) << arguments;
    EXPECT_EQ(std::count(done.errors.begin(), done.errors.end(), '\n'), 1) << done.errors;
    EXPECT_THAT(done.errors, testing::StartsWith("spinaltap: "));
    EXPECT_THAT(everything_in(in("work")), testing::IsEmpty()) << arguments;
    return done.errors;
  }

  /// Evaluates surface.rbf at points and returns what the program wrote.
  RbfValues evaluated(const std::vector<Vec3>& points_mm, const std::string& options = "") const {
    write("where.csv", csv({points_mm, std::vector<double>(points_mm.size(), 0.0), {}}));
    run("eval surface.rbf where.csv -o values.csv " + options);
    return read_values(in("values.csv"));
  }

  TemporaryFolder folder_;
};

}  // namespace spinaltap::test
