#include "core/grading/detail/other_readings.h"

#include <algorithm>
#include <array>
#include <utility>

namespace spinaltap {
namespace {

template <class Change>
DrillPath changed(DrillPath path, const Change& change) {
  path.entry_mm = change(path.entry_mm);
  path.target_mm = change(path.target_mm);
  for (Vec3& via_mm : path.via_mm) via_mm = change(via_mm);
  return path;
}

DrillPath swapped(DrillPath path) {
  std::swap(path.entry_mm, path.target_mm);
  std::reverse(path.via_mm.begin(), path.via_mm.end());
  return path;
}

DrillPath scaled(const DrillPath& path, const Vec3& by) {
  return changed(path, [&by](const Vec3& p) { return Vec3(p.cwiseProduct(by)); });
}

DrillPath reordered(const DrillPath& path, const std::array<int, 3>& order) {
  return changed(path, [&order](const Vec3& p) { return Vec3(p[order[0]], p[order[1]], p[order[2]]); });
}

}  // namespace

std::vector<PathReading> other_readings(const DrillPath& path) {
  const Vec3 ras(-1.0, -1.0, 1.0);
  std::vector<PathReading> readings{
      {swapped(path), "entry and target are swapped: the line runs from the target to the entry", 0},
      {scaled(path, ras), "the points are RAS: x and y negated", 0},
      {swapped(scaled(path, ras)), "the points are RAS, x and y negated, and entry and target are swapped", 1}};
  for (const auto& [unit, mm] : {std::pair{"cm", 10.0}, {"m", 1000.0}}) {
    readings.push_back({scaled(path, Vec3::Constant(mm)), std::string("the points are in ") + unit + ", not mm", 1});
    readings.push_back(
        {scaled(path, mm * ras), std::string("the points are RAS, x and y negated, and in ") + unit + ", not mm", 2});
  }
  for (const auto& [words, order] : {std::pair{"z, y, x", std::array{2, 1, 0}},
                                     {"y, x, z", std::array{1, 0, 2}},
                                     {"x, z, y", std::array{0, 2, 1}},
                                     {"y, z, x", std::array{2, 0, 1}},
                                     {"z, x, y", std::array{1, 2, 0}}}) {
    const DrillPath other = reordered(path, order);
    const std::string text = std::string("the coordinates are in the order ") + words;
    readings.push_back({other, text, 2});
    readings.push_back({scaled(other, ras), text + ", and RAS: x and y negated", 3});
  }
  for (int axis = 0; axis < 3; ++axis) {
    Vec3 sign = Vec3::Ones();
    sign[axis] = -1.0;
    readings.push_back(
        {scaled(path, sign), std::string(1, static_cast<char>('x' + axis)) + " is negated: another frame", 2});
  }
  std::ranges::stable_sort(readings, {}, &PathReading::rank);
  return readings;
}

}  // namespace spinaltap
