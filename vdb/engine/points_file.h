#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "core/ct/hu_to_density.h"
#include "core/points/point_volume.h"
#include "core/tool/drill_path.h"

namespace spinaltap {

struct PointsFileOptions {
  /// Also gives each point the density that this calibration has for its CT number.
  std::optional<HuToDensity> density;
};

/// Saves a volume's occupied points as an OpenVDB point grid named "points", which Houdini and Blender show. World
/// space is patient LPS, mm. Attributes: P, in fixed point, right to 1/65536 of a voxel of two spacings; "hu", whole
/// numbers; "density", g/cm³, where asked for. Metadata "spinaltap:...": path (its name), entry_mm and target_mm
/// (patient LPS), spacing_mm, radius_mm. The same volume gives the same bytes. The file appears whole or not at all.
/// Throws Error where it cannot be written.
void write_points(const PointVolume& volume, const DrillPath& path, const std::filesystem::path& file,
                  const PointsFileOptions& options = {});

/// What a file of points holds, point for point in the grid's order.
struct SavedPoints {
  std::vector<Vec3> positions_mm;  ///< patient LPS
  std::vector<int> hu;
  std::vector<float> density_g_cm3;             ///< empty where the file has none
  std::map<std::string, std::string> metadata;  ///< metadata, without its prefix
};

/// Throws Error on a missing or damaged file, and one without such a grid.
SavedPoints read_points(const std::filesystem::path& file);

}  // namespace spinaltap
