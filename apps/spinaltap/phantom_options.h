#pragma once

#include <CLI/CLI.hpp>

#include <filesystem>
#include <memory>
#include <optional>

#include "apps/common/phantom_output.h"

namespace spinaltap {

/// A phantom to scan, and what is known of it.
struct Phantom {
  std::unique_ptr<Solid> solid;
  std::optional<VertebraTruth> truth;  ///< of a vertebra
};

/// The options of commands that make a phantom.
struct PhantomCommandOptions {
  std::filesystem::path anatomy;  ///< empty: the shipped L3
  std::filesystem::path mesh;     ///< empty: a vertebra by its anatomy
  std::string surroundings = "tissue";
  PhantomOptions phantom;

  void add_to(CLI::App& app);
  Phantom make() const;
  /// `phantom`, with the surroundings' CT number.
  PhantomOptions output_options() const;
};

}  // namespace spinaltap
