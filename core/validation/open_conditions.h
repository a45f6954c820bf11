#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/files/measurements_file.h"
#include "core/tool/drill_bit.h"

namespace spinaltap {

/// One drilling that a row of the measurements may have been of.
struct DrillingCondition {
  DrillBit bit;
  double density_g_cm3 = 0.0;
  double rpm = 0.0;
  double feed_mm_per_turn = 0.0;
  double depth_mm = 0.0;  ///< of the hole
};

/// Between which values what a source leaves open lies, each as likely by its logarithm, wear, angles and depth evenly.
/// Said before any law was fitted.
struct OpenConditions {
  MeasuredRange cortical_g_cm3{1.6, 2.1};
  MeasuredRange cancellous_g_cm3{0.1, 0.4};
  MeasuredRange vertebra_g_cm3{0.1, 1.2};  ///< through the shell and what is within
  MeasuredRange bone_g_cm3{1.0, 2.1};      ///< the source does not say which
  MeasuredRange diameter_mm{2.0, 4.5};
  MeasuredRange rpm{500.0, 2000.0};
  MeasuredRange feed_mm_min{20.0, 200.0};
  MeasuredRange web_share{0.10, 0.25};  ///< width of the chisel edge over the diameter
  MeasuredRange wear_mm{0.0, 0.05};
  MeasuredRange point_angle_deg{90.0, 130.0};
  MeasuredRange helix_deg{15.0, 35.0};
  MeasuredRange depth_mm{0.0, 10.0};
  int samples = 64;  ///< of each row
  std::uint64_t seed = 1;
};

/// Why a law of drilling says nothing of a row; empty where it does.
std::string why_not_predicted(const DrillingMeasurement& row);

/// Drillings that a row may have been of: what it states, and what it leaves open spread over `open` by quasi-random
/// numbers, the same for every row. Throws Error on a row that no law predicts.
std::vector<DrillingCondition> conditions_of(const DrillingMeasurement& row, const OpenConditions& open = {});

}  // namespace spinaltap
