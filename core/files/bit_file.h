#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "core/tool/bit_shape.h"

namespace spinaltap {

/// Shapes of bits that sizes alone describe, by the names that they have in options and plans.
const std::map<std::string, BitShape>& bit_shapes();

/// A bit that people know by a name.
struct NamedBit {
  std::string name;
  DrillBit bit;
};

/// Reads a list of bits like the shipped bits/pedicle.json, in its order. Throws Error that names the file and the key
/// at fault.
std::vector<NamedBit> read_bits(const std::filesystem::path& path);

/// Names of the shipped profiles, such as "match-head", in order.
std::vector<std::string> bit_profiles();
/// A bit of any outline: a shipped one by its name, else a file like theirs; docs/data-files.md. Throws Error that
/// names the file and the key at fault.
NamedBit read_bit_profile(const std::string& name_or_file);

/// All bits that ship: those of bits/pedicle.json, then the profiles.
std::vector<NamedBit> shipped_bits();

}  // namespace spinaltap
