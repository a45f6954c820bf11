#include "apps/spinaltap-planner/scene/surface_look.h"

#include <vtkActor.h>
#include <vtkShaderProperty.h>
#include <Eigen/Core>

#include <algorithm>
#include <cmath>
#include <string>

#include "core/base/hu_colour.h"

namespace spinaltap {
namespace {

/// In view coordinates: x to the right, y up, z to the eye. The colours are those of the vertices or the property, and
/// already brightened by the power of 1 / 1.6 that render_bone() ends with; so must the light be.
const std::string kLight =
    "  vec3 key = normalize(vec3(-0.5, 0.6, 1.0));\n"
    "  vec3 fill = normalize(vec3(0.8, -0.3, 1.0));\n"
    "  float light = 0.28 + 0.62 * max(0.0, dot(normalVCVSOutput, key)) + 0.18 * max(0.0, dot(normalVCVSOutput, "
    "fill));\n"
    "  vec3 lit = min(diffuseColor * pow(light, 0.625), vec3(1.0));\n";

void set_light(vtkActor& actor, const std::string& code) {
  vtkShaderProperty* shader = actor.GetShaderProperty();
  shader->ClearAllFragmentShaderReplacements();
  shader->AddFragmentShaderReplacement("//VTK::Light::Impl", true, kLight + code, false);
}

/// Pictures of render_bone() are drawn in linear light and then brightened so.
constexpr double kBrightening = 1.0 / 1.6;

std::array<std::uint8_t, 3> bytes_of(const Eigen::Array3d& linear) {
  std::array<std::uint8_t, 3> bytes{};
  for (std::size_t n = 0; n < 3; ++n) {
    const double value = std::pow(linear[static_cast<Eigen::Index>(n)], kBrightening);
    bytes[n] = static_cast<std::uint8_t>(std::lround(255.0 * std::clamp(value, 0.0, 1.0)));
  }
  return bytes;
}

/// Which vertices are of drilled walls.
std::vector<bool> walls_of(const SurfaceBlock& block) {
  std::vector<bool> is_wall(block.vertices_mm.size(), false);
  for (std::size_t n = block.wall_begin; n < block.triangles.size(); ++n) {
    for (const std::uint16_t corner : block.triangles[n]) is_wall[corner] = true;
  }
  return is_wall;
}

std::vector<float> distances_mm(const BoneModel& bone, const std::vector<Vec3>& places_mm) {
  std::vector<float> distances(places_mm.size());
  bone.distance(places_mm, distances, {});
  return distances;
}

/// How open it is around places of the surface: of the ways straight up, the share that lies free.
std::vector<double> openness(const BoneModel& bone, const std::vector<Vec3>& places_mm,
                             const std::vector<Vec3>& normals) {
  constexpr int kSteps = 4;
  std::vector<double> open(places_mm.size(), 1.0);
  std::vector<Vec3> above_mm(places_mm.size());
  for (int step = 1; step <= kSteps; ++step) {
    const double way_mm = 0.7 * step * bone.voxel_mm();
    for (std::size_t n = 0; n < above_mm.size(); ++n) above_mm[n] = places_mm[n] + way_mm * normals[n];
    const std::vector<float> free_mm = distances_mm(bone, above_mm);
    for (std::size_t n = 0; n < above_mm.size(); ++n) {
      open[n] -= 0.6 / kSteps * std::max(0.0, way_mm - static_cast<double>(free_mm[n])) / way_mm;
    }
  }
  return open;
}

/// Close to the bone's surface the CT holds what is outside too: there it is that of a little deeper.
std::vector<float> wall_hu(const BoneModel& bone, std::vector<Vec3> places_mm) {
  const std::vector<float> distances = distances_mm(bone, places_mm);
  std::vector<Vec3> normals(places_mm.size());
  bone.normals(places_mm, normals);
  for (std::size_t n = 0; n < places_mm.size(); ++n) {
    const double missing_mm = 1.5 * bone.voxel_mm() + static_cast<double>(distances[n]);
    if (missing_mm > 0.0) places_mm[n] -= missing_mm * normals[n];
  }
  std::vector<float> hu(places_mm.size());
  bone.hu(places_mm, hu, {});
  return hu;
}

}  // namespace

void light_softly(vtkActor& actor) { set_light(actor, "  gl_FragData[0] = vec4(lit, opacity);\n"); }

void light_as_glass(vtkActor& actor) {
  set_light(actor,
            "  float facing = abs(normalVCVSOutput.z);\n"
            "  float edge = 1.0 - facing;\n"
            "  gl_FragData[0] = vec4(min(1.2 * lit, vec3(1.0)), opacity * (0.4 + 1.4 * edge * edge));\n");
}

std::vector<std::array<std::uint8_t, 3>> surface_colours(const BoneModel& bone, const SurfaceBlock& block) {
  const Eigen::Array3d kBone(0.94, 0.89, 0.79);
  const std::vector<bool> is_wall = walls_of(block);
  std::vector<Vec3> wall_mm, outer_mm, normals;
  for (std::size_t n = 0; n < is_wall.size(); ++n) {
    (is_wall[n] ? wall_mm : outer_mm).push_back(block.vertices_mm[n].cast<double>());
    if (!is_wall[n]) normals.push_back(block.normals[n].cast<double>());
  }
  const std::vector<float> hu = wall_hu(bone, std::move(wall_mm));
  const std::vector<double> open = openness(bone, outer_mm, normals);
  std::vector<std::array<std::uint8_t, 3>> colours;
  colours.reserve(is_wall.size());
  auto next_hu = hu.begin();
  auto next_open = open.begin();
  for (const bool wall : is_wall) {
    colours.push_back(
        bytes_of(wall ? hu_colour(static_cast<double>(*next_hu++)) : Eigen::Array3d(kBone * *next_open++)));
  }
  return colours;
}

}  // namespace spinaltap
