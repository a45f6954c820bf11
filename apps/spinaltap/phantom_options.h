#pragma once

#include <CLI/CLI.hpp>

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "apps/spinaltap/mesh_options.h"
#include "core/phantom/random_trunk.h"
#include "core/phantom/spine.h"
#include "vdb/sim/phantom_output.h"

namespace spinaltap {

/// A phantom to scan, and what is known of it.
struct Phantom {
  std::unique_ptr<Solid> solid;
  std::optional<VertebraGroundTruth> ground_truth;  ///< of a vertebra
};

/// The options of a phantom of several levels.
struct SpineCommandOptions {
  std::string levels;                            ///< "T6-L5"; empty: no spine
  std::optional<std::uint64_t> random;           ///< seed of a random patient
  std::optional<std::uint64_t> trunk_seed;       ///< of a random patient in a random scanner
  std::optional<double> disc_mm;                 ///< of all discs
  std::vector<std::string> metal, pits, cement;  ///< names of levels
  std::vector<std::string> crushed;              ///< "T8=0.5" or "T8=0.5/0.9"
  std::vector<std::string> meshes;               ///< "L1=FILE"
  MeshCommandOptions mesh_frame;                 ///< of all of them
  std::optional<double> stack_mm;                ///< gap between meshes that are put above each other
  std::vector<double> centre_mm;                 ///< of the field of view; empty: the middle of the spine
  bool soft_tissue = false, trunk = false, contrast = false;
  TrunkTissueOptions tissue;
  SpineOptions spine;

  void add_to(CLI::App& app);
  bool asked_for() const { return !levels.empty() || random || trunk_seed || !meshes.empty(); }
  /// The spine, or the named meshes. Throws Error on names that are no levels.
  std::unique_ptr<Spine> make() const;
  /// What lies around it; null for even surroundings.
  std::unique_ptr<Surroundings> surroundings_of(const Spine& spine) const;
};

/// The options of commands that make a phantom.
struct PhantomCommandOptions {
  std::filesystem::path anatomy;    ///< empty: the shipped L3
  std::vector<std::string> meshes;  ///< FILE, or LEVEL=FILE for each of several; empty: a vertebra by its anatomy
  MeshCommandOptions mesh_frame;    ///< of all of them
  std::string surroundings = "tissue";
  PhantomOptions phantom;

  void add_to(CLI::App& app);
  /// Throws Error where several meshes are given, which only commands with SpineCommandOptions take.
  Phantom make() const;
  /// The meshes that are given under the names of levels.
  std::vector<std::string> named_meshes() const;
  /// `phantom`, with the surroundings' CT number.
  PhantomOptions output_options() const;
};

}  // namespace spinaltap
