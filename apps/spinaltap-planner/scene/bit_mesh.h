#pragma once

#include <vtkSmartPointer.h>

#include "core/tool/drill_bit.h"

#include "apps/spinaltap-planner/scene/vtk_names.h"

namespace spinaltap {

/// The body that the turning bit fills, with normals; its tip at the origin, its axis along z.
vtkSmartPointer<vtkPolyData> bit_mesh(const DrillBit& bit);

/// Brings bit_mesh() to a pose (patient LPS, mm).
vtkSmartPointer<vtkMatrix4x4> matrix_of(const Pose& pose);

}  // namespace spinaltap
