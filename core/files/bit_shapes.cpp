#include "core/files/bit_shapes.h"

#include "core/base/error.h"

namespace spinaltap {

const std::map<std::string, BitShape>& bit_shapes() {
  static const std::map<std::string, BitShape> shapes{{"drill", BitShape::drill},
                                                      {"round-burr", BitShape::round_burr},
                                                      {"conical-burr", BitShape::conical_burr},
                                                      {"tapered-screw", BitShape::tapered_screw}};
  return shapes;
}

const std::string& name_of(BitShape shape) {
  for (const auto& [name, known] : bit_shapes()) {
    if (known == shape) return name;
  }
  fail("no such shape of a bit");
}

}  // namespace spinaltap
