#pragma once

#include <cmath>
#include <cstdint>
#include <numbers>

#include "core/base/triangle_mesh.h"

namespace spinaltap::test {

/// Corners at the origin and `side_mm` along each axis: volume side³ / 6.
inline TriangleMesh tetrahedron(float side_mm = 6.0F) {
  return {{{0.0F, 0.0F, 0.0F}, {side_mm, 0.0F, 0.0F}, {0.0F, side_mm, 0.0F}, {0.0F, 0.0F, side_mm}},
          {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}}};
}

/// A box from 0 to `size_mm`, moved by `corner_mm`.
inline TriangleMesh box_mesh(const Eigen::Vector3f& size_mm, const Eigen::Vector3f& corner_mm) {
  TriangleMesh mesh;
  for (int corner = 0; corner < 8; ++corner) {
    const Eigen::Vector3f unit(static_cast<float>(corner & 1), static_cast<float>((corner >> 1) & 1),
                               static_cast<float>((corner >> 2) & 1));
    mesh.vertices_mm.push_back(corner_mm + unit.cwiseProduct(size_mm));
  }
  mesh.triangles = {{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
                    {2, 6, 7}, {2, 7, 3}, {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
  return mesh;
}

/// A ring around z of `around` by `across` vertices.
inline TriangleMesh torus_mesh(double ring_mm, double tube_mm, std::uint32_t around, std::uint32_t across) {
  TriangleMesh mesh;
  for (std::uint32_t i = 0; i < around; ++i) {
    for (std::uint32_t j = 0; j < across; ++j) {
      const double u = 2.0 * std::numbers::pi * i / around;
      const double v = 2.0 * std::numbers::pi * j / across;
      const double r = ring_mm + tube_mm * std::cos(v);
      mesh.vertices_mm.push_back(Vec3(r * std::cos(u), r * std::sin(u), tube_mm * std::sin(v)).cast<float>());
      const auto at = [&](std::uint32_t a, std::uint32_t b) { return (a % around) * across + b % across; };
      mesh.triangles.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
      mesh.triangles.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
    }
  }
  return mesh;
}

/// A sphere of `bands` rings between two poles.
inline TriangleMesh ball_mesh(double radius_mm, const Vec3& centre_mm, std::uint32_t bands, std::uint32_t around) {
  TriangleMesh mesh;
  const auto add = [&](double polar, double turn) {
    const Vec3 unit(std::sin(polar) * std::cos(turn), std::sin(polar) * std::sin(turn), std::cos(polar));
    mesh.vertices_mm.push_back((centre_mm + radius_mm * unit).cast<float>());
  };
  add(0.0, 0.0);
  for (std::uint32_t i = 1; i <= bands; ++i) {
    for (std::uint32_t j = 0; j < around; ++j) {
      add(std::numbers::pi * i / (bands + 1), 2.0 * std::numbers::pi * j / around);
    }
  }
  add(std::numbers::pi, 0.0);
  const auto last = static_cast<std::uint32_t>(mesh.vertices_mm.size() - 1);
  const auto at = [&](std::uint32_t band, std::uint32_t j) { return 1 + (band - 1) * around + j % around; };
  for (std::uint32_t j = 0; j < around; ++j) {
    mesh.triangles.push_back({0, at(1, j), at(1, j + 1)});
    mesh.triangles.push_back({last, at(bands, j + 1), at(bands, j)});
    for (std::uint32_t i = 1; i < bands; ++i) {
      mesh.triangles.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
      mesh.triangles.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
    }
  }
  return mesh;
}

}  // namespace spinaltap::test
