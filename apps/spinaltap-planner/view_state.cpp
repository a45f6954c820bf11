#include "apps/spinaltap-planner/view_state.h"

#include <algorithm>
#include <cmath>

namespace spinaltap {

void ViewState::set_crosshair(const Vec3& p_mm) {
  if (!p_mm.allFinite() || p_mm == crosshair_mm_) return;
  crosshair_mm_ = p_mm;
  Q_EMIT crosshair_changed();
}

void ViewState::set_window(const HuWindow& window) {
  if (!std::isfinite(window.width_hu) || !std::isfinite(window.level_hu)) return;
  window_ = {std::clamp(window.width_hu, 1.0, 10000.0), std::clamp(window.level_hu, -2000.0, 4000.0)};
  Q_EMIT window_changed();
}

void ViewState::set_bone_opacity(double opacity) {
  bone_opacity_ = std::clamp(opacity, 0.0, 1.0);
  Q_EMIT scene_changed();
}

void ViewState::show_guide(Plane plane, bool is_shown) {
  shows_guide_[static_cast<std::size_t>(plane)] = is_shown;
  Q_EMIT scene_changed();
}

void ViewState::show_tools(bool are_shown) {
  shows_tools_ = are_shown;
  Q_EMIT scene_changed();
}

void ViewState::show_levels(bool are_shown) {
  shows_levels_ = are_shown;
  Q_EMIT levels_changed();
}

void ViewState::set_hovered(const std::optional<Vec3>& p_mm) {
  hovered_mm_ = p_mm;
  Q_EMIT hovered_changed();
}

}  // namespace spinaltap
