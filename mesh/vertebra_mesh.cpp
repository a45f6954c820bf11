#include "mesh/vertebra_mesh.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "core/base/error.h"
#include "core/base/text_writer.h"
#include "mesh/mesh_io.h"

namespace spinaltap {
namespace {

struct NamedUnit {
  LengthUnit unit;
  std::string_view short_name;
  std::string_view plural;
  double mm;
};

constexpr std::array<NamedUnit, 4> kUnits{{{LengthUnit::kMillimetre, "mm", "millimetres", 1.0},
                                           {LengthUnit::kCentimetre, "cm", "centimetres", 10.0},
                                           {LengthUnit::kInch, "in", "inches", 25.4},
                                           {LengthUnit::kMetre, "m", "metres", 1000.0}}};

bool plausible(const Vec3& sides_mm, const VertebraExtents& extents) {
  return sides_mm.maxCoeff() >= extents.min_longest_mm && sides_mm.maxCoeff() <= extents.max_longest_mm &&
         sides_mm.minCoeff() >= extents.min_shortest_mm && sides_mm.minCoeff() <= extents.max_shortest_mm;
}

std::string units_that_fit(const Vec3& sides, const VertebraExtents& extents) {
  TextWriter text;
  for (const NamedUnit& one : kUnits) {
    if (!plausible(one.mm * sides, extents)) continue;
    text << (text.str().empty() ? "it looks like " : ", or ") << one.plural << ": scale it by " << one.mm;
  }
  if (text.str().empty()) return "it fits in no common unit: is it one whole vertebra?";
  return text.str();
}

}  // namespace

double mm_per_unit(LengthUnit unit) {
  const auto* found =
      std::find_if(kUnits.begin(), kUnits.end(), [&](const NamedUnit& one) { return one.unit == unit; });
  return found->mm;
}

std::optional<LengthUnit> length_unit_from_name(std::string_view name) {
  for (const NamedUnit& one : kUnits) {
    if (one.short_name == name) return one.unit;
  }
  return std::nullopt;
}

VertebraExtents vertebra_extents(Level level) {
  constexpr VertebraExtents kCervical{35.0, 105.0, 12.0, 60.0}, kThoracic{45.0, 115.0, 20.0, 80.0},
      kLumbar{60.0, 135.0, 28.0, 85.0}, kSacrum{80.0, 170.0, 40.0, 120.0}, kAny{35.0, 135.0, 12.0, 85.0};
  const int rank = level_rank(level);
  if (level == Level::kNone) return kAny;
  if (rank <= level_rank(Level::kC7)) return kCervical;
  if (rank <= level_rank(Level::kT13)) return kThoracic;
  return level == Level::kSacrum ? kSacrum : kLumbar;
}

void check_mesh_units(const TriangleMesh& mesh, Level level) {
  if (mesh.vertices_mm.empty()) fail("mesh: expected a vertebra, found no vertices");
  Box3 box;
  for (const Eigen::Vector3f& p : mesh.vertices_mm) {
    if (!p.allFinite()) fail("mesh: a vertex is not a number");
    box.extend(p.cast<double>());
  }
  const Vec3 sides = box.sizes();
  const VertebraExtents extents = vertebra_extents(level);
  if (plausible(sides, extents)) return;
  TextWriter size(3);
  size << sides.x() << " x " << sides.y() << " x " << sides.z();
  fail("the mesh is ", size.str(), "; ", level == Level::kNone ? "a vertebra" : level_name(level), " is ",
       extents.min_longest_mm, " to ", extents.max_longest_mm, " mm long at its longest and ", extents.min_shortest_mm,
       " to ", extents.max_shortest_mm, " at its shortest: ", units_that_fit(sides, extents));
}

TriangleMesh scaled_mesh(const TriangleMesh& mesh, double scale) {
  if (!(scale > 0.0 && std::isfinite(scale))) fail("mesh: expected a scale above 0, found ", scale);
  TriangleMesh scaled = mesh;
  for (Eigen::Vector3f& p : scaled.vertices_mm) p = (scale * p.cast<double>()).cast<float>();
  return scaled;
}

VertebraMesh to_vertebra_mesh(const TriangleMesh& mesh, const VertebraMeshOptions& options) {
  VertebraMesh result;
  result.mesh = scaled_mesh(mesh, options.scale.value_or(1.0));
  if (!options.scale) check_mesh_units(result.mesh, options.level);
  if (options.axes) {
    result.mesh = turn_axes(result.mesh, *options.axes);
  } else {
    result.warnings = check_mesh_axes(result.mesh);
  }
  return result;
}

VertebraMesh read_vertebra_mesh(const std::filesystem::path& path, const VertebraMeshOptions& options) {
  const TriangleMesh mesh = read_mesh(path);
  try {
    return to_vertebra_mesh(mesh, options);
  } catch (const Error& error) {
    fail(path.string(), ": ", error.what());
  }
}

}  // namespace spinaltap
