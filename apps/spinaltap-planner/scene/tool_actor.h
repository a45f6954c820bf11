#pragma once

#include <vtkActor.h>
#include <vtkNew.h>
#include <vtkPolyDataMapper.h>
#include <vtkSmartPointer.h>
#include <QColor>

#include "apps/spinaltap-planner/scene/vtk_names.h"
#include "core/tool/drill_bit.h"

namespace spinaltap {

/// The body that the turning bit fills, or a plate, with normals; its tip at the origin, its axis along z, a plate's
/// width along x.
vtkSmartPointer<vtkPolyData> bit_mesh(const DrillBit& bit);

/// Brings bit_mesh() to a pose (patient LPS, mm).
vtkSmartPointer<vtkMatrix4x4> matrix_of(const Pose& pose);

/// A bit's or a screw's body where it stands.
class ToolActor {
 public:
  ToolActor();

  void show(const DrillBit& bit, const Pose& pose);
  void set_colour(const QColor& colour);
  vtkActor* actor() { return actor_; }

 private:
  vtkNew<vtkPolyDataMapper> mapper_;
  vtkNew<vtkActor> actor_;
};

}  // namespace spinaltap
