// Radial basis functions from the command line: points into a model, the model into values.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <functional>
#include <numbers>

#include "apps/common/json_file.h"
#include "core/base/gzip.h"
#include "core/base/number_text.h"
#include "core/base/staged_output.h"
#include "core/rbf/rbf_file.h"
#include "core/rbf/value_file.h"
#include "core/surface/point_file.h"
#include "tests/cli/program.h"
#include "tests/support/temporary_folder.h"

namespace spinaltap {
namespace {

using test::everything_in;
using test::ProgramRun;
using test::run_program;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
namespace fs = std::filesystem;

constexpr double kRadiusMm = 8.0;
const Vec3 kCentreMm(12.0, -180.0, 900.0);

/// Directions spread evenly by the golden angle.
std::vector<Vec3> directions(int count) {
  std::vector<Vec3> result;
  for (int i = 0; i < count; ++i) {
    const double z = 1.0 - 2.0 * (i + 0.5) / count;
    const double angle = std::numbers::pi * (3.0 - std::sqrt(5.0)) * i;
    result.emplace_back(std::sqrt(1.0 - z * z) * std::cos(angle), std::sqrt(1.0 - z * z) * std::sin(angle), z);
  }
  return result;
}

/// A ball's surface points, and one on each side of every one, 1 mm away, with their distances.
RbfValues ball(int count) {
  RbfValues values;
  for (const double value_mm : {0.0, -1.0, 1.0}) {
    for (const Vec3& out : directions(count)) {
      values.points_mm.push_back(kCentreMm + (kRadiusMm + value_mm) * out);
      values.values_mm.push_back(value_mm);
    }
  }
  return values;
}

std::string csv(const RbfValues& values) {
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

/// The sum as its definition says, with its gradient.
std::pair<double, Vec3> direct_sum(const RbfModel& model, const Vec3& p_mm) {
  const Vec3 q = p_mm - model.origin_mm;
  const std::vector<double>& a = model.polynomial;
  double value = a[0] + a[1] * q.x() + a[2] * q.y() + a[3] * q.z();
  Vec3 gradient(a[1], a[2], a[3]);
  if (model.kernel == RadialKernel::triharmonic) {
    value += a[4] * q.x() * q.x() + a[5] * q.x() * q.y() + a[6] * q.x() * q.z() + a[7] * q.y() * q.y() +
             a[8] * q.y() * q.z() + a[9] * q.z() * q.z();
    gradient += Vec3(2.0 * a[4] * q.x() + a[5] * q.y() + a[6] * q.z(), a[5] * q.x() + 2.0 * a[7] * q.y() + a[8] * q.z(),
                     a[6] * q.x() + a[8] * q.y() + 2.0 * a[9] * q.z());
  }
  const double c2 = model.low_pass_mm * model.low_pass_mm;
  for (std::size_t i = 0; i < model.weights.size(); ++i) {
    const Vec3 away = p_mm - model.centres_mm[i];
    const double r = std::sqrt(away.squaredNorm() + c2);
    value += model.weights[i] * phi(model.kernel, away.squaredNorm(), c2);
    gradient += model.weights[i] * (model.kernel == RadialKernel::biharmonic ? 1.0 / r : 3.0 * r) * away;
  }
  return {value, gradient};
}

class Rbf : public testing::Test {
 protected:
  Rbf() {
    write("ball.csv", csv(ball(150)));
    fs::create_directory(folder_.path() / "work");
  }

  fs::path in(const std::string& name) const { return folder_.path() / name; }
  void write(const std::string& name, const std::string& bytes) const { write_whole_file(in(name), bytes); }

  std::string run(const std::string& arguments) const {
    const ProgramRun done = run_program(arguments, folder_.path());
    EXPECT_EQ(done.exit_code, 0) << arguments << ": " << done.errors;
    EXPECT_THAT(done.errors, IsEmpty());
    return done.output;
  }

  /// Expects one line of error, an exit that is not 0, and no file in the empty folder work/.
  std::string refused(const std::string& arguments, const std::string& before = "") const {
    const ProgramRun done = run_program(arguments, in("work"), before);
    EXPECT_NE(done.exit_code, 0) << arguments;
    EXPECT_EQ(std::count(done.errors.begin(), done.errors.end(), '\n'), 1) << done.errors;
    EXPECT_THAT(done.errors, testing::StartsWith("spinaltap: "));
    EXPECT_THAT(everything_in(in("work")), IsEmpty()) << arguments;
    return done.errors;
  }

  /// Evaluates surface.rbf at points and returns what the program wrote.
  RbfValues evaluated(const std::vector<Vec3>& points_mm, const std::string& options = "") const {
    write("where.csv", csv({points_mm, std::vector<double>(points_mm.size(), 0.0), {}}));
    run("eval surface.rbf where.csv -o values.csv " + options);
    return read_values(in("values.csv"));
  }

  test::TemporaryFolder folder_;
};

TEST_F(Rbf, FitsABallFromEachKindOfFile) {
  const RbfValues values = ball(150);
  std::string turned = "value,z,y,x\n";  // another order
  SurfaceSamples samples;
  for (std::size_t i = 0; i < values.points_mm.size(); ++i) {
    const Vec3& p = values.points_mm[i];
    for (const double number : {values.values_mm[i], p.z(), p.y()}) {
      append_number(number, turned);
      turned += ',';
    }
    append_number(p.x(), turned);
    turned += '\n';
    samples.positions_mm.push_back(p);
    samples.values_mm.push_back(values.values_mm[i]);
    samples.normals.push_back((p - kCentreMm).normalized());
  }
  write("ball.csv.gz", gzip(turned));
  write_points(samples, in("ball.ply"));
  for (const char* name : {"ball.csv", "ball.csv.gz", "ball.ply"}) {
    const std::string output = run(std::string("fit ") + name + " -o surface.rbf");
    EXPECT_THAT(output, AllOf(HasSubstr("centres"), HasSubstr("largest residual"), HasSubstr("mm")));
    const RbfValues at_data = evaluated(values.points_mm);
    for (std::size_t i = 0; i < values.points_mm.size(); ++i) {
      ASSERT_NEAR(at_data.values_mm[i], values.values_mm[i], 0.02) << name;  // --accuracy, and what floats lose
    }
    // Between the data, which are 2.3 mm apart, the zero set is the ball's surface.
    const std::vector<Vec3> others = directions(211);
    std::vector<Vec3> points_mm;
    for (const Vec3& out : others) points_mm.push_back(kCentreMm + kRadiusMm * out);
    for (const double value_mm : evaluated(points_mm).values_mm) ASSERT_NEAR(value_mm, 0.0, 0.1) << name;
  }
}

TEST_F(Rbf, EvaluatesTheSumOfItsFile) {
  std::vector<Vec3> points_mm;
  for (const Vec3& out : directions(60)) {
    for (const double r : {0.5, 7.3, 9.0, 30.0}) points_mm.push_back(kCentreMm + r * out);
  }
  for (const char* kernel : {"biharmonic", "triharmonic"}) {
    run(std::string("fit ball.csv --kernel ") + kernel);
    RbfModel model = read_rbf(in("surface.rbf"));
    for (const double low_pass_mm : {0.0, 0.7}) {
      model.low_pass_mm = low_pass_mm;
      write("where.csv", csv({points_mm, std::vector<double>(points_mm.size(), 0.0), {}}));
      const std::string options =
          " --accuracy 1e-4 --gradient" + (low_pass_mm > 0.0 ? std::string(" --low-pass 0.7") : "");
      run("eval surface.rbf where.csv -o values.csv" + options);
      std::ifstream file(in("values.csv"));
      std::string line;
      std::getline(file, line);
      EXPECT_EQ(line, "x,y,z,value,gx,gy,gz");
      for (const Vec3& p_mm : points_mm) {
        const auto [value_mm, gradient] = direct_sum(model, p_mm);
        double x = 0.0, y = 0.0, z = 0.0, value = 0.0, gx = 0.0, gy = 0.0, gz = 0.0;
        char comma = 0;
        ASSERT_TRUE(file >> x >> comma >> y >> comma >> z >> comma >> value >> comma >> gx >> comma >> gy >> comma >>
                    gz);
        ASSERT_EQ(Vec3(x, y, z), p_mm);
        ASSERT_NEAR(value, value_mm, 1e-4) << kernel;
        ASSERT_LT((Vec3(gx, gy, gz) - gradient).norm(), 0.01) << kernel;  // --accuracy bounds values, not slopes
      }
    }
  }
}

TEST_F(Rbf, WritesTheSameNumbersAsPly) {
  run("fit ball.csv");
  run("eval surface.rbf ball.csv -o work/values.csv --gradient");
  run("eval surface.rbf ball.csv -o work/values.ply --gradient");
  EXPECT_EQ(read_values(in("work/values.ply")).values_mm, read_values(in("work/values.csv")).values_mm);
  EXPECT_EQ(read_positions(in("work/values.ply")), ball(150).points_mm);
  EXPECT_THAT(read_whole_file(in("work/values.ply")), HasSubstr("property double nz\n"));
  EXPECT_THAT(everything_in(in("work")), ElementsAre("values.csv", "values.ply"));
}

TEST_F(Rbf, ReproducesWhatItsPolynomialCan) {
  const auto linear = [](const Vec3& q) { return 1.0 + 0.5 * q.x() - 2.0 * q.y() + q.z(); };
  const auto quadratic = [&](const Vec3& q) { return linear(q) + 0.1 * q.x() * q.y() - 0.05 * q.z() * q.z(); };
  const std::pair<const char*, std::function<double(const Vec3&)>> cases[] = {{"biharmonic", linear},
                                                                              {"triharmonic", quadratic}};
  for (const auto& [kernel, truth] : cases) {
    RbfValues values = ball(60);
    for (std::size_t i = 0; i < values.points_mm.size(); ++i) {
      values.values_mm[i] = truth(values.points_mm[i] - kCentreMm);
    }
    write("values.csv", csv(values));
    run(std::string("fit values.csv --accuracy 1e-4 --kernel ") + kernel);
    std::vector<Vec3> inside_mm;
    for (const Vec3& out : directions(40)) inside_mm.push_back(kCentreMm + 5.0 * out);
    const RbfValues got = evaluated(inside_mm, "--accuracy 1e-5");
    // The equations may be off by 1e-4 mm at the points; between them that grows, but not much.
    for (std::size_t i = 0; i < inside_mm.size(); ++i) {
      ASSERT_NEAR(got.values_mm[i], truth(inside_mm[i] - kCentreMm), 2e-3) << kernel;
    }
  }
}

TEST_F(Rbf, KeepsAllPointsWithinWhatReducingAndErrorBarsAllow) {
  RbfValues values = ball(150);
  run("fit ball.csv --reduce 0.2 --json work/fit.json");
  const Json reduced = read_json(in("work/fit.json"));
  EXPECT_EQ(reduced.at("points"), values.points_mm.size());
  EXPECT_LE(reduced.at("centres"), values.points_mm.size());
  EXPECT_LE(reduced.at("max_residual_mm"), 0.2 + 0.01);
  const RbfValues at_data = evaluated(values.points_mm);
  for (std::size_t i = 0; i < values.points_mm.size(); ++i) {
    ASSERT_NEAR(at_data.values_mm[i], values.values_mm[i], 0.2 + 0.02);
  }
  values.error_bars_mm.assign(values.points_mm.size(), 0.3);
  write("bars.csv", csv(values));
  run("fit bars.csv --error-bars --json work/fit.json");
  EXPECT_LE(read_json(in("work/fit.json")).at("max_residual_mm"), 0.3 + 0.01);
}

TEST_F(Rbf, OfBadPointsIsRefused) {
  EXPECT_THAT(refused("fit ../none.csv -o out/a.rbf"), HasSubstr("no such file: ../none.csv"));
  EXPECT_THAT(refused("fit ../ball.csv --error-bars"), HasSubstr("expected a column error_bar, found none in ../ball"));
  write("bad.csv", "x,y,z,value\n1,2,3,4\n1,2,x,4\n");
  EXPECT_THAT(refused("fit ../bad.csv"), AllOf(HasSubstr("found \"x\""), HasSubstr("../bad.csv, line 3")));
  write("three.csv", "0,0,0,1\n1,0,0,1\n0,1,0,1\n");
  EXPECT_THAT(refused("fit ../three.csv -o out/a.rbf"), HasSubstr("points"));
  write("cut.csv.gz", gzip(csv(ball(150))).substr(0, 2000));
  EXPECT_THAT(refused("fit ../cut.csv.gz"), HasSubstr("cut short"));
  write("ball.txt", csv(ball(20)));
  EXPECT_THAT(refused("fit ../ball.txt"), HasSubstr(".csv, .csv.gz or .ply"));
  EXPECT_THAT(refused("fit ../ball.csv -o ../work"), HasSubstr("found a folder"));
}

TEST_F(Rbf, OptionsOutOfRangeAreRefused) {
  for (const char* options : {"--kernel cubic", "--accuracy 0", "--accuracy nan", "--smoothing -1", "--reduce -0.1",
                              "--merge -1", "--slabs 0 --reduce 1", "--slabs 2"}) {
    refused(std::string("fit ../ball.csv ") + options);
  }
  run("fit ball.csv");
  for (const char* options : {"--accuracy 0", "--accuracy nan", "--low-pass -1", "--low-pass nan", "-o values.txt"}) {
    refused(std::string("eval ../surface.rbf ../ball.csv ") + options);
  }
}

TEST_F(Rbf, OfABadFileIsNotEvaluated) {
  EXPECT_THAT(refused("eval ../none.rbf ../ball.csv"), HasSubstr("no such file: ../none.rbf"));
  EXPECT_THAT(refused("eval ../ball.csv ../ball.csv"), HasSubstr("another kind of file: ../ball.csv"));
  run("fit ball.csv");
  const std::string bytes = read_whole_file(in("surface.rbf"));
  write("cut.rbf", bytes.substr(0, bytes.size() / 2));
  EXPECT_THAT(refused("eval ../cut.rbf ../ball.csv -o out/values.csv"), HasSubstr("cut short?"));
  std::string damaged = bytes;
  damaged[bytes.size() / 2] ^= 1;
  write("damaged.rbf", damaged);
  EXPECT_THAT(refused("eval ../damaged.rbf ../ball.csv"), HasSubstr("checksum differs"));
  write("two.csv", "1,2\n");
  EXPECT_THAT(refused("eval ../surface.rbf ../two.csv"), HasSubstr("../two.csv, line 1"));
}

TEST_F(Rbf, LeavesTheOldFilesOnAFullDisk) {
  run("fit ball.csv");
  EXPECT_THAT(refused("fit ../ball.csv -o out/a.rbf", "ulimit -f 8;"), HasSubstr("cannot write"));
  EXPECT_THAT(refused("eval ../surface.rbf ../ball.csv -o a.csv", "ulimit -f 8;"), HasSubstr("cannot write"));
  EXPECT_THAT(refused("eval ../surface.rbf ../ball.csv -o a.ply", "ulimit -f 8;"), HasSubstr("cannot write"));
  const std::string old = read_whole_file(in("surface.rbf"));
  EXPECT_NE(run_program("fit ball.csv --kernel triharmonic", folder_.path(), "ulimit -f 8;").exit_code, 0);
  EXPECT_EQ(read_whole_file(in("surface.rbf")), old);
}

TEST_F(Rbf, HelpNamesUnitsAndTheKindsOfFile) {
  for (const char* name : {"fit", "eval"}) {
    const std::string help = run(std::string(name) + " --help");
    EXPECT_THAT(help, AllOf(HasSubstr("Example: spinaltap "), HasSubstr("patient LPS"), HasSubstr(".csv.gz"),
                            HasSubstr("MM"), HasSubstr(", mm")));
  }
}

}  // namespace
}  // namespace spinaltap
