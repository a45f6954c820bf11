#include "apps/spinaltap-planner/scene/tool_actor.h"

#include <vtkCellArray.h>
#include <vtkFloatArray.h>
#include <vtkMatrix4x4.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>
#include <vtkProperty.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "apps/spinaltap-planner/scene/surface_look.h"
#include "core/tool/bit_profile.h"
#include "core/tool/drill_path.h"
#include "core/tool/plate.h"

namespace spinaltap {
namespace {

constexpr int kAroundBit = 48;

/// A place of the outline and its normal, both as (along the axis, off it).
struct BitOutlinePoint {
  Eigen::Vector2d place_mm;
  Eigen::Vector2d normal;
};

class RevolvedBit {
 public:
  /// Turns a stretch of the outline about the axis; where stretches meet there is an edge.
  void add(const std::array<BitOutlinePoint, 2>& stretch) {
    const vtkIdType first = points_->GetNumberOfPoints();
    for (int n = 0; n <= kAroundBit; ++n) {
      const double angle = 2.0 * std::numbers::pi * n / kAroundBit;
      for (const BitOutlinePoint& point : stretch) {
        const auto turned = [&](const Eigen::Vector2d& v) {
          return std::array<double, 3>{v.y() * std::cos(angle), v.y() * std::sin(angle), v.x()};
        };
        points_->InsertNextPoint(turned(point.place_mm).data());
        normals_->InsertNextTuple(turned(point.normal).data());
      }
    }
    // Stretches run from the tip to the base, so that these wind outward.
    for (vtkIdType n = 0; n < kAroundBit; ++n) {
      const vtkIdType corner = first + 2 * n;
      const std::array<vtkIdType, 3> one{corner, corner + 1, corner + 2};
      const std::array<vtkIdType, 3> other{corner + 1, corner + 3, corner + 2};
      triangles_->InsertNextCell(3, one.data());
      triangles_->InsertNextCell(3, other.data());
    }
  }

  vtkSmartPointer<vtkPolyData> mesh() {
    auto mesh = vtkSmartPointer<vtkPolyData>::New();
    mesh->SetPoints(points_);
    mesh->GetPointData()->SetNormals(normals_);
    mesh->SetPolys(triangles_);
    return mesh;
  }

  RevolvedBit() { normals_->SetNumberOfComponents(3); }

