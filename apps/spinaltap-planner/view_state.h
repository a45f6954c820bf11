#pragma once

#include <QObject>
#include <array>
#include <optional>

#include "apps/report/slice_frame.h"
#include "core/base/geometry.h"

namespace spinaltap {

/// What all panes share: where they look, how HU become grey, what is shown. Changes tell the panes to draw anew.
class ViewState : public QObject {
  Q_OBJECT
 public:
  using QObject::QObject;

  /// Where the three slices cross, patient LPS, mm.
  const Vec3& crosshair_mm() const { return crosshair_mm_; }
  void set_crosshair(const Vec3& p_mm);

  const HuWindow& window() const { return window_; }
  /// Widths below 1 HU become 1; what is not a number changes nothing.
  void set_window(const HuWindow& window);

  /// Of the bone in 3D: 0 (not drawn) to 1.
  double bone_opacity() const { return bone_opacity_; }
  void set_bone_opacity(double opacity);

  /// Whether the slice of this plane (as Plane counts) is shown in 3D.
  bool shows_guide(Plane plane) const { return shows_guide_[static_cast<std::size_t>(plane)]; }
  void show_guide(Plane plane, bool is_shown);

  /// Whether bits and screws are shown in 3D: they fill the holes.
  bool shows_tools() const { return shows_tools_; }
  void show_tools(bool are_shown);

  /// Whether the vertebrae that were found in a CT are outlined on its slices.
  bool shows_levels() const { return shows_levels_; }
  void show_levels(bool are_shown);

  /// What lies under the pointer, patient LPS, mm; nothing where it is on no slice.
  const std::optional<Vec3>& hovered_mm() const { return hovered_mm_; }
  void set_hovered(const std::optional<Vec3>& p_mm);

 Q_SIGNALS:
  void crosshair_changed();
  void window_changed();
  void scene_changed();   ///< opacity, guide planes or tools
  void levels_changed();  ///< outlined or not
  void hovered_changed();

 private:
  Vec3 crosshair_mm_ = Vec3::Zero();
  HuWindow window_;
  double bone_opacity_ = 1.0;
  std::array<bool, 3> shows_guide_{false, false, false};
  bool shows_tools_ = true;
  bool shows_levels_ = true;
  std::optional<Vec3> hovered_mm_;
};

}  // namespace spinaltap
