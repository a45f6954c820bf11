#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/ply_head.h"

namespace spinaltap {

/// Reads the elements of a PLY file, one number after the other. All throw Error, naming the file and the element,
/// where it is cut short or holds something else.
class PlyElements {
 public:
  PlyElements(FileReader& file, PlyFormat format);

  /// Goes to the next element.
  void begin(const PlyElement& element, std::uint64_t index);

  double number(PlyType type);
  /// The numbers of a list. There are no more than the file has room for.
  void list(const PlyProperty& property, std::vector<double>& numbers);
  void skip(const PlyProperty& property);

  /// That the element's line, of an ascii file, has ended.
  void end() const;

  std::string place() const;
  [[noreturn]] void cut_short() const;

 private:
  std::uint64_t list_size(const PlyProperty& property);

  FileReader& file_;
  bool is_ascii_;
  bool is_swapped_;
  const PlyElement* element_ = nullptr;
  std::uint64_t index_ = 0;
  std::string_view line_;  ///< what is left of it
};

/// Throws Error where the file has no room for so many elements: before anything is made for them.
void check_ply_count(const PlyElement& element, PlyFormat format, const FileReader& file);

void skip_ply_element(FileReader& file, PlyFormat format, const PlyElement& element);

}  // namespace spinaltap
