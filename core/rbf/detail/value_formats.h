#pragma once

#include "core/base/file_reader.h"
#include "core/rbf/detail/value_rows.h"

namespace spinaltap::detail {

// One file each; see read_values().
void read_csv_rows(FileReader& file, ValueRows& rows);
void read_ply_rows(FileReader& file, ValueRows& rows);

}  // namespace spinaltap::detail
