#include "core/ct/detail/header_lines.h"

#include <charconv>
#include <fstream>

#include "core/base/error.h"
#include "core/base/text_fields.h"

namespace spinaltap::detail {

namespace fs = std::filesystem;

std::string read_header_bytes(const fs::path& file) {
  constexpr std::size_t kMaxHeader = std::size_t{1} << 20;
  std::error_code error;
  if (!fs::exists(file, error)) fail_as(ErrorKind::file, "no such file: ", file.string());
  if (!fs::is_regular_file(file, error)) fail("expected a file, found something else: ", file.string());
  std::ifstream stream(file, std::ios::binary);
  if (!stream.is_open()) fail_as(ErrorKind::file, "cannot open ", file.string());
  std::string bytes(kMaxHeader, '\0');
  stream.read(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  bytes.resize(static_cast<std::size_t>(stream.gcount()));
  return bytes;
}

void put_field(std::map<std::string, std::string, std::less<>>& fields, const std::string& name, std::string_view value,
               const char* format, const fs::path& file) {
  const auto [at, is_new] = fields.emplace(name, value);
  if (is_new || at->second == value) return;
  fail("expected ", format, " field ", in_quotes(name), " once, found ", in_quotes(at->second), " and ",
       in_quotes(value), " in ", file.string());
}

std::vector<std::string> words_of(std::string_view text) {
  std::vector<std::string> words;
  bool in_word = false;
  for (const char c : text) {
    const bool is_blank = c == ' ' || c == '\t' || c == '\r';
    if (!is_blank && !in_word) words.emplace_back();
    if (!is_blank) words.back() += c;
    in_word = !is_blank;
  }
  return words;
}

std::optional<long long> whole_number(std::string_view text) {
  long long number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc{} || end != text.data() + text.size()) return std::nullopt;
  return number;
}

std::array<int, 3> three_sizes(const std::vector<long long>& sizes, const std::string& axes, const std::string& text,
                               const fs::path& file) {
  constexpr long long kMaxVoxels = 1LL << 30;
  long long voxels = 1;
  for (const long long size : sizes) {
    if (size < 1 || size > kMaxVoxels / voxels) {
      fail("expected at most ", kMaxVoxels, " voxels, found ", axes, " of ", in_quotes(text), " in ", file.string());
    }
    voxels *= size;
  }
  if (sizes.size() != 3) fail("expected three ", axes, ", found ", sizes.size(), " in ", file.string());
  return {static_cast<int>(sizes[0]), static_cast<int>(sizes[1]), static_cast<int>(sizes[2])};
}

fs::path beside(const fs::path& header, const std::string& name) {
  const fs::path path(name);
  return path.is_absolute() ? path : header.parent_path() / path;
}

std::vector<fs::path> numbered_files(const fs::path& header, const std::string& pattern, long long first,
                                     long long last, long long step) {
  constexpr long long kMaxFiles = 100'000;
  constexpr std::size_t kMaxWidth = 18;
  const std::size_t percent = pattern.find('%');
  const std::size_t letter = pattern.find('d', percent);
  const bool is_one = percent != std::string::npos && letter != std::string::npos &&
                      pattern.find('%', percent + 1) == std::string::npos;
  std::string width = is_one ? pattern.substr(percent + 1, letter - percent - 1) : "";
  const bool has_zeros = width.starts_with('0');
  const std::optional<long long> digits = width.empty() ? 0 : whole_number(width);
  if (!is_one || !digits || *digits < 0 || static_cast<std::size_t>(*digits) > kMaxWidth) {
    fail("expected a name with one number in it, such as slice%03d.raw, found ", in_quotes(pattern), " in ",
         header.string());
  }
  const bool leads = step != 0 && (step > 0) == (last >= first || first == last) && first >= 0 && last >= 0 &&
                     std::max(first, last) < (1LL << 40) && std::abs(step) < (1LL << 40);
  if (!leads || (last - first) / step >= kMaxFiles) {
    fail("expected files from a number to another in steps, found ", first, " to ", last, " in steps of ", step, " in ",
         header.string());
  }
  std::vector<fs::path> files;
  for (long long number = first; step > 0 ? number <= last : number >= last; number += step) {
    std::string text = std::to_string(number);
    const auto wanted = static_cast<std::size_t>(*digits);
    if (text.size() < wanted) text.insert(0, wanted - text.size(), has_zeros ? '0' : ' ');
    files.push_back(beside(header, pattern.substr(0, percent) + text + pattern.substr(letter + 1)));
  }
  return files;
}

}  // namespace spinaltap::detail
