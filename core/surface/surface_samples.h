#pragma once

#include <cstddef>
#include <filesystem>
#include <map>
#include <string>

#include "core/surface/surface_points.h"

namespace spinaltap {

/// Where the surface and off-surface points come from.
enum class PointMethod {
  pixels,    ///< centres of surface pixels, off-surface points on their neighbours (the paper's section 3.3)
  normals,   ///< the same centres, one off-surface point each along a normal estimated from the points (section 3.4)
  contours,  ///< sub-pixel edges from the grey values, consistent between slices, off-surface points on both sides
};

struct SampleOptions {
  PointMethod method = PointMethod::contours;
  double off_surface_mm = 1.0;  ///< along normals; shortened where another part of the surface is near
  SurfaceOptions surface = {};  ///< for contours
};

/// Points with the values that a surface's function has there: what a radial basis function is fitted to.
struct SurfaceSamples {
  std::vector<Vec3> positions_mm;  ///< patient LPS; the surface points first
  std::vector<Vec3> normals;       ///< outward unit normal, of its surface point; zero where a pixel has none
  std::vector<double> values_mm;   ///< 0 on the surface, otherwise the signed distance: positive outside
  std::size_t surface_count = 0;
  std::size_t dropped = 0;      ///< surface pixels without an outward direction, not among the points (normals)
  std::size_t without_off = 0;  ///< surface points with no room for an off-surface point on some side
};

/// Throws Error where extract_surface() does, and on an off-surface distance that is not above 0.
SurfaceSamples sample_surface(const CtVolume& ct, const BoneMask& mask, const SampleOptions& options = {},
                              const Progress& progress = {});

/// Ways to surface points by the names that they have in options and reports.
const std::map<std::string, PointMethod>& point_methods();

/// "pixels", "normals" or "contours".
const std::string& name_of(PointMethod method);

/// Writes points as binary PLY: x, y, z (mm, patient LPS), nx, ny, nz, value (mm), one float each; the surface points
/// (value 0) come first. `path` must be a staged (temporary) name. Throws Error when the disk is full.
void write_points(const SurfaceSamples& samples, const std::filesystem::path& path);

}  // namespace spinaltap
