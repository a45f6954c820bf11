#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/triangle_mesh.h"
#include "core/ct/level.h"
#include "mesh/mesh_axes.h"

namespace spinaltap {

/// Units of length in which surface files come. STL, PLY and OBJ do not say theirs.
enum class LengthUnit { kMillimetre, kCentimetre, kInch, kMetre };

/// How many mm one unit is.
double mm_per_unit(LengthUnit unit);

/// "mm", "cm", "in" or "m"; nothing for other names.
std::optional<LengthUnit> length_unit_from_name(std::string_view name);

/// How large whole vertebrae are, with their processes, mm: the sides of a box around them.
struct VertebraExtents {
  double min_longest_mm = 0.0;  ///< of the box's longest side
  double max_longest_mm = 0.0;
  double min_shortest_mm = 0.0;  ///< and of its shortest
  double max_shortest_mm = 0.0;
};

/// Bounds for adults, set widely: only to tell a unit from another, not a small vertebra from a large one, and a
/// vertebra may lie at a slant in its box. Ten real lumbar ones are 72 to 98 mm at the longest and 46 to 62 at the
/// shortest; the other regions' bounds are estimates. kNone: of any vertebra of the neck, the thorax or the lumbar
/// spine.
VertebraExtents vertebra_extents(Level level);

/// Throws Error where the mesh has not the size of a vertebra in mm, with its sizes, what was expected, and the unit in
/// which it would have that size.
void check_mesh_units(const TriangleMesh& mesh, Level level = Level::kNone);

/// The mesh with all coordinates times `scale`. Throws Error unless `scale` is above 0 and finite.
TriangleMesh scaled_mesh(const TriangleMesh& mesh, double scale);

/// What a surface file does not say of itself.
struct VertebraMeshOptions {
  std::optional<double> scale = std::nullopt;  ///< to mm; without it the mesh must have the size of a vertebra in mm
  std::optional<std::string> axes =
      std::nullopt;            ///< along which it lies, as "RAS"; without it, LPS, and that is checked
  Level level = Level::kNone;  ///< which vertebra it is, for its size
};

struct VertebraMesh {
  TriangleMesh mesh;                  ///< patient LPS, mm
  std::vector<std::string> warnings;  ///< a line each
};

/// A mesh made one of patient LPS, mm. What the options say is believed; what they leave out is checked by
/// check_mesh_units() and check_mesh_axes(), which throw Error.
VertebraMesh to_vertebra_mesh(const TriangleMesh& mesh, const VertebraMeshOptions& options = {});

/// The same of a file that read_mesh() reads. An Error of the checks names the file.
VertebraMesh read_vertebra_mesh(const std::filesystem::path& path, const VertebraMeshOptions& options = {});

}  // namespace spinaltap
