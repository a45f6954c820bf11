#include "apps/spinaltap-planner/scene/scene_view.h"

#include <QLabel>
#include <QStackedLayout>
#include <QTimer>

#include "apps/report/picture_view.h"
#include "apps/spinaltap-planner/scene/bone_chunks.h"
#include "apps/spinaltap-planner/scene/guide_planes.h"
#include "apps/spinaltap-planner/scene/path_actors.h"
#include "apps/spinaltap-planner/scene/path_handles.h"
#include "apps/spinaltap-planner/scene/scene_camera.h"
#include "apps/spinaltap-planner/scene/scene_interaction.h"
#include "apps/spinaltap-planner/scene/scene_pane.h"
#include "apps/spinaltap-planner/scene/scene_stage.h"

namespace spinaltap {

struct SceneView::Scene {
  PlanDocument& document;
  ViewState& state;
  QStackedLayout* pages;
  QLabel* hint;
  ScenePane* pane;
  QTimer next_frame;
  QTimer at_rest;
  SceneCamera camera;
  SceneInteraction interaction;
  SceneStage stage;
  BoneChunks bone;
  PathActors paths;
  PathHandles handles;
  GuidePlanes guides;
  std::optional<std::pair<DrillBit, Pose>> bit;
  bool are_paths_changed = true;
  std::vector<SurfaceUpdate> updates;  ///< since the last frame
  bool is_stale = true;                ///< what the pane shows, or will once its frame is drawn
  bool is_awaited = false;             ///< another frame, once this one is drawn
  int begun = 0;                       ///< frames

  Scene(SceneView& view, PlanDocument& plan, ViewState& view_state)
      : document(plan),
        state(view_state),
        pages(new QStackedLayout(&view)),
        hint(new QLabel(&view)),
        pane(new ScenePane(&view)),
        interaction(*pane, camera, document, state),
        bone(stage.bone()),
        paths(stage.scene(), stage.front()),
        handles(stage.front()),
        guides(stage.scene()) {
    hint->setAlignment(Qt::AlignCenter);
    hint->setWordWrap(true);  // the pane may be narrower than the words
    hint->setStyleSheet("background: #2b323b; color: #aeb8c4;");
    pages->addWidget(hint);
    pages->addWidget(pane);
    next_frame.setSingleShot(true);
    QObject::connect(&next_frame, &QTimer::timeout, pane, [this] { draw(false); });
    at_rest.setSingleShot(true);
    QObject::connect(&at_rest, &QTimer::timeout, pane, [this] {
      // A smooth frame takes so long that a drag's next one would be late.
      if (!interaction.is_dragging()) draw(true);
    });
  }

  const OpenedBone* opened() const { return document.bone().get(); }

  ~Scene() {
    if (stage.is_drawing()) stage.finish();
  }
  Scene(const Scene&) = delete;
  Scene& operator=(const Scene&) = delete;

  void draw_soon() {
    is_stale = true;
    if (pane->isVisible()) next_frame.start(0);
  }

  /// Quickly while things change, smoothly once they rest. While a frame is drawn, once that is done.
  void draw(bool is_smooth) {
    next_frame.stop();
    at_rest.stop();
    const QSize device_px = pane->size() * pane->devicePixelRatioF();
    if (opened() == nullptr || device_px.isEmpty()) return;
    is_awaited = stage.is_drawing();
    if (is_awaited) return;
    prepare();
    is_stale = !is_smooth;
    stage.begin(device_px, is_smooth, [this, frame = ++begun] {
      QMetaObject::invokeMethod(
          pane,
          [this, frame] {
            if (frame == begun) take_frame();
          },
          Qt::QueuedConnection);
    });
  }

  /// Shows the frame that is drawn, if any, and waits for it where it must.
  void take_frame() {
    constexpr int kRestMs = 180;
    if (!stage.is_drawing()) return;
    pane->show_frame(stage.finish());
    if (is_awaited) {
      draw_soon();
    } else if (is_stale) {
      at_rest.start(kRestMs);
    }
    is_awaited = false;
  }

  /// Brings what is drawn up to date with plan and view.
  void prepare() {
    const double ratio = pane->devicePixelRatioF();
    if (are_paths_changed) paths.set_paths(document.paths(), document.chosen(), bit, state.shows_tools());
    are_paths_changed = false;
    bone.update(updates);
    updates.clear();
    bone.set_opacity(state.bone_opacity());
    if (bone.prepare()) stage.change_bone(bone.is_glass());
    guides.prepare(document.bone(), state, ratio);
    paths.prepare(camera, pane->height(), ratio);
    // While a bit drills, they would hide the hole.
    handles.prepare(bit ? std::vector<DrillPath>() : document.paths(), document.chosen(), interaction.hot(), camera);
    stage.look(camera, reach_mm(), pane->size());
  }

