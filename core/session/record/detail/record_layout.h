#pragma once

#include <array>
#include <cstdint>

#include "core/base/hash.h"

namespace spinaltap {

// What writer and reader of records share; docs/record-file.md.

inline constexpr const char* kRecordFormat = "spinaltap-record";
inline constexpr const char* kRecordVersion = "1";

/// A chunk of rows is compressed and written at one go: 256 ms at 1 kHz.
inline constexpr std::uint64_t kCycleChunk = 256;
inline constexpr std::uint64_t kEventChunk = 64;

/// What the file holds for sure: written, in one piece, after all that it counts. A file that was cut short may hold
/// more rows than that, and not all of their numbers.
struct RecordProgress {
  static constexpr std::uint64_t kNumbers = 5;

  std::uint64_t cycles = 0;  ///< rows
  std::uint64_t events = 0;  ///< rows
  std::uint64_t lost = 0;    ///< cycles that are not in the file
  std::uint64_t is_whole = 0;

  std::array<std::uint64_t, kNumbers> numbers() const {
    std::array<std::uint64_t, kNumbers> all{cycles, events, lost, is_whole, 0};
    all.back() = checksum(all);
    return all;
  }
  /// Of the numbers before it.
  static std::uint64_t checksum(const std::array<std::uint64_t, kNumbers>& all) {
    Fnv1a hash;
    hash.add(all.data(), (kNumbers - 1) * sizeof(all[0]));
    return hash.value();
  }
};

}  // namespace spinaltap
