#pragma once

#include <cmath>

#include "core/grading/screw_fixation.h"

namespace spinaltap::test {

/// Rigid polyurethane foam as ASTM F1839 grades it, 0.08 to 0.64 g/cm³: power laws through the data sheet of solid foam
/// blocks at 10 and 20 pcf (shear 1.6 and 4.3 MPa, compression 2.2 and 8.4 MPa, modulus 58 and 210 MPa). docs/screws.md
/// compares with screws that were pulled out of it.
inline FixationModel foam_fixation_model() {
  FixationModel model;
  model.shear = {4.3, 0.32, std::log2(4.3 / 1.6)};
  model.crushing = {8.4, 0.32, std::log2(8.4 / 2.2)};
  model.modulus = {210.0, 0.32, std::log2(210.0 / 58.0)};
  return model;
}

}  // namespace spinaltap::test
