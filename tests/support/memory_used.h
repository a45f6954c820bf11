#pragma once

#include <unistd.h>

#include <cstddef>
#include <fstream>

namespace spinaltap::test {

/// Of this process, in memory now (Linux).
inline std::size_t resident_bytes() {
  std::size_t all_pages = 0, resident_pages = 0;
  std::ifstream("/proc/self/statm") >> all_pages >> resident_pages;
  return resident_pages * static_cast<std::size_t>(sysconf(_SC_PAGESIZE));
}

}  // namespace spinaltap::test
