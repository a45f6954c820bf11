#pragma once

#include "apps/spinaltap-planner/scene/vtk_names.h"

namespace spinaltap {

/// Has an actor lit as render_bone() lights: a lamp to the upper left before the eye, a weaker one to the right, both
/// sides of a surface alike. One cheap shader for all, which processors draw quickly.
void light_softly(vtkActor& actor);

/// The same, for a shell one looks through: clearest where it is seen straight on, so that its outlines stand out.
void light_as_glass(vtkActor& actor);

}  // namespace spinaltap
