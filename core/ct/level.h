#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace spinaltap {

/// A vertebra by its place in the spine. The numbers are those of the VerSe label maps (Loeffler 2020, Sekuboyina
/// 2021), which SPINEPS and TPTBox share: a thirteenth thoracic vertebra came late and is 28.
enum class Level : std::uint8_t {
  kNone = 0,
  kC1 = 1,
  kC2 = 2,
  kC7 = 7,
  kT1 = 8,
  kT12 = 19,
  kL1 = 20,
  kL5 = 24,
  kL6 = 25,
  kSacrum = 26,
  kT13 = 28,
};

/// A level that a body may be.
struct LevelProbability {
  Level level = Level::kNone;
  double probability = 0.0;
};

/// "T11", "L3", "sacrum"; empty for kNone and for numbers that are none of the above.
std::string level_name(Level level);

/// The level that a name means: "T11", "t11", "Th11", "TH11", "L3", "S" or "S1" or "sacrum". Nothing for other names.
std::optional<Level> level_from_name(std::string_view name);

/// The level of a number of the VerSe label maps; nothing where there is none, as for 27, the coccyx.
std::optional<Level> level_from_number(long long number);

/// The next level down and up the spine as most people have it: T12 is followed by L1, L5 by the sacrum. kNone beyond
/// either end; T13's and L6's neighbours are T12 and L1, and L5 and the sacrum.
Level level_below(Level level);
Level level_above(Level level);

/// How far down the spine a level lies: grows from C1 to the sacrum, with T13 between T12 and L1.
int level_rank(Level level);

}  // namespace spinaltap
