#include <algorithm>
#include <cstring>
#include <fstream>
#include <map>
#include <optional>
#include <string_view>

#include "apps/spinaltap/command.h"
#include "core/base/error.h"

namespace spinaltap {
namespace {

namespace fs = std::filesystem;

/// What an argument is to be, or is by its first bytes.
enum class InputKind { bone, plan, study, record, ct, mesh, folder, text };

struct Input {
  std::string argument;  ///< as help calls it
  fs::path path;
  InputKind wanted;
  InputKind found;
  bool fits() const { return found == wanted || (wanted == InputKind::ct && found == InputKind::folder); }
};

constexpr std::size_t kLooked = 4096;

std::string described(const Input& input, std::string_view content) {
  switch (input.found) {
    case InputKind::bone:
      return "a bone (.vdb)";
    case InputKind::plan:
      return "a plan";
    case InputKind::study:
      return "a study";
    case InputKind::record:
      return "a recorded drilling";
    case InputKind::ct:
      return "a CT or a label map; spinaltap bake makes a bone of a CT";
    case InputKind::mesh:
      return "a mesh";
    case InputKind::folder:
      return fs::exists(input.path / "bone.vdb") ? "a folder; did you mean " + (input.path / "bone.vdb").string() + "?"
                                                 : "a folder; spinaltap bake makes a bone of a CT";
    case InputKind::text:
      break;
  }
  return "JSON of another format, " + std::string(content.substr(0, content.find('"')));
}

/// What the value of a key "format" is, and all that follows; empty without one.
std::string_view format_in(std::string_view json) {
  const std::size_t key = json.find("\"format\"");
  if (key == std::string_view::npos) return {};
  const std::size_t quote = json.find('"', key + std::strlen("\"format\""));
  return quote == std::string_view::npos ? std::string_view() : json.substr(quote + 1);
}

std::string first_bytes(const fs::path& path) {
  std::string bytes(kLooked, '\0');
  std::ifstream file(path, std::ios::binary);
  file.read(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  bytes.resize(static_cast<std::size_t>(std::max<std::streamsize>(file.gcount(), 0)));
  return bytes;
}

/// Nothing where the content does not tell for sure: readers say then what they miss.
std::optional<InputKind> kind_of(const fs::path& path, std::string_view bytes) {
  using namespace std::string_view_literals;
  std::error_code error;
  if (fs::is_directory(path, error)) return InputKind::folder;
  if (bytes.starts_with(" BDV\0\0\0\0"sv)) return InputKind::bone;  // OpenVDB's magic number
  if (bytes.starts_with("\x89HDF\r\n\x1a\n"sv)) return InputKind::record;
  if (bytes.starts_with("NRRD000"sv) || bytes.starts_with("\x5c\x01\0\0"sv)) return InputKind::ct;
  if (bytes.size() > 132 && bytes.substr(128, 4) == "DICM"sv) return InputKind::ct;
  if (bytes.starts_with("ply\n"sv) || bytes.starts_with("ply\r"sv) || bytes.starts_with("solid "sv)) {
    return InputKind::mesh;
  }
  const std::size_t begin = bytes.find_first_not_of(" \t\r\n");
  if (begin == std::string_view::npos || bytes[begin] != '{') return std::nullopt;
  const std::string_view format = format_in(bytes);
  if (format.starts_with("spinaltap-plan\"")) return InputKind::plan;
  if (format.starts_with("spinaltap-study\"")) return InputKind::study;
  if (format.starts_with("spinaltap-")) return InputKind::text;
  return std::nullopt;
}

/// Of arguments that must come in an order, or are easily taken for each other.
const std::map<std::string, InputKind>& wanted_kinds() {
  static const std::map<std::string, InputKind> kinds{{"bone", InputKind::bone},
                                                      {"plan", InputKind::plan},
                                                      {"record", InputKind::record},
                                                      {"ct", InputKind::ct},
                                                      {"spec", InputKind::study}};
  return kinds;
}

}  // namespace

void check_inputs(const CLI::App& app) {
  std::vector<Input> inputs;
  std::string wrong;
  for (const CLI::Option* option : app.get_options()) {
    const auto wanted = wanted_kinds().find(option->get_name(true));
    if (!option->get_positional() || option->count() == 0 || wanted == wanted_kinds().end()) continue;
    const fs::path path = option->as<fs::path>();
    std::error_code error;
    if (!fs::exists(path, error)) continue;
    const std::string bytes = fs::is_regular_file(path, error) ? first_bytes(path) : std::string();
    const std::optional<InputKind> found = kind_of(path, bytes);
    if (!found) continue;
    inputs.push_back({wanted->first, path, wanted->second, *found});
    if (inputs.back().fits()) continue;
    wrong += (wrong.empty() ? "" : "; ") + path.string() + " is " + described(inputs.back(), format_in(bytes));
  }
  if (wrong.empty()) return;
  // Two that are each other's.
  if (inputs.size() == 2 && inputs[0].wanted == inputs[1].found && inputs[1].wanted == inputs[0].found) {
    wrong += ": swap them";
  }
  fail("expected ", usage_of(app), ": ", wrong);
}

}  // namespace spinaltap
