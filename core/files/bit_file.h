#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "core/tool/drill_bit.h"

namespace spinaltap {

/// Shapes of bits by the names that they have in options and plans.
const std::map<std::string, BitShape>& bit_shapes();

/// "drill", "round-burr", "conical-burr" or "tapered-screw".
const std::string& name_of(BitShape shape);

/// A bit that people know by a name.
struct NamedBit {
  std::string name;
  DrillBit bit;
};

/// Reads a list of bits like the shipped bits/pedicle.json, in its order. Throws Error that names the file and the key
/// at fault.
std::vector<NamedBit> read_bits(const std::filesystem::path& path);

}  // namespace spinaltap
