// Radial basis functions from the command line: points into a model, the model into values.

#include <cstring>
#include <fstream>
#include <functional>
#include <nlohmann/json.hpp>

#include "core/base/gzip.h"
#include "core/files/json_file.h"
#include "core/rbf/field_volume.h"
#include "core/rbf/rbf_file.h"
#include "core/surface/surface_samples.h"
#include "tests/cli/rbf_folder.h"

namespace spinaltap {
namespace {

using test::ball;
using test::csv;
using test::directions;
using test::everything_in;
using test::kCentreMm;
using test::kRadiusMm;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;

class Rbf : public test::RbfFolder {};

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

TEST_F(Rbf, WritesAVolumeOverItsCentres) {
  run("fit ball.csv");
  run("eval surface.rbf --grid 2 -o work/field.nrrd --json work/eval.json");
  const RbfModel model = read_rbf(in("surface.rbf"));
  const std::string bytes = read_whole_file(in("work/field.nrrd"));
  const std::size_t head = bytes.find("\n\n") + 2;
  EXPECT_THAT(bytes.substr(0, head), AllOf(HasSubstr("type: float\n"), HasSubstr("space: left-posterior-superior\n"),
                                           HasSubstr("space directions: (2,0,0) (0,2,0) (0,0,2)\n")));
  const GridGeometry lattice = lattice_over(model.centres_mm, 2.0);  // the ball's 18 mm, and perhaps a little more
  EXPECT_EQ(bytes.size() - head, lattice.voxel_count() * sizeof(float));
  EXPECT_EQ(read_json(in("work/eval.json")).at("points"), lattice.voxel_count());
  for (int i = 0; i < lattice.size[0]; ++i) {
    float value_mm = 0.0F;
    std::memcpy(&value_mm, bytes.data() + head + lattice.offset(i, 3, 6) * sizeof value_mm, sizeof value_mm);
    const Vec3 p_mm = lattice.to_patient(Vec3(i, 3, 6));
    ASSERT_NEAR(value_mm, direct_sum(model, p_mm).first, 0.01);
    // Some 2 mm from the nearest data the fit is still a distance, if not a precise one.
    if ((p_mm - kCentreMm).norm() < 6.0) continue;
    ASSERT_NEAR(value_mm, (p_mm - kCentreMm).norm() - kRadiusMm, 0.5);
  }
}

TEST_F(Rbf, ReproducesWhatItsPolynomialCan) {
  const auto linear = [](const Vec3& q) { return 1.0 + 0.5 * q.x() - 2.0 * q.y() + q.z(); };
  const auto quadratic = [&](const Vec3& q) { return linear(q) + 0.1 * q.x() * q.y() - 0.05 * q.z() * q.z(); };
  const std::pair<const char*, std::function<double(const Vec3&)>> cases[] = {{"biharmonic", linear},
                                                                              {"triharmonic", quadratic}};
  for (const auto& [kernel, ground_truth] : cases) {
    RbfValues values = ball(60);
    for (std::size_t i = 0; i < values.points_mm.size(); ++i) {
      values.values_mm[i] = ground_truth(values.points_mm[i] - kCentreMm);
    }
    write("values.csv", csv(values));
    run(std::string("fit values.csv --accuracy 1e-4 --kernel ") + kernel);
    std::vector<Vec3> inside_mm;
    for (const Vec3& out : directions(40)) inside_mm.push_back(kCentreMm + 5.0 * out);
    const RbfValues got = evaluated(inside_mm, "--accuracy 1e-5");
    // The equations may be off by 1e-4 mm at the points; between them that grows, but not much.
    for (std::size_t i = 0; i < inside_mm.size(); ++i) {
      ASSERT_NEAR(got.values_mm[i], ground_truth(inside_mm[i] - kCentreMm), 2e-3) << kernel;
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

TEST_F(Rbf, HelpNamesUnitsAndTheKindsOfFile) {
  for (const char* name : {"fit", "eval"}) {
    const std::string help = run(std::string(name) + " --help");
    EXPECT_THAT(help, AllOf(HasSubstr("Example: spinaltap "), HasSubstr("patient LPS"), HasSubstr(".csv.gz"),
                            HasSubstr("MM"), HasSubstr(", mm")));
  }
}

}  // namespace
}  // namespace spinaltap
