#include "apps/spinaltap-planner/scene/tool_actor.h"

#include <vtkMatrix4x4.h>
#include <vtkPolyData.h>
#include <vtkProperty.h>

#include "apps/spinaltap-planner/scene/bit_mesh.h"
#include "apps/spinaltap-planner/scene/lit_surface.h"

namespace spinaltap {

ToolActor::ToolActor() {
  actor_->SetMapper(mapper_);
  actor_->GetProperty()->BackfaceCullingOn();
  actor_->VisibilityOff();
  light_softly(*actor_);
}

void ToolActor::show(const DrillBit& bit, const Pose& pose) {
  mapper_->SetInputData(bit_mesh(bit));
  actor_->SetUserMatrix(matrix_of(pose));
  actor_->VisibilityOn();
}

void ToolActor::set_colour(const QColor& colour) {
  actor_->GetProperty()->SetColor(colour.redF(), colour.greenF(), colour.blueF());
}

}  // namespace spinaltap
