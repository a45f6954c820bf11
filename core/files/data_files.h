#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace spinaltap {

/// Path of a shipped file, for example "phantom/l3.json". Looked for in: the folder of set_data_folder(); then
/// $SPINALTAP_DATA_DIR; then ../share/spinaltap beside the program's own folder; then those of add_data_folder(). The
/// first two, where they are set, are the only ones. Throws Error when it is not there.
std::filesystem::path data_file(std::string_view name);

/// Names of the JSON files in a folder of the shipped ones, for example "errors", in order, without their ending.
/// Throws Error when the folder is not there.
std::vector<std::string> data_names(std::string_view folder);

/// Where the shipped files are, for programs that bring their own; an empty path takes it back. From any thread.
void set_data_folder(const std::filesystem::path& folder);
/// Where they may be too; an installed package says so by itself. Gives true.
bool add_data_folder(const std::filesystem::path& folder);

}  // namespace spinaltap