 private:
  vtkNew<vtkPoints> points_;
  vtkNew<vtkFloatArray> normals_;
  vtkNew<vtkCellArray> triangles_;
};

void add_bit_piece(const ProfilePiece& piece, RevolvedBit& mesh) {
  const bool is_ball = piece.ball_radius_mm > 0.0;
  const int steps = is_ball ? 16 : 1;
  const double length_mm = piece.end_mm - piece.begin_mm;
  const double widening = (piece.end_radius_mm - piece.begin_radius_mm) / length_mm;
  const auto outline = [&](int n) -> BitOutlinePoint {
    // Even angles around a ball.
    const double share = steps == 1 ? n : 0.5 - 0.5 * std::cos(std::numbers::pi * n / steps);
    const double back_mm = piece.begin_mm + share * length_mm;
    const double radius_mm = std::sqrt(std::max(0.0, piece.radius_squared_mm2(back_mm)));
    const Eigen::Vector2d normal =
        is_ball ? Eigen::Vector2d(piece.ball_centre_mm - back_mm, radius_mm) : Eigen::Vector2d(widening, 1.0);
    return {{-back_mm, radius_mm}, normal.normalized()};
  };
  for (int n = 0; n < steps; ++n) mesh.add({outline(n), outline(n + 1)});
}

/// The flat ring between two radii at one place: an end, or a step of the outline.
void add_bit_ring(double back_mm, double from_radius_mm, double to_radius_mm, RevolvedBit& mesh) {
  constexpr double kStepMm = 1e-6;
  if (std::abs(from_radius_mm - to_radius_mm) < kStepMm) return;
  const Eigen::Vector2d normal(from_radius_mm < to_radius_mm ? 1.0 : -1.0, 0.0);
  mesh.add({BitOutlinePoint{{-back_mm, from_radius_mm}, normal}, BitOutlinePoint{{-back_mm, to_radius_mm}, normal}});
}

/// A plate's six faces, each with corners and normals of its own: its width along x, its thickness along y.
vtkSmartPointer<vtkPolyData> plate_mesh(const PlateBox& plate) {
  vtkNew<vtkPoints> points;
  vtkNew<vtkFloatArray> normals;
  vtkNew<vtkCellArray> faces;
  normals->SetNumberOfComponents(3);
  // From z back from the edge to z along the axis.
  const Vec3 low(plate.low_mm().x(), plate.low_mm().y(), -plate.high_mm().z());
  const Vec3 high(plate.high_mm().x(), plate.high_mm().y(), -plate.low_mm().z());
  for (int axis = 0; axis < 3; ++axis) {
    for (const double sign : {-1.0, 1.0}) {
      const Vec3 normal = sign * Vec3::Unit(axis);
      const Vec3 u = Vec3::Unit((axis + 1) % 3), v = normal.cross(u);
      std::array<vtkIdType, 4> corners{};
      for (std::size_t n = 0; n < corners.size(); ++n) {
        constexpr std::array<std::array<double, 2>, 4> kAround{{{-1, -1}, {1, -1}, {1, 1}, {-1, 1}}};
        const Vec3 towards = normal + kAround[n][0] * u + kAround[n][1] * v;
        const Vec3 corner = (towards.array() > 0.0).select(high.array(), low.array());
        corners[n] = points->InsertNextPoint(corner.data());
        normals->InsertNextTuple(normal.data());
      }
      faces->InsertNextCell(4, corners.data());
    }
  }
  auto mesh = vtkSmartPointer<vtkPolyData>::New();
  mesh->SetPoints(points);
  mesh->GetPointData()->SetNormals(normals);
  mesh->SetPolys(faces);
  return mesh;
}

}  // namespace

vtkSmartPointer<vtkPolyData> bit_mesh(const DrillBit& bit) {
  if (bit.is_plate()) return plate_mesh(PlateBox(bit));
  const BitProfile profile(bit);
  RevolvedBit mesh;
  double radius_mm = 0.0;
  for (const ProfilePiece& piece : profile.pieces()) {
    if (!(piece.end_mm > piece.begin_mm)) continue;
    add_bit_ring(piece.begin_mm, radius_mm, std::sqrt(std::max(0.0, piece.radius_squared_mm2(piece.begin_mm))), mesh);
    add_bit_piece(piece, mesh);
    radius_mm = std::sqrt(std::max(0.0, piece.radius_squared_mm2(piece.end_mm)));
  }
  add_bit_ring(profile.length_mm(), radius_mm, 0.0, mesh);
  return mesh.mesh();
}

vtkSmartPointer<vtkMatrix4x4> matrix_of(const Pose& pose) {
  auto matrix = vtkSmartPointer<vtkMatrix4x4>::New();
  if (!pose.side.isZero()) {
    const std::array<Vec3, 4> columns{pose.side, pose.axis.cross(pose.side), pose.axis, pose.tip_mm};
    for (int column = 0; column < 4; ++column) {
      for (int row = 0; row < 3; ++row) matrix->SetElement(row, column, columns[static_cast<std::size_t>(column)][row]);
    }
    return matrix;
  }
  const PathFrame frame(pose.tip_mm, pose.axis);
  for (int column = 0; column < 4; ++column) {
    const Vec3 place = frame.to_patient(column < 3 ? Vec3(Vec3::Unit(column)) : Vec3(Vec3::Zero()));
    for (int row = 0; row < 3; ++row) {
      matrix->SetElement(row, column, column < 3 ? place[row] - pose.tip_mm[row] : place[row]);
    }
  }
  return matrix;
}

ToolActor::ToolActor() {
  actor_->SetMapper(mapper_);
  actor_->GetProperty()->BackfaceCullingOn();
  actor_->VisibilityOff();
  light_softly(*actor_);
}

void ToolActor::show(const DrillBit& bit, const Pose& pose) {
  mapper_->SetInputData(bit_mesh(bit));
  // A pose that is not sound shows a body of revolution anywhere, a plate turned anyhow.
  actor_->SetUserMatrix(matrix_of(valid_pose(pose, bit).value_or(pose)));
  actor_->VisibilityOn();
}

void ToolActor::set_colour(const QColor& colour) {
  actor_->GetProperty()->SetColor(colour.redF(), colour.greenF(), colour.blueF());
}

}  // namespace spinaltap
