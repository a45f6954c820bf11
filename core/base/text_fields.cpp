#include "core/base/text_fields.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>

namespace spinaltap {
namespace {

unsigned byte_at(std::string_view text, std::size_t i) {
  return i < text.size() ? static_cast<unsigned char>(text[i]) : 0U;
}

}  // namespace

void append_csv_number(double number, std::string& text) {
  if (std::isfinite(number)) append_number(number, text);
}

std::string_view trimmed(std::string_view text) {
  const auto first = text.find_first_not_of(" \t");
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(" \t") - first + 1);
}

std::optional<double> parse_number(std::string_view text) {
  text = trimmed(text);
  if (text.size() > 1 && text[0] == '+' && text[1] != '-') text.remove_prefix(1);
  double number = 0.0;
  const char* const end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, number);
  if (error != std::errc{} || stop != end) return std::nullopt;
  return number;
}

std::optional<std::vector<double>> parse_numbers(std::string_view text) {
  std::vector<double> numbers;
  for (text = trimmed(text); !text.empty(); text = trimmed(text)) {
    const std::string_view field = text.substr(0, text.find_first_of(" \t"));
    const std::optional<double> number = parse_number(field);
    if (!number) return std::nullopt;
    numbers.push_back(*number);
    text.remove_prefix(field.size());
  }
  return numbers;
}

void append_number(double number, std::string& text) {
  std::array<char, 32> digits{};
  const auto [end, error] = std::to_chars(digits.data(), digits.data() + digits.size(), number);
  text.append(digits.data(), end);
}

std::string lower_case(std::string_view text) {
  std::string small(text);
  for (char& c : small) c = c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  return small;
}

std::string upper_case(std::string_view text) {
  std::string capital(text);
  for (char& c : capital) c = c >= 'a' && c <= 'z' ? static_cast<char>(c - 'a' + 'A') : c;
  return capital;
}

std::size_t utf8_length(std::string_view text, std::size_t i) {
  const auto follows = [&](std::size_t n, unsigned low, unsigned high) {
    const unsigned byte = byte_at(text, i + n);
    return byte >= low && byte <= high;
  };
  const unsigned lead = byte_at(text, i);
  if (lead < 0x80) return 1;
  if (lead >= 0xC2 && lead <= 0xDF) return follows(1, 0x80, 0xBF) ? 2 : 0;
  if (lead >= 0xE0 && lead <= 0xEF) {
    const bool second = follows(1, lead == 0xE0 ? 0xA0 : 0x80, lead == 0xED ? 0x9F : 0xBF);
    return second && follows(2, 0x80, 0xBF) ? 3 : 0;
  }
  if (lead >= 0xF0 && lead <= 0xF4) {
    const bool second = follows(1, lead == 0xF0 ? 0x90 : 0x80, lead == 0xF4 ? 0x8F : 0xBF);
    return second && follows(2, 0x80, 0xBF) && follows(3, 0x80, 0xBF) ? 4 : 0;
  }
  return 0;
}

bool is_control(std::string_view character) {
  const unsigned lead = byte_at(character, 0);
  if (character.size() == 1) return lead < 0x20 || lead == 0x7F;
  return character.size() == 2 && lead == 0xC2 && byte_at(character, 1) < 0xA0;
}

std::string shown(std::string_view text) {
  constexpr int kMax = 40;
  std::string printable;
  std::size_t i = 0;
  for (int n = 0; n < kMax && i < text.size(); ++n) {
    const std::size_t length = utf8_length(text, i);
    const std::string_view character = text.substr(i, length == 0 ? 1 : length);
    printable += length == 0 || is_control(character) ? "?" : character;
    i += character.size();
  }
  return i < text.size() ? printable + "..." : printable;
}

std::string in_quotes(std::string_view text) { return '"' + shown(text) + '"'; }

bool CsvFields::next(std::string_view& field) {
  if (!has_more_) return false;
  const std::size_t from = rest_.starts_with('"') ? std::min(rest_.find('"', 1), rest_.size()) : 0;
  const std::size_t end = std::min(rest_.find(',', from), rest_.size());
  field = rest_.substr(0, end);
  has_more_ = end < rest_.size();
  if (has_more_) rest_.remove_prefix(end + 1);
  return true;
}

std::string csv_column_name(std::string_view field) {
  field = trimmed(field);
  if (field.size() >= 2 && field.front() == '"' && field.back() == '"') field = field.substr(1, field.size() - 2);
  return lower_case(trimmed(field));
}

std::string_view without_byte_order_mark(std::string_view line) {
  if (line.starts_with("\xEF\xBB\xBF")) line.remove_prefix(3);
  return line;
}

}  // namespace spinaltap
