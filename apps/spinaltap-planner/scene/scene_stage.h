#pragma once

#include <vtkNew.h>
#include <QImage>
#include <QSize>

#include <functional>
#include <future>
#include <memory>

#include "apps/spinaltap-planner/scene/scene_camera.h"
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

class OrientationMarker;

/// What frames are drawn on: layers for the bone, for what stands in and around it, and for what shows through
/// everything, and the marker in the corner. A bone that is not glass is drawn only where it or the eye changed.
/// Nothing of it is on the screen: frames come as pictures, drawn on a thread of their own, so that nothing else waits
/// for them. While a frame is drawn, nothing that is drawn may be changed.
class SceneStage {
 public:
  SceneStage();
  ~SceneStage();
  SceneStage(const SceneStage&) = delete;
  SceneStage& operator=(const SceneStage&) = delete;

  vtkRenderer& bone() { return *bone_; }
  vtkRenderer& scene() { return *scene_; }
  vtkRenderer& front() { return *front_; }
  /// `reach_mm`: how far from the focus there is anything; `size_px`: of the pane, as the camera counts.
  void look(const SceneCamera& camera, double reach_mm, const QSize& size_px);
  /// What the bone's layer shows is no longer what it was. `is_glass`: what lies behind it shines through.
  void change_bone(bool is_glass);
  /// Begins a frame of so many device pixels; none may be begun yet. `is_smooth`: edges without steps, which takes a
  /// third longer on a processor. `on_done` is called on the other thread.
  void begin(const QSize& device_px, bool is_smooth, std::function<void()> on_done);
  bool is_drawing() const { return frame_.valid(); }
  /// The frame that was begun, waited for.
  QImage finish();
  int frames() const { return frames_; }

 private:
  QImage draw(const QSize& device_px);

  void set_layers();

  vtkNew<vtkRenderWindow> window_;
  vtkNew<vtkRenderer> bone_;
  vtkNew<vtkRenderer> scene_;
  vtkNew<vtkRenderer> front_;
  vtkNew<vtkCamera> eye_;  ///< of all layers
  std::unique_ptr<OrientationMarker> marker_;
  KeptLayer kept_bone_;
  bool is_bone_kept_ = false;
  bool is_glass_ = false;
  QSize size_px_;  ///< of the last frame
  int frames_ = 0;
  std::future<QImage> frame_;
};

}  // namespace spinaltap
