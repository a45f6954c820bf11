#include "apps/spinaltap-planner/slices/slice_view.h"

#include <QPainter>

#include "apps/report/slice_figure.h"
#include "apps/spinaltap-planner/colours.h"
#include "apps/spinaltap-planner/slices/pane_geometry.h"
#include "apps/spinaltap-planner/slices/pane_marks.h"
#include "apps/spinaltap-planner/slices/path_marks.h"
#include "core/base/error.h"

namespace spinaltap {
namespace {

/// Not of SliceKind::down_path.
Plane plane_of_kind(SliceKind kind) {
  return kind == SliceKind::axial ? Plane::kAxial : kind == SliceKind::coronal ? Plane::kCoronal : Plane::kSagittal;
}

QString name_of_kind(SliceKind kind) {
  switch (kind) {
    case SliceKind::axial:
      return SliceView::tr("Axial");
    case SliceKind::coronal:
      return SliceView::tr("Coronal");
    case SliceKind::sagittal:
      return SliceView::tr("Sagittal");
    case SliceKind::down_path:
      return SliceView::tr("Down the path");
  }
  fail("unknown kind of slice");
}

bool is_drawable(const DrillBit& bit, const Pose& pose) {
  if (!pose.tip_mm.allFinite() || !pose.axis.allFinite() || !(pose.axis.norm() > 0.5)) return false;
  try {
    check_bit(bit);
  } catch (const Error&) {
    return false;
  }
  return !bit.is_plate() || valid_pose(pose, bit);
}

}  // namespace

SliceView::SliceView(SliceKind kind, PlanDocument& document, ViewState& state, QWidget* parent)
    : QWidget(parent), kind_(kind), document_(document), state_(state) {
  setAccessibleName(kind == SliceKind::down_path ? name_of_kind(kind) : tr("%1 slice").arg(name_of_kind(kind)));
  setFocusPolicy(Qt::StrongFocus);
  setMouseTracking(true);
  setAttribute(Qt::WA_OpaquePaintEvent);
  setContextMenuPolicy(Qt::PreventContextMenu);  // the right button changes the window
  setSizePolicy(QSizePolicy::Expanding, QSizePolicy::Expanding);
  setWhatsThis(
      tr("Left: crosshair; on a handle: moves that end; on another path: chooses it.\n"
         "Middle, or Shift and left: moves the picture. Right: HU window.\n"
         "Wheel: next slice (Shift: ten); with Ctrl: zooms. Double click: fits.\n"
         "Up, Down: slices; +, -, 0: zoom. Ctrl and arrows move the entry by 0.1 mm, Alt and arrows the target; with "
         "Shift 1 mm. Escape gives up a drag."));
  connect(&document, &PlanDocument::bone_changed, this, [this] {
    walls_.clear();
    if (document_.bone()) walls_.update(document_.bone()->surface);
    let_go();
    // A bone of the CT that is looked at leaves what is looked at.
    const std::shared_ptr<const CtVolume> ct = document_.opened() ? document_.opened()->volume : nullptr;
    if (is_fitted_ || ct != fitted_ct_.lock()) fit();
    fitted_ct_ = ct;
    follow_crosshair();
  });
  connect(&document, &PlanDocument::levels_changed, this, &SliceView::look_again);
  connect(&state, &ViewState::levels_changed, this, &SliceView::look_again);
  connect(&document, &PlanDocument::paths_changed, this, &SliceView::look_again);
  connect(&document, &PlanDocument::chosen_changed, this, &SliceView::follow_crosshair);
  connect(&state, &ViewState::crosshair_changed, this, &SliceView::follow_crosshair);
  connect(&state, &ViewState::window_changed, this, &SliceView::look_again);
  follow_crosshair();
}

SliceView::~SliceView() = default;

void SliceView::set_bit(const std::optional<std::pair<DrillBit, Pose>>& bit) {
  bit_ = bit && is_drawable(bit->first, bit->second) ? bit : std::nullopt;
  update();
}

void SliceView::update_surface(std::span<const SurfaceUpdate> updates) {
  walls_.update(updates);
  update();
}

bool SliceView::has_ct() const { return document_.opened() && !document_.opened()->ct.hu.empty(); }

Vec3 SliceView::shown_crosshair() const {
  return has_ct() ? clamped_to_grid(document_.opened()->ct.geometry, state_.crosshair_mm()) : state_.crosshair_mm();
}

std::optional<PanePlane> SliceView::plane() const {
  if (!has_ct()) return std::nullopt;
  if (grip_.plane) return grip_.plane;
  if (kind_ != SliceKind::down_path) return standard_plane(plane_of_kind(kind_), shown_crosshair());
  const DrillPath* path = document_.chosen_path();
  if (path == nullptr) return std::nullopt;
  return plane_down_path(*path, shown_depth_mm(*path, depth_mm_));
}

PaneSize SliceView::pane_size() const { return {width(), height(), devicePixelRatioF()}; }

SliceFrame SliceView::frame() const { return pane_frame(plane().value_or(PanePlane{}), view_, pane_size()); }

QPointF SliceView::place_of(const Vec3& p_mm) const { return place_in_pane(frame(), devicePixelRatioF(), p_mm); }

Vec3 SliceView::position_at(const QPointF& place) const { return patient_at(frame(), devicePixelRatioF(), place); }

QString SliceView::caption() const {
  if (!plane()) return name_of_kind(kind_);
  if (kind_ != SliceKind::down_path) return QString::fromStdString(plane_caption(plane_of_kind(kind_), frame()));
  const DrillPath* path = document_.chosen_path();
  if (path == nullptr) return name_of_kind(kind_);
  return tr("Down the path, %1 mm deep").arg(shown_depth_mm(*path, depth_mm_), 0, 'f', 1);
}

void SliceView::put_crosshair(const Vec3& p_mm) {
  // The depth down the path is this pane's own where it moves the crosshair itself: the CT may end before the path.
  is_putting_crosshair_ = true;
  state_.set_crosshair(clamped_to_grid(document_.opened()->ct.geometry, p_mm));
  is_putting_crosshair_ = false;
}

void SliceView::follow_crosshair() {
  const DrillPath* path = document_.chosen_path();
  if (path != nullptr && !is_putting_crosshair_) depth_mm_ = depth_of_mm(*path, state_.crosshair_mm());
  look_again();
}

void SliceView::look_again() {
  setAccessibleDescription(caption());
  update();
}

void SliceView::step(int count) {
  if (count == 0 || !plane()) return;
  if (const DrillPath* path = document_.chosen_path(); kind_ == SliceKind::down_path && path != nullptr) {
    depth_mm_ = shown_depth_mm(*path, shown_depth_mm(*path, depth_mm_) + count * kDownPathStepMm);
    put_crosshair(at_depth(*path, depth_mm_));
    look_again();  // also where the crosshair has come to the CT's end
    return;
  }
  const Vec3 into = plane()->into();
  put_crosshair(shown_crosshair() + count * slice_step_mm(document_.opened()->ct.geometry, into) * into);
}

void SliceView::fit() { fit_to(has_ct() ? document_.opened()->bounds_mm() : Box3()); }

void SliceView::fit_to(const Box3& shown_mm) {
  is_fitted_ = true;
  if (kind_ == SliceKind::down_path) {
    view_ = view_down_path(pane_size());
  } else if (const auto shown = plane()) {
    view_ = fitted_view(*shown, shown_mm, pane_size());
  }
  look_again();
}

void SliceView::zoom(double factor, const QPointF& place) {
  const auto shown = plane();
  if (!shown) return;
  view_ = zoomed_view(view_, factor, in_plane(*shown, position_at(place)));
  is_fitted_ = false;
  look_again();
}

void SliceView::resizeEvent(QResizeEvent* /*event*/) {
  if (is_fitted_) fit();
}

void SliceView::paintEvent(QPaintEvent* /*event*/) {
  QPainter painter(this);
  const QColor colour = kind_ == SliceKind::down_path
                            ? path_colour(static_cast<std::size_t>(std::max(document_.chosen(), 0)))
                            : plane_colour(plane_of_kind(kind_));
  if (!plane()) {
    const QString hint = !has_ct() ? tr("Open a CT or a bone") : tr("Choose or add a path to look down it");
    paint_empty_pane(painter, size(), caption(), colour, hint);
  } else {
    const PaneScene scene{frame(),
                          devicePixelRatioF(),
                          shown_crosshair(),
                          document_.paths(),
                          document_.chosen(),
                          grip_.end ? std::optional(grip_.end->hit()) : hot_,
                          bit_,
                          walls_};
    const SliceSource source{document_.opened(), state_.shows_levels() ? document_.levels() : nullptr};
    const QImage& image = image_.of(source, scene.frame, state_.window());
    painter.drawImage(QRectF(QPointF(0.0, 0.0), scene.size()), image);
    painter.setRenderHint(QPainter::Antialiasing);
    paint_crosshair(painter, scene);
    LabelPlacer labels({Eigen::Vector2d::Zero(), Eigen::Vector2d(width(), height())});
    paint_pane_words(painter, scene, caption(), colour, state_.window(), labels);
    paint_level_names(painter, scene, image_.names(), labels);
    paint_paths(painter, scene, labels);
  }
  painter.setRenderHint(QPainter::Antialiasing, false);
  paint_pane_edge(painter, size(), colour, hasFocus());
}

}  // namespace spinaltap
