#include "mesh/mesh_axes.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>

#include "core/anatomy/body_landmarks.h"
#include "core/anatomy/bone_shape.h"
#include "core/anatomy/canal_search.h"
#include "core/anatomy/surface_sample.h"
#include "core/base/error.h"
#include "core/base/text_writer.h"
#include "mesh/vertebra_mesh.h"
#include "vdb/grid/mesh_solid.h"

namespace spinaltap {
namespace {

/// From half of this on the axes are sure: ten real lumbar vertebrae drop by 0.22 to 0.31.
constexpr double kSureDrop = 0.2;
constexpr double kSure = 0.5;

std::optional<Vec3> side_of(char letter) {
  switch (letter) {
    case 'L':
      return Vec3::UnitX();
    case 'R':
      return -Vec3::UnitX();
    case 'P':
      return Vec3::UnitY();
    case 'A':
      return -Vec3::UnitY();
    case 'S':
      return Vec3::UnitZ();
    case 'I':
      return -Vec3::UnitZ();
    default:
      return std::nullopt;
  }
}

std::array<std::string, 24> make_right_handed_axes() {
  std::array<std::string, 24> all{};
  std::size_t count = 0;
  constexpr std::string_view kLetters = "LPSRAI";
  for (const char x : kLetters) {
    for (const char y : kLetters) {
      for (const char z : kLetters) {
        Mat3 columns;
        columns << *side_of(x), *side_of(y), *side_of(z);
        if (columns.determinant() > 0.5) all[count++] = {x, y, z};
      }
    }
  }
  return all;
}

double signed_volume_mm3(const TriangleMesh& mesh) {
  double sum = 0.0;
  const Vec3 near_mm = mesh.vertices_mm.front().cast<double>();
  for (const auto& t : mesh.triangles) {
    const auto corner = [&](std::size_t n) -> Vec3 { return mesh.vertices_mm[t[n]].cast<double>() - near_mm; };
    sum += corner(0).dot(corner(1).cross(corner(2)));
  }
  return sum / 6.0;
}

/// The widest canal seen along x, y or z of a bone of which `points_mm` times `scale` is the surface.
std::optional<CanalView> widest_canal(const std::vector<Vec3>& points_mm, double scale) {
  constexpr double kCellMm = 1.0;
  SurfaceSample surface;
  for (const std::size_t n : first_of_each_cell(points_mm, bounds_of(points_mm).min(), kCellMm / scale)) {
    surface.points_mm.push_back(scale * points_mm[n]);
  }
  std::optional<CanalView> widest;
  for (const char* axes : {"LPS", "SLP", "PSL"}) {
    const Mat3 turn = lps_from_axes(axes);
    SurfaceSample turned;
    for (const Vec3& p_mm : surface.points_mm) turned.points_mm.push_back(turn * p_mm);
    const std::optional<CanalView> canal = find_canal(turned);
    if (!canal || (widest && !(canal->radius_mm > widest->radius_mm))) continue;
    widest = CanalView{turn.transpose() * canal->point_mm, turn.transpose() * canal->axis, canal->radius_mm};
  }
  return widest;
}

class MeanHeight {
 public:
  void add(double height_mm) {
    sum_mm_ += height_mm;
    ++count_;
  }
  bool empty() const { return count_ == 0; }
  double mm() const { return sum_mm_ / static_cast<double>(count_); }

