#pragma once

#include <string>
#include <vector>

namespace spinaltap {

/// A table for a terminal or for Markdown. Text stands left in its column, numbers right.
class TextTable {
 public:
  struct Column {
    std::string name;
    std::string unit;  ///< may be empty
    bool is_number = true;
  };

  explicit TextTable(std::vector<Column> columns);

  /// As many cells as there are columns; throws Error otherwise.
  void add_row(std::vector<std::string> cells);

  /// Aligned by spaces, names and units above, each line indented by two.
  std::string aligned() const;
  /// As GitHub and CommonMark's tables extension read it.
  std::string markdown() const;

 private:
  std::vector<Column> columns_;
  std::vector<std::vector<std::string>> rows_;
};

}  // namespace spinaltap
