#include "core/tool/bit_shape.h"

#include <array>

#include "core/base/error.h"

namespace spinaltap {

// Speeds of drills and screws: bone is drilled at 10 to 240 mm/min (0.17 to 4 mm/s) in measurements (Augustin et al.,
// Arch Orthop Trauma Surg 2008: 24 to 188 mm/min; MacAvelia et al., Med Biol Eng Comput 2012: 120 mm/min; Orelaja
// 2020), by hand at up to some 10 mm/s where it plunges: 0.02 to 20 mm/s. Burrs and plates go sideways as fast as a
// hand does, up to 200 mm/s. Spindles: from a screw's 10 rpm, and a drill's 50, to the 100,000 that high-speed surgical
// drives turn at most.
std::span<const BitShapeTraits> bit_shape_traits() {
  static const std::array<BitShapeTraits, 6> traits{{
      {BitShape::drill, "drill", false, 2, {0.02, 20.0, 50.0, 100'000.0}},
      {BitShape::round_burr, "round-burr", true, 8, {0.02, 200.0, 10.0, 100'000.0}},
      {BitShape::conical_burr, "conical-burr", true, 8, {0.02, 200.0, 10.0, 100'000.0}},
      {BitShape::tapered_screw, "tapered-screw", false, 2, {0.02, 20.0, 10.0, 100'000.0}},
      {BitShape::profile, "profile", true, 2, {0.02, 200.0, 10.0, 100'000.0}},
      {BitShape::plate, "plate", true, 2, {0.02, 200.0, 10.0, 100'000.0}},
  }};
  return traits;
}

const BitShapeTraits& traits_of(BitShape shape) {
  for (const BitShapeTraits& traits : bit_shape_traits()) {
    if (traits.shape == shape) return traits;
  }
  fail_as(ErrorKind::internal, "no such shape of a bit");
}

}  // namespace spinaltap
