#include "core/base/csv_fields.h"

#include <algorithm>
#include <cctype>

#include "core/base/number_text.h"

namespace spinaltap {

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
  std::string name(trimmed(field));
  std::transform(name.begin(), name.end(), name.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return name;
}

std::string_view without_byte_order_mark(std::string_view line) {
  if (line.starts_with("\xEF\xBB\xBF")) line.remove_prefix(3);
  return line;
}

}  // namespace spinaltap
