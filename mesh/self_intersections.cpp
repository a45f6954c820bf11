#include "mesh/self_intersections.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/base/geometry.h"
#include "mesh/detail/triangle_grid.h"

namespace spinaltap::detail {
namespace {

/// A number of twice the digits: high + low, where low is what high rounded away.
struct Pair {
  double high = 0.0;
  double low = 0.0;
};

Pair sum(double a, double b) {
  const double s = a + b;
  const double part = s - a;
  return {s, (a - (s - part)) + (b - part)};
}

Pair product(double a, double b) {
  const double p = a * b;
  return {p, std::fma(a, b, -p)};
}

Pair operator+(const Pair& a, const Pair& b) {
  const Pair high = sum(a.high, b.high);
  const Pair low = sum(a.low, b.low);
  const Pair first = sum(high.high, high.low + low.high);
  return sum(first.high, first.low + low.low);
}

Pair operator-(const Pair& a) { return {-a.high, -a.low}; }

Pair operator*(const Pair& a, double b) {
  const Pair high = product(a.high, b);
  const Pair low = product(a.low, b);
  return high + low;
}

int sign(double value) { return value > 0.0 ? 1 : value < 0.0 ? -1 : 0; }

/// Sign of (b - a) x (c - a) . (d - a): 1 where d lies on the side to which the triangle abc faces, 0 in its plane.
/// Coordinates must be floats: the differences are then exact, and the determinant is taken with twice a double's
/// digits where rounding could turn its sign (after Shewchuk 1997, "Adaptive precision floating-point arithmetic").
int orientation(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  const Vec3 u = b - a;
  const Vec3 v = c - a;
  const Vec3 w = d - a;
  const double determinant = u.cross(v).dot(w);
  const Vec3 absolute = u.cwiseAbs();
  const double size = absolute.x() * (std::abs(v.y() * w.z()) + std::abs(v.z() * w.y())) +
                      absolute.y() * (std::abs(v.z() * w.x()) + std::abs(v.x() * w.z())) +
                      absolute.z() * (std::abs(v.x() * w.y()) + std::abs(v.y() * w.x()));
  constexpr double kRounding = 8.0 * std::numeric_limits<double>::epsilon();
  if (std::abs(determinant) > kRounding * size) return sign(determinant);
  const Pair x = product(v.y(), w.z()) + -product(v.z(), w.y());
  const Pair y = product(v.z(), w.x()) + -product(v.x(), w.z());
  const Pair z = product(v.x(), w.y()) + -product(v.y(), w.x());
  const Pair exact = x * u.x() + y * u.y() + z * u.z();
  return exact.high != 0.0 ? sign(exact.high) : sign(exact.low);
}

}  // namespace
}  // namespace spinaltap::detail

