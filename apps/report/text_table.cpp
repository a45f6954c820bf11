#include "apps/report/text_table.h"

#include <algorithm>
#include <utility>

#include "core/base/error.h"

namespace spinaltap {
namespace {

/// Width on a terminal of UTF-8 text without wide characters.
std::size_t width(const std::string& text) {
  return static_cast<std::size_t>(
      std::count_if(text.begin(), text.end(), [](char c) { return (static_cast<unsigned char>(c) & 0xC0U) != 0x80U; }));
}

}  // namespace

TextTable::TextTable(std::vector<Column> columns) : columns_(std::move(columns)) {}

void TextTable::add_row(std::vector<std::string> cells) {
  if (cells.size() != columns_.size()) fail("table: expected ", columns_.size(), " cells, found ", cells.size());
  rows_.push_back(std::move(cells));
}

std::string TextTable::aligned() const {
  std::vector<std::vector<std::string>> lines(2);
  for (const Column& column : columns_) {
    lines[0].push_back(column.name);
    lines[1].push_back(column.unit);
  }
  lines.insert(lines.end(), rows_.begin(), rows_.end());
  std::vector<std::size_t> widths(columns_.size(), 0);
  for (const auto& line : lines) {
    for (std::size_t n = 0; n < line.size(); ++n) widths[n] = std::max(widths[n], width(line[n]));
  }
  std::string text;
  for (const auto& line : lines) {
    std::string row;
    for (std::size_t n = 0; n < line.size(); ++n) {
      const std::string space(widths[n] - width(line[n]), ' ');
      row += "  " + (columns_[n].is_number ? space + line[n] : line[n] + space);
    }
    text += row.substr(0, row.find_last_not_of(' ') + 1) + "\n";
  }
  return text;
}

std::string TextTable::markdown() const {
  std::string head;
  std::string rule;
  for (const Column& column : columns_) {
    head += "| " + column.name + (column.unit.empty() ? "" : ", " + column.unit) + " ";
    rule += column.is_number ? "|--:" : "|---";
  }
  std::string text = head + "|\n" + rule + "|\n";
  for (const auto& row : rows_) {
    for (const std::string& cell : row) text += "| " + cell + " ";
    text += "|\n";
  }
  return text;
}

}  // namespace spinaltap
