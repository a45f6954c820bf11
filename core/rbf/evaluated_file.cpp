#include "core/rbf/evaluated_file.h"

#include <algorithm>
#include <array>
#include <bit>

#include "core/base/error.h"
#include "core/base/file_stream.h"
#include "core/base/ply_head.h"
#include "core/base/text_fields.h"

namespace spinaltap {
namespace {

constexpr std::size_t kMaxNumbers = 7;

/// The numbers of a point as they stand in a file.
std::span<const double> numbers_of(const EvaluatedPoints& points, std::size_t i,
                                   std::array<double, kMaxNumbers>& numbers) {
  const Vec3& p = points.points_mm[i];
  const Vec3 g = points.gradients.empty() ? Vec3(Vec3::Zero()) : points.gradients[i];
  numbers = {p.x(), p.y(), p.z(), points.values_mm[i], g.x(), g.y(), g.z()};
  return std::span(numbers).first(points.gradients.empty() ? 4 : kMaxNumbers);
}

void write_csv(const EvaluatedPoints& points, FileWriter& file) {
  file.write(points.gradients.empty() ? "x,y,z,value\n" : "x,y,z,value,gx,gy,gz\n");
  std::string line;
  std::array<double, kMaxNumbers> numbers{};
  for (std::size_t i = 0; i < points.points_mm.size(); ++i) {
    line.clear();
    for (const double number : numbers_of(points, i, numbers)) {
      append_csv_number(number, line);
      line += ',';
    }
    line.back() = '\n';
    file.write(line);
  }
}

void write_ply(const EvaluatedPoints& points, FileWriter& file) {
  static_assert(std::endian::native == std::endian::little, "the file is little endian");
  PlyHead head{.comments = {"mm, patient LPS; value: mm, negative inside; nx ny nz: gradient, not a unit vector"},
               .elements = {{"vertex", points.points_mm.size()}}};
  if (points.gradients.empty()) head.comments = {"mm, patient LPS; value: mm, negative inside"};
  for (const char* name : {"x", "y", "z", "value", "nx", "ny", "nz"}) {
    head.elements[0].properties.push_back({name, PlyType::float64});
  }
  if (points.gradients.empty()) head.elements[0].properties.resize(4);
  file.write(encode(head));
  std::array<double, kMaxNumbers> numbers{};
  for (std::size_t i = 0; i < points.points_mm.size(); ++i) file.write(numbers_of(points, i, numbers));
}

bool is_ply(const std::filesystem::path& path) { return path.extension() == ".ply"; }

}  // namespace

void check_evaluated_name(const std::filesystem::path& path) {
  if (is_ply(path) || path.extension() == ".csv") return;
  fail("expected a file to write that ends in .csv or .ply, found ", path.string());
}

void write_evaluated(const EvaluatedPoints& points, const std::filesystem::path& path) {
  check_evaluated_name(path);
  const std::size_t count = points.points_mm.size();
  if (points.values_mm.size() != count || !(points.gradients.empty() || points.gradients.size() == count)) {
    fail("expected a value and, if any, a gradient for each of ", count, " points, found ", points.values_mm.size(),
         " and ", points.gradients.size());
  }
  FileWriter file(path);
  if (is_ply(path)) {
    write_ply(points, file);
  } else {
    write_csv(points, file);
  }
  file.close();
}

}  // namespace spinaltap
