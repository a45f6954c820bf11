#include "core/base/version.h"

namespace spinaltap {

const char* version() { return SPINALTAP_VERSION; }

}  // namespace spinaltap
