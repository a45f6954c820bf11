#pragma once

#include <optional>

#include "core/ct/level.h"

namespace spinaltap {

/// From the least to the most, degrees; see PathAngles.
struct ConvergenceRange {
  double low_deg = 0.0;
  double high_deg = 0.0;
};

/// How much screws along pedicles converge at a level by published rules and series; nothing above T1 and below L5.
/// Lumbar: 5 degrees times the level's number (Dickman et al. 1992), 10 to either side for people's differences.
/// Thoracic: means of CT series that fall steadily from T1 to T12: from 35.4 +- 2.2 to -9.8 +- 2.4 (Kaur et al. 2016),
/// from 33 to 3 (Demiroz & Erdem 2020), from 23.4 +- 3.2 to 4.0 +- 2.2 (Chughtai et al. 2021); what lies between the
/// lowest and the highest of them and two deviations.
std::optional<ConvergenceRange> published_convergence(Level level);

}  // namespace spinaltap
