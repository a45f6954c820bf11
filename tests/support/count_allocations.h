#pragma once

#include <cstddef>

namespace spinaltap::test {

/// How often this thread has called operator new so far. The test program replaces the global operators.
std::size_t allocation_count();

}  // namespace spinaltap::test