 private:
  double sum_mm_ = 0.0;
  std::size_t count_ = 0;
};

/// How much higher the bone beside the canal's front half lies, the pedicles, than that behind the canal's middle.
double arch_drop_mm(const BoneShape& bone, const CanalView& canal, const Mat3& axes) {
  const FloatGrid& lattice = bone.lattice();
  const auto& size = lattice.geometry.size;
  MeanHeight pedicles, back;
  for (int k = 0; k < size[2]; ++k) {
    for (int j = 0; j < size[1]; ++j) {
      for (int i = 0; i < size[0]; ++i) {
        if (!(lattice.at(i, j, k) < 0.0F)) continue;
        const Vec3 from_canal_mm = lattice.geometry.to_patient(Vec3(i, j, k)) - canal.point_mm;
        const double height_mm = axes.col(2).dot(from_canal_mm);
        const Vec3 on_canal_mm = height_mm / canal.axis.dot(axes.col(2)) * canal.axis;
        const double behind_mm = axes.col(1).dot(from_canal_mm - on_canal_mm);
        if (behind_mm > 0.0) {
          back.add(height_mm);
        } else if (behind_mm > -canal.radius_mm) {
          pedicles.add(height_mm);
        }
      }
    }
  }
  if (pedicles.empty() || back.empty()) fail("mesh axes: no arch behind the canal; expected a whole vertebra");
  return pedicles.mm() - back.mm();
}

/// The right-handed axes that lie nearest to the vertebra's.
std::string nearest_axes(const Mat3& vertebra) {
  const std::array<std::string, 24>& all = right_handed_axes();
  return *std::max_element(all.begin(), all.end(), [&](const std::string& a, const std::string& b) {
    return (lps_from_axes(a) * vertebra).trace() < (lps_from_axes(b) * vertebra).trace();
  });
}

std::string side_name(const Vec3& direction) {
  Eigen::Index axis = 0;
  direction.cwiseAbs().maxCoeff(&axis);
  return std::string(direction[axis] > 0.0 ? "+" : "-") + "xyz"[axis];
}

}  // namespace

Mat3 lps_from_axes(std::string_view axes) {
  Mat3 turn = Mat3::Zero();
  bool known = axes.size() == 3;
  for (std::size_t n = 0; known && n < 3; ++n) {
    const std::optional<Vec3> side = side_of(axes[n]);
    known = side.has_value();
    if (known) turn.col(static_cast<Eigen::Index>(n)) = *side;
  }
  if (!known || std::abs(turn.determinant()) < 0.5) {
    fail("axes: expected three letters as RAS or LPS, one each of L or R, P or A and S or I, found \"", axes, "\"");
  }
  return turn;
}

const std::array<std::string, 24>& right_handed_axes() {
  static const std::array<std::string, 24> all = make_right_handed_axes();
  return all;
}

TriangleMesh turn_axes(const TriangleMesh& mesh, std::string_view axes) {
  const Eigen::Matrix3f turn = lps_from_axes(axes).cast<float>();
  TriangleMesh turned = mesh;
  for (Eigen::Vector3f& p : turned.vertices_mm) p = Eigen::Vector3f(turn * p);
  if (turn.determinant() < 0.0F) {
    for (auto& t : turned.triangles) std::swap(t[1], t[2]);
  }
  return turned;
}

MeshAxes find_mesh_axes(const TriangleMesh& mesh) {
  // At half its size BoneShape's lattice is one of 1 mm: enough to tell sides apart, for an eighth of the work.
  constexpr double kShrink = 0.5, kVoxelMm = 0.4, kBandMm = 2.0;  // Solid promises a distance within 2 mm
  const std::shared_ptr<const Solid> solid = make_mesh_solid(scaled_mesh(mesh, kShrink), {.voxel_mm = kVoxelMm});
  const BoneShape bone(solid, solid->bounds_mm(), kBandMm);
  std::optional<CanalView> canal = widest_canal(bone.points_mm(), 1.0 / kShrink);
  if (!canal) {
    fail(
        "mesh axes: no canal: along none of x, y and z is there a way of 3 mm radius through the mesh; expected one "
        "whole vertebra, in mm");
  }
  MeshAxes found;
  found.canal_radius_mm = canal->radius_mm;
  canal->point_mm *= kShrink;
  canal->radius_mm *= kShrink;
  const Core core = find_core(bone);
  const Vec3 to_body_mm = core.centre_mm - canal->point_mm;
  const Vec3 level_mm = to_body_mm - to_body_mm.dot(canal->axis) * canal->axis;
  if (!(level_mm.norm() > canal->radius_mm)) fail("mesh axes: no body beside the canal; expected a whole vertebra");
  Mat3 axes;
  axes.col(1) = -level_mm.normalized();
  axes.col(2) = canal->axis;
  axes.col(0) = axes.col(1).cross(axes.col(2));
  // The endplates say better than the canal which heights are alike.
  Landmarks::Body body;
  constexpr int kRounds = 2;
  for (int round = 0; round < kRounds; ++round) {
    body = measure_body(bone, core.centre_mm, axes);
    axes.col(2) = (body.upper.normal - body.lower.normal).normalized();
    axes.col(0) = axes.col(1).cross(axes.col(2)).normalized();
    axes.col(1) = axes.col(2).cross(axes.col(0));
  }
  const double drop = arch_drop_mm(bone, *canal, axes) / body.height_mm;
  if (drop < 0.0) {
    axes.col(0) = -axes.col(0);
    axes.col(2) = -axes.col(2);
  }
  found.axes = nearest_axes(axes);
  found.drop = std::abs(drop);
  found.sureness = std::min(1.0, found.drop / kSureDrop);
  found.is_inside_out = signed_volume_mm3(mesh) < 0.0;
  found.left = axes.col(0);
  found.posterior = axes.col(1);
  found.superior = axes.col(2);
  return found;
}

std::vector<std::string> check_mesh_axes(const TriangleMesh& mesh) {
  const MeshAxes found = find_mesh_axes(mesh);
  std::vector<std::string> warnings;
  TextWriter text;
  if (found.axes != "LPS") {
    text << "the mesh does not lie along LPS (x left, y back, z up): its canal runs along "
         << side_name(found.superior).substr(1) << ", its back is at " << side_name(found.posterior)
         << " and its top at " << side_name(found.superior) << ": its axes look like " << found.axes
         << "; turn it from " << found.axes;
    if (found.sureness >= kSure) fail(text.str());
    warnings.push_back(text.str());
  }
  if (found.is_inside_out) {
    warnings.emplace_back(
        "the mesh's faces wind inward, as after mirroring along one axis: its left may be its right, which its shape "
        "does not show");
  }
  return warnings;
}

}  // namespace spinaltap
