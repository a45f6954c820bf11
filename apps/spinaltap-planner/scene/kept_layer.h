#pragma once

#include <vtkNew.h>

#include "apps/spinaltap-planner/scene/vtk_names.h"

namespace spinaltap {

/// Colours and depths of what a frame has drawn so far, kept on the graphics card, for later frames to begin with. For
/// use while a frame is drawn.
class KeptLayer {
 public:
  KeptLayer();
  ~KeptLayer();
  KeptLayer(const KeptLayer&) = delete;
  KeptLayer& operator=(const KeptLayer&) = delete;

  void keep(vtkOpenGLRenderWindow& window);
  /// Into a window of the same size.
  void put_back(vtkOpenGLRenderWindow& window);
  /// Before the window goes.
  void release(vtkOpenGLRenderWindow& window);

 private:
  vtkNew<vtkOpenGLFramebufferObject> kept_;
};

}  // namespace spinaltap
