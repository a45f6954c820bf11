#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/tool/drill_bit.h"

namespace spinaltap {

/// How fast a tool goes in use: beyond it a number is more likely of another unit than meant.
struct ToolSpeedRange {
  double min_feed_mm_s = 0.0, max_feed_mm_s = 0.0;
  double min_rpm = 0.0, max_rpm = 0.0;
};

/// Drills and screws: bone is drilled at 10 to 240 mm/min (0.17 to 4 mm/s) in measurements (Augustin et al., Arch
/// Orthop Trauma Surg 2008: 24 to 188 mm/min; MacAvelia et al., Med Biol Eng Comput 2012: 120 mm/min; Orelaja 2020), by
/// hand at up to some 10 mm/s where it plunges: 0.02 to 20 mm/s. Burrs and plates go sideways as fast as a hand does,
/// up to 200 mm/s. Spindles: from a screw's 10 rpm, and a drill's 50, to the 100,000 that high-speed surgical drives
/// turn at most.
ToolSpeedRange usual_speeds(const DrillBit& bit);

/// A sentence for each number beyond usual_speeds(), with what it may have been meant as; a spindle at 0 is off.
std::vector<std::string> speed_warnings(const DrillBit& bit, const std::vector<double>& feeds_mm_s,
                                        std::optional<double> rpm);

}  // namespace spinaltap
