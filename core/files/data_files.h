#pragma once

#include <filesystem>
#include <string_view>

namespace spinaltap {

/// Path of a shipped file, for example "phantom/l3.json": below $SPINALTAP_DATA_DIR where set, otherwise in
/// ../share/spinaltap beside the program's own folder. Throws Error when it is not there.
std::filesystem::path data_file(std::string_view name);

}  // namespace spinaltap