namespace spinaltap {
namespace {

using Corners = std::array<Vec3, 3>;

/// Sign of the area of a, b, c, looking along `axis`. Products of differences of floats are exact in doubles.
int turn(const Vec3& a, const Vec3& b, const Vec3& c, Eigen::Index axis) {
  const Eigen::Index i = (axis + 1) % 3;
  const Eigen::Index j = (axis + 2) % 3;
  const double area = (b[i] - a[i]) * (c[j] - a[j]) - (b[j] - a[j]) * (c[i] - a[i]);
  return area > 0.0 ? 1 : area < 0.0 ? -1 : 0;
}

bool on_segment(const Vec3& p, const Vec3& q, const Vec3& r, Eigen::Index axis) {
  for (const Eigen::Index i : {(axis + 1) % 3, (axis + 2) % 3}) {
    if (r[i] < std::min(p[i], q[i]) || r[i] > std::max(p[i], q[i])) return false;
  }
  return true;
}

bool segments_meet(const Vec3& p, const Vec3& q, const Vec3& a, const Vec3& b, Eigen::Index axis) {
  const int pa = turn(a, b, p, axis);
  const int qa = turn(a, b, q, axis);
  const int ap = turn(p, q, a, axis);
  const int bp = turn(p, q, b, axis);
  if (pa * qa < 0 && ap * bp < 0) return true;
  return (pa == 0 && on_segment(a, b, p, axis)) || (qa == 0 && on_segment(a, b, q, axis)) ||
         (ap == 0 && on_segment(p, q, a, axis)) || (bp == 0 && on_segment(p, q, b, axis));
}

/// Of a segment in the triangle's plane.
bool meets_in_plane(const Vec3& p, const Vec3& q, const Corners& t) {
  const Vec3 normal = (t[1] - t[0]).cross(t[2] - t[0]);
  Eigen::Index axis = 0;
  normal.cwiseAbs().maxCoeff(&axis);
  for (std::size_t c = 0; c < 3; ++c) {
    if (segments_meet(p, q, t[c], t[(c + 1) % 3], axis)) return true;
  }
  const int first = turn(t[0], t[1], p, axis);
  return first != 0 && turn(t[1], t[2], p, axis) == first && turn(t[2], t[0], p, axis) == first;
}

bool segment_meets(const Vec3& p, const Vec3& q, const Corners& t) {
  const int side_p = detail::orientation(t[0], t[1], t[2], p);
  const int side_q = detail::orientation(t[0], t[1], t[2], q);
  if (side_p * side_q > 0) return false;
  if (side_p == 0 && side_q == 0) return meets_in_plane(p, q, t);
  const int first = detail::orientation(p, q, t[0], t[1]);
  const int second = detail::orientation(p, q, t[1], t[2]);
  const int third = detail::orientation(p, q, t[2], t[0]);
  return (first >= 0 && second >= 0 && third >= 0) || (first <= 0 && second <= 0 && third <= 0);
}

bool all_on_one_side(const Corners& points, const Corners& t) {
  int sum = 0;
  for (const Vec3& p : points) sum += detail::orientation(t[0], t[1], t[2], p);
  return sum == 3 || sum == -3;
}

bool without_area(const Corners& t) { return (t[1] - t[0]).cross(t[2] - t[0]).isZero(0.0); }

/// Whether two triangles of a mesh meet beyond what they share.
bool cross(const TriangleMesh& mesh, std::uint32_t first, std::uint32_t second) {
  std::array<std::uint32_t, 3> s = mesh.triangles[first];
  std::array<std::uint32_t, 3> t = mesh.triangles[second];
  // Shared corners come first, in the same order.
  std::size_t shared = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    const auto found = std::find(t.begin() + static_cast<std::ptrdiff_t>(shared), t.end(), s[i]);
    if (found == t.end()) continue;
    std::swap(s[shared], s[i]);
    std::iter_swap(t.begin() + static_cast<std::ptrdiff_t>(shared), found);
    ++shared;
  }
  const auto corners = [&](const std::array<std::uint32_t, 3>& index) {
    Corners result;
    for (std::size_t c = 0; c < 3; ++c) result[c] = mesh.vertices_mm[index[c]].cast<double>();
    return result;
  };
  const Corners a = corners(s);
  const Corners b = corners(t);
  if (shared > 0 && (without_area(a) || without_area(b))) return false;
  if (shared == 3) return true;
  if (shared == 2) {
    if (detail::orientation(a[0], a[1], a[2], b[2]) != 0) return false;
    const Vec3 edge = a[1] - a[0];
    return edge.cross(a[2] - a[0]).dot(edge.cross(b[2] - a[0])) > 0.0;
  }
  if (shared == 1) return segment_meets(a[1], a[2], b) || segment_meets(b[1], b[2], a);
  if (all_on_one_side(a, b) || all_on_one_side(b, a)) return false;
  for (std::size_t c = 0; c < 3; ++c) {
    if (segment_meets(a[c], a[(c + 1) % 3], b) || segment_meets(b[c], b[(c + 1) % 3], a)) return true;
  }
  return false;
}

}  // namespace

std::vector<std::array<std::uint32_t, 2>> self_intersections(const TriangleMesh& mesh) {
  const detail::TriangleGrid grid(mesh);
  std::vector<std::vector<std::array<std::uint32_t, 2>>> of_cell(grid.cell_count());
  tbb::parallel_for(std::size_t{0}, grid.cell_count(), [&](std::size_t index) {
    const detail::TriangleGrid::Cell cell = grid.cell(index);
    for (std::size_t i = 0; i < cell.triangles.size(); ++i) {
      for (std::size_t j = i + 1; j < cell.triangles.size(); ++j) {
        const Box3& first = grid.box_of(cell.triangles[i]);
        const Box3& second = grid.box_of(cell.triangles[j]);
        if (!first.intersects(second)) continue;
        // A pair lies in many cells; the one with the lowest corner of both boxes' common part takes it.
        if ((grid.cell_of(first.min().cwiseMax(second.min())) != cell.at).any()) continue;
        if (cross(mesh, cell.triangles[i], cell.triangles[j])) {
          of_cell[index].push_back({cell.triangles[i], cell.triangles[j]});
        }
      }
    }
  });
  std::vector<std::array<std::uint32_t, 2>> pairs;
  for (const auto& found : of_cell) pairs.insert(pairs.end(), found.begin(), found.end());
  std::sort(pairs.begin(), pairs.end());
  return pairs;
}

}  // namespace spinaltap