  /// From the focus to all that may be drawn.
  double reach_mm() const {
    constexpr double kToolsMm = 120.0;  // that stand out of the bone
    const Box3 bounds_mm = opened()->model().bounds_mm();
    return (bounds_mm.center() - camera.focus_mm()).norm() + 0.5 * bounds_mm.sizes().norm() + kToolsMm;
  }

  void open_bone() {
    take_frame();
    updates.clear();
    bone.set_bone(opened() == nullptr ? nullptr : &opened()->model());
    bit.reset();
    hint->setText(document.opened() == nullptr
                      ? tr("Open a CT or a bone to see it here")
                      : tr("No bone yet: choose one on the page CT, or put the crosshair into a vertebral body "
                           "and press Ctrl+B"));
    interaction.offer_handles(true);
    pages->setCurrentWidget(opened() == nullptr ? static_cast<QWidget*>(hint) : pane);
    if (opened() != nullptr) bone.update(opened()->surface);
  }
};

SceneView::SceneView(PlanDocument& document, ViewState& state, QWidget* parent)
    : QWidget(parent), scene_(std::make_unique<Scene>(*this, document, state)) {
  Scene& scene = *scene_;
  setFocusProxy(scene.pane);
  const auto draw_soon = [&scene] { scene.draw_soon(); };
  const auto draw_paths_soon = [&scene] {
    scene.are_paths_changed = true;
    scene.draw_soon();
  };
  connect(&document, &PlanDocument::bone_changed, this, [this] {
    scene_->open_bone();
    look_from("behind");
  });
  connect(&document, &PlanDocument::paths_changed, this, draw_paths_soon);
  connect(&document, &PlanDocument::chosen_changed, this, draw_paths_soon);
  connect(&state, &ViewState::crosshair_changed, this, draw_soon);
  connect(&state, &ViewState::window_changed, this, draw_soon);
  connect(&state, &ViewState::scene_changed, this, draw_paths_soon);
  connect(&scene.interaction, &SceneInteraction::camera_changed, this, draw_soon);
  connect(&scene.interaction, &SceneInteraction::hot_changed, this, draw_soon);
  connect(&scene.interaction, &SceneInteraction::drag_ended, this, draw_soon);
  connect(&scene.interaction, &SceneInteraction::view_asked, this,
          [this](const QString& name) { name.isEmpty() ? show_all() : look_from(name); });
  scene.open_bone();
  look_from("behind");
}

SceneView::~SceneView() = default;

void SceneView::update_surface(std::span<const SurfaceUpdate> updates) {
  scene_->updates.insert(scene_->updates.end(), updates.begin(), updates.end());
  scene_->draw_soon();
}

void SceneView::set_bit(const std::optional<std::pair<DrillBit, Pose>>& bit) {
  scene_->bit = bit;
  scene_->interaction.offer_handles(!bit.has_value());
  scene_->are_paths_changed = true;
  scene_->draw_soon();
}

void SceneView::look_from(const QString& name) {
  const DrillPath* path = scene_->document.chosen_path();
  const bool is_hole = name == "hole";
  if (scene_->opened() == nullptr || (is_hole && path == nullptr)) return;
  const PictureView view = named_view(name.toStdString(), path, scene_->opened()->model());
  scene_->camera.look_from(view.from, view.up);
  if (!is_hole) return show_all();
  const Vec3 kNear = Vec3::Constant(7.0);  // mm around the entry
  scene_->camera.show(Box3(path->entry_mm - kNear, path->entry_mm + kNear));
  scene_->draw_soon();
}

void SceneView::show_all() {
  if (scene_->opened() == nullptr) return;
  scene_->camera.show(scene_->opened()->model().bounds_mm());
  scene_->draw_soon();
}

QImage SceneView::picture() {
  if (scene_->opened() == nullptr) return grab().toImage();
  scene_->take_frame();
  if (scene_->is_stale) scene_->draw(true);
  scene_->take_frame();
  return scene_->pane->frame();
}

QPointF SceneView::to_pixel(const Vec3& p_mm) const {
  const Eigen::Vector2d pixel = scene_->camera.to_pixel(p_mm);
  return {pixel.x(), pixel.y()};
}

int SceneView::frames() const { return scene_->stage.frames(); }

void SceneView::showEvent(QShowEvent* event) {
  QWidget::showEvent(event);
  scene_->draw_soon();
}

void SceneView::resizeEvent(QResizeEvent* event) {
  QWidget::resizeEvent(event);
  scene_->camera.set_size(width(), height());
  scene_->draw_soon();
}

}  // namespace spinaltap
