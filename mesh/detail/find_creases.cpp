#include <algorithm>
#include <cmath>
#include <numeric>

#include "mesh/detail/collapsed_part.h"

namespace spinaltap::detail {
namespace {

/// A side of a triangle, from the lower vertex to the higher.
struct Side {
  std::uint32_t low, high, triangle;
};

std::vector<Side> sorted_sides(const TriangleMesh& mesh) {
  std::vector<std::uint32_t> first(mesh.vertices_mm.size() + 1, 0);
  for (const auto& t : mesh.triangles) {
    for (std::size_t c = 0; c < 3; ++c) ++first[std::min(t[c], t[(c + 1) % 3]) + 1];
  }
  for (std::size_t n = 1; n < first.size(); ++n) first[n] += first[n - 1];
  std::vector<Side> sides(first.back());
  std::vector<std::uint32_t> next(first.begin(), first.end() - 1);
  for (std::uint32_t n = 0; n < mesh.triangles.size(); ++n) {
    const auto& t = mesh.triangles[n];
    for (std::size_t c = 0; c < 3; ++c) {
      const auto [low, high] = std::minmax(t[c], t[(c + 1) % 3]);
      sides[next[low]++] = {low, high, n};
    }
  }
  for (std::size_t n = 0; n + 1 < first.size(); ++n) {
    std::sort(sides.begin() + first[n], sides.begin() + first[n + 1],
              [](const Side& a, const Side& b) { return a.high < b.high; });
  }
  return sides;
}

bool turns(const Vec3& n, const Vec3& m) {
  static const double kCosine = std::cos(0.5);
  const double lengths = n.norm() * m.norm();
  return lengths > 0.0 && n.dot(m) < kCosine * lengths;
}

}  // namespace

std::vector<CreaseVertex> find_creases(const TriangleMesh& mesh, double shortest_mm) {
  std::vector<Vec3> normals;
  normals.reserve(mesh.triangles.size());
  for (const auto& [a, b, c] : mesh.triangles) {
    const Vec3 p = mesh.vertices_mm[a].cast<double>();
    normals.push_back((mesh.vertices_mm[b].cast<double>() - p).cross(Vec3(mesh.vertices_mm[c].cast<double>() - p)));
  }
  const std::vector<Side> sides = sorted_sides(mesh);
  std::vector<std::array<std::uint32_t, 2>> edges;
  for (std::size_t n = 0; n + 1 < sides.size(); ++n) {
    const Side& one = sides[n];
    const Side& other = sides[n + 1];
    if (one.low != other.low || one.high != other.high) continue;
    if (turns(normals[one.triangle], normals[other.triangle])) edges.push_back({one.low, one.high});
  }
  // Each vertex points to another of its chain; the first points to itself.
  std::vector<std::uint32_t> first(mesh.vertices_mm.size());
  std::iota(first.begin(), first.end(), 0U);
  const auto chain_of = [&first](std::uint32_t vertex) {
    while (first[vertex] != vertex) vertex = first[vertex] = first[first[vertex]];
    return vertex;
  };
  for (const auto& [a, b] : edges) {
    const std::uint32_t one = chain_of(a), two = chain_of(b);
    first[std::max(one, two)] = std::min(one, two);
  }
  std::vector<double> length_mm(mesh.vertices_mm.size(), 0.0);
  for (const auto& [a, b] : edges) {
    length_mm[chain_of(a)] += static_cast<double>((mesh.vertices_mm[a] - mesh.vertices_mm[b]).norm());
  }
  std::vector<CreaseVertex> creases(mesh.vertices_mm.size());
  std::vector<std::uint32_t> counts(mesh.vertices_mm.size(), 0);
  for (const auto& [a, b] : edges) {
    if (length_mm[chain_of(a)] <= shortest_mm) continue;
    for (const auto& [vertex, end] : {std::array{a, b}, std::array{b, a}}) {
      const std::uint32_t count = counts[vertex]++;
      if (count < 2) creases[vertex].ends[count] = end;
    }
  }
  for (std::size_t n = 0; n < creases.size(); ++n) {
    if (counts[n] == 0) continue;
    creases[n].kind = counts[n] == 2 ? CreaseVertex::Kind::along : CreaseVertex::Kind::end;
  }
  return creases;
}

}  // namespace spinaltap::detail
