#pragma once

namespace spinaltap {

/// The version of the library, for example "0.1.0".
const char* version();

}  // namespace spinaltap
