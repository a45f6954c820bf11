#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <vector>

#include "core/anatomy/wall_distance.h"
#include "core/base/progress.h"
#include "core/base/statistics.h"
#include "core/grading/grade.h"
#include "core/uncertainty/placement_errors.h"

namespace spinaltap {

struct ProbabilityOptions {
  int draws = 1024;         ///< of a scrambled Sobol sequence, which is evenest in whole powers of two
  std::uint64_t seed = 1;   ///< of its scrambling
  GradeOptions grade = {};  ///< step and ring points are used
};

/// A probability, from draws, and its 95 % interval by Wilson. The draws are spread more evenly than random ones, so
/// the interval is rather too wide.
struct Probability {
  double share = 0.0;
  Interval interval;
};

/// How likely each grade is where screws err as a model says.
struct GradeProbabilities {
  std::array<Probability, 5> grades;  ///< A to E, Gertzbein-Robbins
  Probability acceptable;             ///< A or B
  Probability canal;                  ///< any breach into the canal
  double mean_breach_mm = 0.0;
  double p95_breach_mm = 0.0;
  int draws = 0;
  std::uint64_t seed = 0;
};

/// Grades `draws` erred paths by their breach. Bit for bit the same at any thread count. Throws Error on errors, paths
/// and options that make no sense.
GradeProbabilities grade_probabilities(const WallDistance& walls, const DrillPath& path, const PlacementErrors& errors,
                                       const ProbabilityOptions& options = {}, const Progress& progress = {});

/// Where a screw ends on draw `index`: the same whatever thread asks.
using ErredPath = std::function<DrillPath(std::uint32_t index)>;
/// The same of paths that err in whatever way: registered_probabilities() has another.
GradeProbabilities grade_probabilities(const WallDistance& walls, const ErredPath& erred,
                                       const ProbabilityOptions& options = {}, const Progress& progress = {});

struct BreachMapOptions {
  double max_shift_mm = 5.0, shift_step_mm = 0.5;
  double max_turn_deg = 10.0, turn_step_deg = 1.0;
  GradeOptions grade = {};  ///< step and ring points are used
};

/// Breaches over a square lattice of errors.
struct BreachLattice {
  std::vector<double> errors;     ///< ascending, with 0: medial and cranial are above 0; mm or degrees
  std::vector<double> breach_mm;  ///< medial fastest; below 0: how much bone is left beside the screw, to 0.1 mm

  double at(std::size_t medial, std::size_t cranial) const { return breach_mm[cranial * errors.size() + medial]; }
};

/// What a screw breaches by where its entry, or its direction alone, errs.
struct BreachMap {
  BreachLattice shift_mm;  ///< of the entry; the whole path is shifted
  BreachLattice turn_deg;  ///< about the entry
};

BreachMap breach_map(const WallDistance& walls, const DrillPath& path, const BreachMapOptions& options = {},
                     const Progress& progress = {});

}  // namespace spinaltap
