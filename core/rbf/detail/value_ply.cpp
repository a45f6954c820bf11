#include <algorithm>

#include "core/base/ply_elements.h"
#include "core/rbf/detail/value_rows.h"

namespace spinaltap::detail {
namespace {

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
  check_ply_count(vertices, format, file);
  rows.reserve(static_cast<std::size_t>(vertices.count), has_error_bars);
  PlyElements elements(file, format);
  for (std::uint64_t n = 0; n < vertices.count; ++n) {
    elements.begin(vertices, n);
    ValueRow row{};
    for (std::size_t p = 0; p < roles.size(); ++p) {
      const PlyProperty& property = vertices.properties[p];
      if (property.count_type) {
        elements.skip(property);
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
    skip_ply_element(file, head.format, element);
  }
  fail("expected a PLY element vertex, found none in ", file.name());
}

}  // namespace spinaltap::detail
