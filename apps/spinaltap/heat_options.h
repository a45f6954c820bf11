#pragma once

#include <CLI/CLI.hpp>

#include <filesystem>

#include "core/heat/thermal_bone.h"

namespace spinaltap {

struct SolvedHeat;

/// How bone takes up heat, for commands that work it out.
struct HeatChoice {
  bool is_irrigated = false;
  std::filesystem::path thermal_bone;  ///< empty: the shipped one

  /// Adds --irrigation and --thermal-bone.
  void add_to(CLI::App& app);
  bool is_given() const { return is_irrigated || !thermal_bone.empty(); }
  /// Throws Error as read_thermal_bone() does.
  HeatOptions options() const;
};

/// For people, on standard output.
void print_heat(const SolvedHeat& heat);

}  // namespace spinaltap
