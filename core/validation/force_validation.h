#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/progress.h"
#include "core/files/measurements_file.h"
#include "core/points/material.h"
#include "core/validation/open_conditions.h"

namespace spinaltap {

/// What a law says of a figure, and what was measured. N, or N·mm of torque.
struct PredictedFigure {
  std::size_t row = 0;  ///< of Measurements::drilling
  bool is_torque = false;
  double measured = 0.0;                             ///< of a range its middle
  std::optional<MeasuredRange> measured_range = {};  ///< where only a range is stated
  double predicted = 0.0;                            ///< median
  double p05 = 0.0;
  double p95 = 0.0;

  bool is_inside() const { return measured >= p05 && measured <= p95; }
  /// How many times too large or too small, at least 1.
  double error_factor() const;
};

/// How well figures are met.
struct FigureSummary {
  std::size_t figures = 0;
  double inside_share = 0.0;
  double median_error_factor = 0.0;
  double median_width = 0.0;  ///< of p95 over p05
};
FigureSummary summary_of(const std::vector<PredictedFigure>& figures);

/// A law, its numbers fitted to all sources, held against every figure: of each source's as the law is that was fitted
/// without that source.
struct LawValidation {
  CuttingLaw law = CuttingLaw::power;
  Material fitted;                        ///< to all sources; with its spread
  std::vector<PredictedFigure> left_out;  ///< in the order of the rows, thrust before torque
};

/// A row that no law is held against, and why.
struct UnpredictedRow {
  std::size_t row = 0;
  std::string why;
};

struct ForceSpreads {
  ForceSpread thrust, torque;
};

struct ForceValidation {
  std::vector<LawValidation> laws;     ///< as CuttingLaw has them
  std::vector<PredictedFigure> given;  ///< by the given material, with its own band; in the same order
  ForceSpreads given_spreads;          ///< what its band would be by these measurements
  std::vector<UnpredictedRow> unpredicted;

  /// The law with the smaller median factor of error.
  const LawValidation& better() const;
};

/// "power", "mechanistic".
std::string_view name_of(CuttingLaw law);

/// Holds both laws, and a material as it is, against all measurements of drilling. docs/validation.md has the method.
/// Throws Error where no row can be predicted.
ForceValidation validate_forces(const Measurements& measurements, const Material& given,
                                const OpenConditions& open = {}, const Progress& progress = {});

/// How the measured forces lie about a material's over all sources.
ForceSpreads spreads_of(const Measurements& measurements, const Material& material, const OpenConditions& open = {});

}  // namespace spinaltap
