#include "apps/spinaltap-planner/scene/tool_actor.h"

#include <gtest/gtest.h>
#include <vtkMassProperties.h>
#include <vtkMatrix4x4.h>
#include <vtkPointData.h>
#include <vtkPolyData.h>
#include <vtkTriangleFilter.h>

namespace spinaltap {
namespace {

TEST(ToolActor, OfAPlateIsItsBoxFacingOutward) {
  const auto mesh = bit_mesh(plate_bit(10.0, 1.2, 60.0));
  std::array<double, 6> bounds{};
  mesh->GetBounds(bounds.data());
  const std::array<double, 6> expected{-5.0, 5.0, -0.6, 0.6, -60.0, 0.0};
  for (std::size_t n = 0; n < bounds.size(); ++n) EXPECT_NEAR(bounds[n], expected[n], 1e-5) << n;
  ASSERT_EQ(mesh->GetNumberOfCells(), 6);
  vtkDataArray* normals = mesh->GetPointData()->GetNormals();
  for (vtkIdType n = 0; n < 6; ++n) {
    vtkIdType count = 0;
    const vtkIdType* corners = nullptr;
    mesh->GetCellPoints(n, count, corners);
    ASSERT_EQ(count, 4);
    std::array<Vec3, 4> at;
    for (std::size_t k = 0; k < at.size(); ++k) mesh->GetPoint(corners[k], at[k].data());
    const Vec3 winding = (at[1] - at[0]).cross(at[2] - at[0]).normalized();
    const Vec3 middle = 0.25 * (at[0] + at[1] + at[2] + at[3]) + Vec3(0.0, 0.0, 30.0);
    Vec3 normal;
    normals->GetTuple(corners[0], normal.data());
    EXPECT_NEAR(winding.dot(normal), 1.0, 1e-6);
    EXPECT_GT(winding.dot(middle), 0.5);
  }
  vtkNew<vtkTriangleFilter> triangles;
  triangles->SetInputData(mesh);
  vtkNew<vtkMassProperties> mass;
  mass->SetInputConnection(triangles->GetOutputPort());
  EXPECT_NEAR(mass->GetVolume(), 10.0 * 1.2 * 60.0, 0.01);
}

TEST(ToolActor, OfAPlateLiesAlongItsSide) {
  const Vec3 axis = Vec3(0.3, -0.8, 0.4).normalized(), side = axis.cross(Vec3::UnitZ()).normalized();
  const Vec3 tip_mm(3.0, 4.0, 5.0);
  const auto matrix = matrix_of({tip_mm, axis, side});
  const auto moved = [&](const Vec3& p) {
    const std::array<double, 4> from{p.x(), p.y(), p.z(), 1.0};
    std::array<double, 4> to{};
    matrix->MultiplyPoint(from.data(), to.data());
    return Vec3(to[0], to[1], to[2]);
  };
  EXPECT_LT((moved(Vec3(2.0, 0.0, -7.0)) - (tip_mm + 2.0 * side - 7.0 * axis)).norm(), 1e-12);
  EXPECT_LT((moved(Vec3(0.0, 0.5, 0.0)) - (tip_mm + 0.5 * axis.cross(side))).norm(), 1e-12);
  EXPECT_NEAR(matrix->Determinant(), 1.0, 1e-12);
}

}  // namespace
}  // namespace spinaltap
