#pragma once

#include <vtkActor.h>
#include <vtkNew.h>
#include <vtkPolyDataMapper.h>

#include <QColor>

#include "core/tool/drill_bit.h"

namespace spinaltap {

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
