#include "core/base/ply_elements.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>

#include "core/base/error.h"
#include "core/base/text_fields.h"

namespace spinaltap {
namespace {

template <class Number>
double number_in(std::string_view bytes, bool is_swapped) {
  std::array<char, sizeof(Number)> raw{};
  std::memcpy(raw.data(), bytes.data(), raw.size());
  if (is_swapped) std::reverse(raw.begin(), raw.end());
  return static_cast<double>(std::bit_cast<Number>(raw));
}

double number_in(PlyType type, std::string_view bytes, bool is_swapped) {
  switch (type) {
    case PlyType::int8:
      return number_in<std::int8_t>(bytes, is_swapped);
    case PlyType::uint8:
      return number_in<std::uint8_t>(bytes, is_swapped);
    case PlyType::int16:
      return number_in<std::int16_t>(bytes, is_swapped);
    case PlyType::uint16:
      return number_in<std::uint16_t>(bytes, is_swapped);
    case PlyType::int32:
      return number_in<std::int32_t>(bytes, is_swapped);
    case PlyType::uint32:
      return number_in<std::uint32_t>(bytes, is_swapped);
    case PlyType::float32:
      return number_in<float>(bytes, is_swapped);
    case PlyType::float64:
      break;
  }
  return number_in<double>(bytes, is_swapped);
}

/// The fewest bytes that an element takes: with empty lists, and a digit and a blank for each number in ascii.
std::uint64_t min_bytes(const PlyElement& element, PlyFormat format) {
  std::uint64_t bytes = 0;
  for (const PlyProperty& property : element.properties) {
    bytes += format == PlyFormat::ascii ? 2 : bytes_of(property.count_type.value_or(property.type));
  }
  return bytes;
}

bool has_lists(const PlyElement& element) {
  return std::any_of(element.properties.begin(), element.properties.end(),
                     [](const PlyProperty& property) { return property.count_type.has_value(); });
}

}  // namespace

PlyElements::PlyElements(FileReader& file, PlyFormat format)
    : file_(file),
      is_ascii_(format == PlyFormat::ascii),
      is_swapped_((format == PlyFormat::big_endian) != (std::endian::native == std::endian::big)) {}

void PlyElements::begin(const PlyElement& element, std::uint64_t index) {
  element_ = &element;
  index_ = index;
  if (!is_ascii_) return;
  do {
    if (!file_.line(line_)) cut_short();
  } while (trimmed(line_).empty());
}

double PlyElements::number(PlyType type) {
  if (!is_ascii_) {
    std::string_view bytes;
    if (!file_.bytes(bytes_of(type), bytes)) cut_short();
    return number_in(type, bytes, is_swapped_);
  }
  line_ = trimmed(line_);
  const std::string_view word = line_.substr(0, line_.find_first_of(" \t"));
  if (word.empty()) fail("expected ", element_->properties.size(), " properties, found fewer in ", place());
  const std::optional<double> number = parse_number(word);
  if (!number) fail("expected a number, found ", in_quotes(word), " in ", place());
  line_.remove_prefix(word.size());
  return *number;
}

std::uint64_t PlyElements::list_size(const PlyProperty& property) {
  const double count = number(*property.count_type);
  if (!(count >= 0.0) || count != std::floor(count) ||
      !(count <= static_cast<double>(file_.max_bytes_left()) + static_cast<double>(line_.size()))) {
    fail("expected a list that fits in the file, found one of ", count, " numbers in ", place());
  }
  return static_cast<std::uint64_t>(count);
}

void PlyElements::list(const PlyProperty& property, std::vector<double>& numbers) {
  numbers.clear();
  for (std::uint64_t left = list_size(property); left > 0; --left) numbers.push_back(number(property.type));
}

void PlyElements::skip(const PlyProperty& property) {
  if (!property.count_type) {
    number(property.type);
    return;
  }
  const std::uint64_t count = list_size(property);
  if (is_ascii_) {
    for (std::uint64_t n = 0; n < count; ++n) number(property.type);
  } else if (!file_.skip(count * bytes_of(property.type))) {
    cut_short();
  }
}

void PlyElements::end() const {
  if (is_ascii_ && !trimmed(line_).empty()) {
    fail("expected ", element_->properties.size(), " properties, found more in ", place());
  }
}

std::string PlyElements::place() const {
  return file_.name() + ", " + shown(element_->name) + " " + std::to_string(index_ + 1);
}

void PlyElements::cut_short() const {
  fail("expected ", element_->count, " times ", in_quotes(element_->name), ", found ", index_, " (cut short?) in ",
       file_.name());
}

void check_ply_count(const PlyElement& element, PlyFormat format, const FileReader& file) {
  const std::uint64_t min = min_bytes(element, format);
  // The last line of an ascii file may go without its end.
  if (min > 0 && element.count > (file.max_bytes_left() + 1) / min) {
    fail("expected ", element.count, " times ", in_quotes(element.name), ", found room for ",
         (file.max_bytes_left() + 1) / min, " at most (cut short?) in ", file.name());
  }
}

void skip_ply_element(FileReader& file, PlyFormat format, const PlyElement& element) {
  check_ply_count(element, format, file);
  if (element.properties.empty()) return;
  PlyElements elements(file, format);
  if (format != PlyFormat::ascii && !has_lists(element)) {
    elements.begin(element, 0);
    if (!file.skip(element.count * min_bytes(element, format))) elements.cut_short();
    return;
  }
  for (std::uint64_t n = 0; n < element.count; ++n) {
    elements.begin(element, n);
    if (format == PlyFormat::ascii) continue;
    for (const PlyProperty& property : element.properties) elements.skip(property);
  }
}

}  // namespace spinaltap
