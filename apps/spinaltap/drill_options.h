#pragma once

#include <CLI/CLI.hpp>

#include <filesystem>
#include <optional>
#include <string>

#include "apps/report/operator_choice.h"
#include "apps/spinaltap/heat_options.h"
#include "core/ct/hu_to_density.h"
#include "core/session/real_time/real_time.h"
#include "core/session/session_setup.h"

namespace spinaltap {

/// --step, --offset, --tilt.
void add_straight_motion(CLI::App& app, OperatorChoice& tool_operator);
/// The other options of operators.
void add_operator(CLI::App& app, OperatorChoice& tool_operator);

/// --stop-at-thrust, --stop-at-clearance, --stop-on-breach.
void add_stop_rules(CLI::App& app, StopRules& stop);

/// The options of commands that drill.
struct DrillOptions {
  std::filesystem::path density;   ///< empty: the shipped one
  std::filesystem::path material;  ///< the same
  std::filesystem::path field;     ///< a radial basis function that decides which points are bone; empty: the grid
  bool writes_points = false;
  bool writes_splats = false;
  bool writes_voxels = false;
  bool leaves_clearances = false;
  double log_step_mm = 0.1;
  SessionSetup setup;     ///< but for the path, the material, the region and the bone's hash
  std::string region;     ///< empty: none
  std::size_t bones = 1;  ///< how many are drilled
  OperatorChoice tool_operator;
  bool has_heat = false;
  bool solves_heat = false;  ///< on a grid too, after the drilling
  HeatChoice heat;
  std::optional<double> heat_limit_c;
  std::filesystem::path record;  ///< empty: none
  bool may_replace_record = false;
  bool writes_full_mesh = false;
  bool leaves_pictures = false;
  bool is_real_time = false;
  std::optional<double> seconds;
  std::optional<double> output_rate_hz;

  /// Adds the material's, the point volume's, the engine's, and of the operator those of a straight motion.
  void add_to(CLI::App& app);
  /// Adds the rest: operators, stop rules, heat, records, real time.
  void add_session_to(CLI::App& app);

  /// Throws Error where options do not go together, or not with the path's tool.
  void check(const DrillBit& tool) const;
  /// The box of --region; nothing without it.
  std::optional<Box3> region_mm(const DrillPath& path) const;
  /// How the threads are paced; nothing where drilling goes as fast as it goes.
  std::optional<RealTimeOptions> real_time(const OperatorPlan& tool_operator) const;
};

}  // namespace spinaltap
