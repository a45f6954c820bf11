#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/geometry.h"

namespace spinaltap::detail {

// What headers of text (NRRD, MetaImage) have in common.

/// The first bytes of a file, as many as a header may have. Throws Error where it is missing or no regular file.
std::string read_header_bytes(const std::filesystem::path& file);

/// Puts a field into those that were read. Throws Error where it is there with another value: programs differ in which
/// they take. `format`: "NRRD".
void put_field(std::map<std::string, std::string, std::less<>>& fields, const std::string& name, std::string_view value,
               const char* format, const std::filesystem::path& file);

/// What stands between blanks.
std::vector<std::string> words_of(std::string_view text);

/// The whole number that all of `text` is.
std::optional<long long> whole_number(std::string_view text);

/// Three sizes of at least one voxel that are in all not too many; messages name the axes ("NRRD axes") and quote the
/// field's text.
std::array<int, 3> three_sizes(const std::vector<long long>& sizes, const std::string& axes, const std::string& text,
                               const std::filesystem::path& file);

/// A file that a header names: beside the header where the name is not absolute.
std::filesystem::path beside(const std::filesystem::path& header, const std::string& name);

/// The files "slice%03d.raw" with the numbers `first` to `last` in steps. Throws Error where the pattern has other than
/// one %d, %0<width>d or %<width>d, or the steps do not lead from first to last, or would be too many.
std::vector<std::filesystem::path> numbered_files(const std::filesystem::path& header, const std::string& pattern,
                                                  long long first, long long last, long long step);

}  // namespace spinaltap::detail
