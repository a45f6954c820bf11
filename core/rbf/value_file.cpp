#include "core/rbf/value_file.h"

#include "core/base/text_fields.h"
#include "core/rbf/detail/value_rows.h"

namespace spinaltap {
namespace {

RbfValues read(const std::filesystem::path& path, bool wants_values) {
  const std::string name = lower_case(path.filename().string());
  const bool is_ply = name.ends_with(".ply");
  if (!is_ply && !name.ends_with(".csv") && !name.ends_with(".csv.gz")) {
    fail("expected points in a file that ends in .csv, .csv.gz or .ply, found ", path.string());
  }
  FileReader file(path);
  detail::ValueRows rows(wants_values);
  if (is_ply) {
    detail::read_ply_rows(file, rows);
  } else {
    detail::read_csv_rows(file, rows);
  }
  if (rows.values().points_mm.empty()) fail("expected points, found none in ", path.string());
  return std::move(rows.values());
}

}  // namespace

RbfValues read_values(const std::filesystem::path& path) { return read(path, true); }

std::vector<Vec3> read_positions(const std::filesystem::path& path) { return read(path, false).points_mm; }

}  // namespace spinaltap
