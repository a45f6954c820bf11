#include "core/surface/surface_samples.h"

#include <tbb/parallel_for.h>

#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <span>

#include "core/base/error.h"
#include "core/base/ply_head.h"
#include "core/base/staged_output.h"
#include "core/surface/detail/local_normals.h"
#include "core/surface/off_surface.h"
#include "core/surface/pixel_points.h"

namespace spinaltap {
namespace {

/// Adds off-surface points along the normals, first outside all surface points, then inside.
void add_off_surface(SurfaceSamples& samples, double wanted_mm, std::span<const double> sides) {
  const std::size_t count = samples.surface_count;
  const std::vector<Vec3> surface_mm(samples.positions_mm.begin(),
                                     samples.positions_mm.begin() + static_cast<std::ptrdiff_t>(count));
  const PointGrid grid(surface_mm, wanted_mm);
  for (const double side : sides) {
    std::vector<double> length_mm(count);
    tbb::parallel_for(std::size_t{0}, count, [&](std::size_t i) {
      length_mm[i] = off_surface_length_mm(grid, surface_mm[i], side * samples.normals[i], wanted_mm);
    });
    for (std::size_t i = 0; i < count; ++i) {
      if (!(length_mm[i] > 0.0)) {
        ++samples.without_off;
        continue;
      }
      samples.positions_mm.push_back(surface_mm[i] + side * length_mm[i] * samples.normals[i]);
      samples.normals.push_back(samples.normals[i]);
      samples.values_mm.push_back(side * length_mm[i]);
    }
  }
}

SurfaceSamples from_pixels(const BoneMask& mask) {
  const PixelPoints pixels = surface_pixels(mask);
  const PixelNeighbours neighbours = neighbour_pixels(mask, pixels);
  SurfaceSamples samples;
  samples.surface_count = pixels.voxels.size();
  const auto add = [&](const std::array<int, 3>& voxel, const Vec3& outward, double value_mm) {
    samples.positions_mm.push_back(mask.geometry.to_patient(Vec3(voxel[0], voxel[1], voxel[2])));
    samples.normals.push_back(outward.normalized());
    samples.values_mm.push_back(value_mm);
  };
  for (std::size_t i = 0; i < pixels.voxels.size(); ++i) add(pixels.voxels[i], pixels.outward[i], 0.0);
  for (std::size_t i = 0; i < neighbours.voxels.size(); ++i) {
    const std::array<int, 3>& voxel = neighbours.voxels[i];
    const int axis = voxel[0] != pixels.voxels[neighbours.of[i]][0] ? 0 : 1;
    const double step_mm = mask.geometry.spacing_mm[axis];
    add(voxel, pixels.outward[neighbours.of[i]], neighbours.is_inside[i] ? -step_mm : step_mm);
  }
  return samples;
}

SurfaceSamples from_normals(const BoneMask& mask, double off_surface_mm) {
  const PixelPoints pixels = surface_pixels(mask);
  // Wide enough for the slices above and below.
  const double radius_mm = 2.0 * mask.geometry.spacing_mm.maxCoeff();
  constexpr double kOutside = 1.0;
  SurfaceSamples samples;
  std::vector<Vec3> outward;
  for (std::size_t i = 0; i < pixels.voxels.size(); ++i) {
    if (pixels.outward[i].isZero()) {
      ++samples.dropped;
      continue;
    }
    const std::array<int, 3>& voxel = pixels.voxels[i];
    samples.positions_mm.push_back(mask.geometry.to_patient(Vec3(voxel[0], voxel[1], voxel[2])));
    outward.push_back(pixels.outward[i].normalized());
  }
  samples.surface_count = samples.positions_mm.size();
  samples.values_mm.assign(samples.surface_count, 0.0);
  samples.normals = local_normals(samples.positions_mm, outward, radius_mm);
  add_off_surface(samples, off_surface_mm, {&kOutside, 1});
  return samples;
}

SurfaceSamples from_contours(const CtVolume& ct, const BoneMask& mask, const SampleOptions& options,
                             const Progress& progress) {
  constexpr std::array kBothSides{1.0, -1.0};
  SurfacePoints points = extract_surface(ct, mask, options.surface, progress);
  SurfaceSamples samples;
  samples.surface_count = points.positions_mm.size();
  samples.values_mm.assign(samples.surface_count, 0.0);
  samples.positions_mm = std::move(points.positions_mm);
  samples.normals = std::move(points.normals);
  add_off_surface(samples, options.off_surface_mm, kBothSides);
  return samples;
}

}  // namespace

SurfaceSamples sample_surface(const CtVolume& ct, const BoneMask& mask, const SampleOptions& options,
                              const Progress& progress) {
  if (!(options.off_surface_mm > 0.0) || !std::isfinite(options.off_surface_mm)) {
    fail("surface points: expected an off-surface distance above 0 mm, found ", options.off_surface_mm, " mm");
  }
  if (options.method == PointMethod::contours) return from_contours(ct, mask, options, progress);
  SurfaceSamples samples =
      options.method == PointMethod::pixels ? from_pixels(mask) : from_normals(mask, options.off_surface_mm);
  if (samples.surface_count == 0) fail("surface points: the mask holds no voxel");
  return samples;
}

const std::map<std::string, PointMethod>& point_methods() {
  static const std::map<std::string, PointMethod> methods{
      {"pixels", PointMethod::pixels}, {"normals", PointMethod::normals}, {"contours", PointMethod::contours}};
  return methods;
}

const std::string& name_of(PointMethod method) {
  for (const auto& [name, known] : point_methods()) {
    if (known == method) return name;
  }
  fail_as(ErrorKind::internal, "no such method for surface points");
}

void write_points(const SurfaceSamples& samples, const std::filesystem::path& path) {
  static_assert(std::endian::native == std::endian::little, "the file is little endian");
  const std::size_t count = samples.positions_mm.size();
  if (samples.normals.size() != count || samples.values_mm.size() != count) {
    fail("points: expected a normal and a value for each of ", count, " points");
  }
  PlyHead head{.comments = {"mm, patient LPS; value: signed distance from the surface, mm, negative inside"},
               .elements = {{"vertex", count}}};
  for (const char* name : {"x", "y", "z", "nx", "ny", "nz", "value"}) head.elements[0].properties.push_back({name});
  std::string bytes = encode(head);
  const std::size_t head_size = bytes.size();
  constexpr std::size_t kPointBytes = 7 * sizeof(float);
  bytes.resize(head_size + count * kPointBytes);
  for (std::size_t i = 0; i < count; ++i) {
    std::array<float, 7> point{};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      point[axis] = static_cast<float>(samples.positions_mm[i][static_cast<Eigen::Index>(axis)]);
      point[3 + axis] = static_cast<float>(samples.normals[i][static_cast<Eigen::Index>(axis)]);
    }
    point[6] = static_cast<float>(samples.values_mm[i]);
    std::memcpy(bytes.data() + head_size + i * kPointBytes, point.data(), kPointBytes);
  }
  write_whole_file(path, bytes);
}

}  // namespace spinaltap
