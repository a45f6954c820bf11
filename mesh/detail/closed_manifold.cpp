#include "mesh/detail/closed_manifold.h"

#include <algorithm>
#include <array>
#include <span>
#include <vector>

namespace spinaltap::detail {

bool is_closed_manifold(const TriangleMesh& mesh) {
  std::vector<std::uint32_t> first(mesh.vertices_mm.size() + 1, 0);
  for (const auto& t : mesh.triangles) {
    for (std::size_t c = 0; c < 3; ++c) {
      if (t[c] >= mesh.vertices_mm.size() || t[c] == t[(c + 1) % 3]) return false;
      ++first[t[c] + 1];
    }
  }
  for (std::size_t n = 1; n < first.size(); ++n) first[n] += first[n - 1];
  // Of each corner's vertex the next and the last vertex of its triangle.
  std::vector<std::array<std::uint32_t, 2>> sides(first.back());
  std::vector<std::uint32_t> next(first.begin(), first.end() - 1);
  for (const auto& t : mesh.triangles) {
    for (std::size_t c = 0; c < 3; ++c) sides[next[t[c]]++] = {t[(c + 1) % 3], t[(c + 2) % 3]};
  }
  for (std::size_t vertex = 0; vertex + 1 < first.size(); ++vertex) {
    const auto fan = std::span(sides).subspan(first[vertex], first[vertex + 1] - first[vertex]);
    if (fan.empty()) continue;
    // From triangle to triangle over the side that both have, through all of them and back.
    std::uint32_t at = fan.front()[0];
    for (std::size_t n = 0; n < fan.size(); ++n) {
      const auto goes_on = [&](const auto& side) { return side[0] == at; };
      const auto found = std::find_if(fan.begin(), fan.end(), goes_on);
      if (found == fan.end() || std::find_if(found + 1, fan.end(), goes_on) != fan.end()) return false;
      at = (*found)[1];
      if (at == fan.front()[0]) {
        if (n + 1 != fan.size()) return false;
        break;
      }
    }
    if (at != fan.front()[0]) return false;
  }
  return !mesh.triangles.empty();
}

}  // namespace spinaltap::detail
