#include "core/tool/pedicle_screw.h"

#include "core/base/error.h"

namespace spinaltap {

void check_screw(const PedicleScrew& screw) {
  try {
    check_bit(screw.outline());
  } catch (const Error& error) {
    fail("screw \"", screw.name, "\": ", error.what());
  }
}

}  // namespace spinaltap
