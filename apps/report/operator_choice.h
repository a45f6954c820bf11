#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/base/scalar_field.h"
#include "core/session/choose_engine.h"
#include "core/session/device/haptic_device.h"
#include "core/session/operator/milling.h"
#include "core/session/operator/operator.h"
#include "core/session/operator/path_motion.h"
#include "core/tool/drill_path.h"

namespace spinaltap {

/// An operator as somebody asks for it, and the rates that go with it.
struct OperatorPlan {
  std::unique_ptr<HapticDevice> device;  ///< that the operator is a hand at; null: none
  std::unique_ptr<Operator> tool_operator;
  double rate_hz = 1000.0;        ///< poses a second
  double cycle_rate_hz = 1000.0;  ///< collision cycles a second, in real time
  MotionClass way;
  /// What a record says of the operator, by option: it holds the poses themselves.
  std::map<std::string, std::string> words;
};

/// What says how the bit is moved, by the names of the options of `spinaltap drill`. What was not given has the default
/// that its operator has.
struct OperatorChoice {
  std::string name;  ///< empty: along the path
  std::optional<double> offset_mm;
  std::optional<double> tilt_deg;
  std::optional<double> step_mm;
  std::string feed;  ///< mm/s, or "MM_S,FROM_MM:MM_S,...", by depth
  std::optional<double> rate_hz;
  std::optional<double> tremor_mm;
  std::optional<double> peck_mm;
  std::optional<double> peck_pause_s;  ///< only with pecks
  std::optional<double> withdraw_mm_s;
  std::optional<double> push_n;
  std::optional<double> max_push_n;
  std::optional<std::uint64_t> seed;
  std::shared_ptr<const Milling> milling;  ///< one that is read already; its name is then "milling"
  std::string device;                      ///< as open_device() has it, in place of a name; empty: none
  std::optional<double> force_scale;       ///< only with a device: what it gives of the bone's force
  std::optional<double> longest_s;         ///< likewise: ends then

  /// A session with a device has SessionOptions::has_device.
  bool has_device() const { return !device.empty(); }
  /// Throws Error where options do not go together.
  void check(bool is_real_time) const;
  /// A milling takes away the walls that clearances are to.
  bool is_milling() const { return milling || name.ends_with(".json"); }
  /// As far as it is known before files are read.
  MotionClass motion_class() const;
  /// The feeds that were asked for, mm/s: of --feed, by depth, or of a milling's file; none where a default or the bone
  /// decides.
  std::vector<double> asked_feeds_mm_s() const;
  /// The operator, from `lead_in_mm` before the path's entry; `bone`: the distance to its surface, which a milling
  /// follows, asked here only. Throws Error on values out of range, where a file of poses or a milling cannot be read,
  /// and on a milling without a bone. Opens the device, where there is one.
  OperatorPlan plan(const DrillPath& path, double lead_in_mm, const Spindle& spindle, bool is_real_time,
                    const ScalarField* bone = nullptr) const;

 private:
  void check_device(bool is_real_time) const;
  void add_device(const DrillPath& path, double lead_in_mm, const Spindle& spindle, OperatorPlan& plan) const;
  void add_recorded_motion(const DrillPath& path, OperatorPlan& plan) const;
  void add_milling(const DrillPath& path, const ScalarField* bone, OperatorPlan& plan) const;
  void add_planned_motion(const DrillPath& path, const GuideLine& line, OperatorPlan& plan) const;
  void add_force_controlled(const DrillPath& path, const GuideLine& line, const Spindle& spindle,
                            OperatorPlan& plan) const;
  double tremor_or_default_mm() const;
};

}  // namespace spinaltap
