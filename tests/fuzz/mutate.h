#pragma once

#include <cstdint>
#include <random>
#include <string>

namespace spinaltap::test {

/// Changes bytes as damage and malice do: bits, bytes, lengths and numbers that are odd, pieces that are missing,
/// doubled, or taken from `other`. One to four changes; the same random numbers make the same changes.
std::string mutated(std::string bytes, const std::string& other, std::mt19937_64& random);

/// Changes values, keys and structure of a JSON text, one to three of them: it stays JSON, but for numbers that are too
/// large. A text that is none is changed as mutated() does.
std::string mutated_json(const std::string& text, const std::string& other, std::mt19937_64& random);

}  // namespace spinaltap::test
