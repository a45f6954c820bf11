#include <algorithm>
#include <bit>
#include <cstring>

#include "core/base/ply_head.h"
#include "core/rbf/detail/value_rows.h"

namespace spinaltap::detail {
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

/// Reads elements, one number after the other.
class PlyElements {
 public:
  PlyElements(FileReader& file, PlyFormat format)
      : file_(file),
        is_ascii_(format == PlyFormat::ascii),
        is_swapped_((format == PlyFormat::big_endian) != (std::endian::native == std::endian::big)) {}

  /// Goes to the next element.
  void begin(const PlyElement& element, std::uint64_t index) {
    element_ = &element;
    index_ = index;
    if (!is_ascii_) return;
    do {
      if (!file_.line(line_)) cut_short();
    } while (trimmed(line_).empty());
  }

  double number(PlyType type) {
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

  void skip_list(const PlyProperty& property) {
    const double count = number(*property.count_type);
    if (!(count >= 0.0) || count != std::floor(count) ||
        !(count <= static_cast<double>(file_.max_bytes_left()) + static_cast<double>(line_.size()))) {
      fail("expected a list that fits in the file, found one of ", count, " numbers in ", place());
    }
    if (is_ascii_) {
      for (double n = 0.0; n < count; n += 1.0) number(property.type);
    } else if (!file_.skip(static_cast<std::uint64_t>(count) * bytes_of(property.type))) {
      cut_short();
    }
  }

  void end() const {
    if (is_ascii_ && !trimmed(line_).empty()) {
      fail("expected ", element_->properties.size(), " properties, found more in ", place());
    }
  }

  std::string place() const { return file_.name() + ", " + shown(element_->name) + " " + std::to_string(index_ + 1); }

  [[noreturn]] void cut_short() const {
    fail("expected ", element_->count, " times ", in_quotes(element_->name), ", found ", index_, " (cut short?) in ",
         file_.name());
  }

 private:
  FileReader& file_;
  bool is_ascii_;
  bool is_swapped_;
  const PlyElement* element_ = nullptr;
  std::uint64_t index_ = 0;
  std::string_view line_;  ///< what is left of it
};

/// Whether there is room for so many elements, before anything is made for them.
void check_count(const PlyElement& element, PlyFormat format, const FileReader& file) {
  const std::uint64_t min = min_bytes(element, format);
  // The last line of an ascii file may go without its end.
  if (min > 0 && element.count > (file.max_bytes_left() + 1) / min) {
    fail("expected ", element.count, " times ", in_quotes(element.name), ", found room for ",
         (file.max_bytes_left() + 1) / min, " at most (cut short?) in ", file.name());
  }
}

void skip_element(FileReader& file, PlyFormat format, const PlyElement& element) {
  check_count(element, format, file);
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
    for (const PlyProperty& property : element.properties) {
      if (property.count_type) {
        elements.skip_list(property);
      } else {
        elements.number(property.type);
      }
    }
  }
}

/// Which of kValueColumns each property of the vertices is.
std::vector<std::size_t> roles_of(const PlyElement& vertices, const ValueRows& rows, const FileReader& file) {
  std::vector<std::size_t> roles;
  for (const PlyProperty& property : vertices.properties) {
    const auto* match = std::find(kValueColumns.begin(), kValueColumns.begin() + rows.taken(), property.name);
    const auto role = static_cast<std::size_t>(match - kValueColumns.begin());
    const bool is_wanted = role < rows.taken() && !property.count_type;
    if (is_wanted && std::count(roles.begin(), roles.end(), role) > 0) {
      fail("expected one property ", property.name, ", found two in ", file.name());
    }
    roles.push_back(is_wanted ? role : kNoColumn);
  }
  for (std::size_t role = 0; role < rows.needed(); ++role) {
    if (std::count(roles.begin(), roles.end(), role) == 0) {
      fail("expected vertices with the properties ", needed_columns(rows), ", found none named ", kValueColumns[role],
           " in ", file.name());
    }
  }
  return roles;
}

void read_vertices(FileReader& file, PlyFormat format, const PlyElement& vertices, ValueRows& rows) {
  const std::vector<std::size_t> roles = roles_of(vertices, rows, file);
  const bool has_error_bars = std::count(roles.begin(), roles.end(), kErrorBar) > 0;
  check_count(vertices, format, file);
  rows.reserve(static_cast<std::size_t>(vertices.count), has_error_bars);
  PlyElements elements(file, format);
  for (std::uint64_t n = 0; n < vertices.count; ++n) {
    elements.begin(vertices, n);
    ValueRow row{};
    for (std::size_t p = 0; p < roles.size(); ++p) {
      const PlyProperty& property = vertices.properties[p];
      if (property.count_type) {
        elements.skip_list(property);
        continue;
      }
      const double number = elements.number(property.type);
      if (roles[p] != kNoColumn) row[roles[p]] = number;
    }
    elements.end();
    rows.add(row, has_error_bars, [&] { return elements.place(); });
  }
}

}  // namespace

void read_ply_rows(FileReader& file, ValueRows& rows) {
  const PlyHead head = read_ply_head(file);
  for (const PlyElement& element : head.elements) {
    if (element.name == "vertex") {
      read_vertices(file, head.format, element, rows);
      return;
    }
    skip_element(file, head.format, element);
  }
  fail("expected a PLY element vertex, found none in ", file.name());
}

}  // namespace spinaltap::detail
