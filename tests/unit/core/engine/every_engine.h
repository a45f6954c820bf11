#pragma once

#include <cctype>
#include <cstdint>
#include <functional>
#include <memory>
#include <ostream>
#include <string>
#include <vector>

#include "core/engine/detail/disc_kernels.h"
#include "core/engine/drill_engine.h"

namespace spinaltap::test {

struct NamedEngine {
  std::string name;
  friend void PrintTo(const NamedEngine& kind, std::ostream* out) { *out << kind.name; }
  std::function<std::unique_ptr<DrillEngine>(PointVolume&, const DrillBit&, const Material&)> make;
};

/// A name of instructions as names of tests may be: letters and figures.
inline std::string plain_name(const detail::DiscKernels& kernels) {
  std::string name = kernels.name;
  std::erase_if(name, [](char c) { return std::isalnum(static_cast<unsigned char>(c)) == 0; });
  return name;
}

/// All that remove points; the ring engine with each set of instructions that this machine can run.
inline std::vector<NamedEngine> every_engine() {
  std::vector<NamedEngine> kinds{{"reference", make_reference_engine}, {"arc", make_arc_engine}};
  for (const detail::DiscKernels& kernels : detail::disc_kernels()) {
    kinds.push_back(
        {"ring_" + plain_name(kernels), [&](PointVolume& volume, const DrillBit& bit, const Material& material) {
           return detail::make_ring_engine(volume, bit, material, kernels);
         }});
  }
  return kinds;
}

/// The three engines as they are used: the ring engine with the machine's fastest instructions.
inline std::vector<NamedEngine> three_engines() {
  const std::vector<NamedEngine> all = every_engine();
  return {all[0], all[1], all.back()};
}

/// Of all words that say which points live (FNV-1a, by words).
inline std::uint64_t hash_of_occupied(const PointVolume& volume) {
  std::uint64_t hash = 0xcbf29ce484222325ULL;
  for (const std::uint64_t word : volume.occupancy_words()) hash = (hash ^ word) * 0x100000001b3ULL;
  return hash;
}

/// Whether every point that lives in `few` lives in `many`.
inline bool lives_within(const PointVolume& few, const PointVolume& many) {
  for (std::size_t n = 0; n < few.occupancy_words().size(); ++n) {
    if ((few.occupancy_words()[n] & ~many.occupancy_words()[n]) != 0) return false;
  }
  return true;
}

}  // namespace spinaltap::test
