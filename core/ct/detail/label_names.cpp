#include "core/ct/detail/label_names.h"

#include <algorithm>
#include <array>
#include <cctype>

#include "core/base/text_fields.h"

namespace spinaltap::detail {
namespace {

/// Words beside a level's that leave it the whole vertebra.
constexpr std::array<std::string_view, 9> kPlainWords{"vertebra", "vertebrae", "vert",     "spine",       "bone",
                                                      "level",    "segment",   "vertebre", "segmentation"};

std::vector<std::string> words_of_name(std::string_view text) {
  std::vector<std::string> words;
  bool in_word = false;
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    const bool is_part = std::isalnum(byte) != 0 || byte >= 0x80;
    if (is_part && !in_word) words.emplace_back();
    if (is_part) words.back() += lower_case({&c, 1});
    in_word = is_part;
  }
  return words;
}

}  // namespace

std::optional<Level> level_in_name(std::string_view name) {
  std::optional<Level> found;
  for (const std::string& word : words_of_name(name)) {
    if (std::find(kPlainWords.begin(), kPlainWords.end(), word) != kPlainWords.end()) continue;
    const std::optional<Level> level = level_from_name(word);
    if (!level || found) return std::nullopt;
    found = level;
  }
  return found;
}

std::map<int, LabelName> levels_by_names(const std::map<int, LabelShape>& present,
                                         const std::map<long long, std::string>& names) {
  std::map<int, LabelName> levels;
  std::optional<int> sacrum;
  std::optional<int> first_sacral;
  for (const auto& entry : present) {
    const int number = entry.first;
    const auto named = names.find(number);
    const std::string name = named == names.end() ? "" : named->second;
    const std::optional<Level> level = level_in_name(name);
    if (level) {
      levels[number] = {level_name(*level), *level};
    } else {
      levels[number] = {name, Level::kNone};
    }
    if (level != Level::kSacrum) continue;
    const std::vector<std::string> words = words_of_name(name);
    const bool is_s1 = std::find(words.begin(), words.end(), "s1") != words.end();
    (is_s1 ? first_sacral : sacrum) = number;
  }
  if (sacrum && first_sacral) levels[*first_sacral] = {"S1", Level::kNone};
  return levels;
}

}  // namespace spinaltap::detail
