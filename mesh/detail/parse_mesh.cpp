#include "mesh/detail/parse_mesh.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstring>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "core/base/error.h"
#include "core/base/file_stream.h"
#include "core/base/ply_elements.h"
#include "core/base/staged_output.h"
#include "core/base/text_fields.h"

namespace spinaltap::detail {
namespace {

namespace fs = std::filesystem;

/// Words of a line, one after the other.
class Words {
 public:
  explicit Words(std::string_view line) : rest_(line) {}
  std::string_view next() {
    constexpr std::string_view kBlanks = " \t\r";
    rest_.remove_prefix(std::min(rest_.find_first_not_of(kBlanks), rest_.size()));
    const std::string_view word = rest_.substr(0, rest_.find_first_of(kBlanks));
    rest_.remove_prefix(word.size());
    return word;
  }

 private:
  std::string_view rest_;
};

/// Gathers a mesh. `place()` says where in the file a vertex or face stands.
class MeshRows {
 public:
  template <class Place>
  void add_vertex(const std::array<double, 3>& p, const Place& place) {
    const Eigen::Vector3f vertex = Eigen::Vector3d(p[0], p[1], p[2]).cast<float>();
    if (!vertex.allFinite()) fail("expected three coordinates, found one that is no number in ", place());
    if (mesh_.vertices_mm.size() == kMaxVertices) fail("expected fewer than 2^31 vertices, found more in ", place());
    mesh_.vertices_mm.push_back(vertex);
  }

  /// As add_vertex(), without a second one where there is one; returns its number.
  template <class Place>
  double add_once(const std::array<double, 3>& p, const Place& place) {
    add_vertex(p, place);
    // 0 and -0 are one place.
    const Eigen::Vector3f vertex = mesh_.vertices_mm.back() + Eigen::Vector3f::Zero();
    std::array<std::uint32_t, 3> key{};
    std::memcpy(key.data(), vertex.data(), sizeof key);
    const auto [found, is_new] = numbers_.try_emplace(key, mesh_.vertices_mm.size() - 1);
    if (!is_new) mesh_.vertices_mm.pop_back();
    return static_cast<double>(found->second);
  }

  /// `corners`: numbers of vertices from 0 on, also of those to come.
  template <class Place>
  void add_face(std::span<const double> corners, const Place& place) {
    if (corners.size() < 3) fail("expected a face of three corners or more, found ", corners.size(), " in ", place());
    std::vector<std::uint32_t> numbers;
    for (const double corner : corners) {
      if (!(corner >= 0.0 && corner < static_cast<double>(kMaxVertices)) || corner != std::floor(corner)) {
        fail("expected a vertex's number, found ", corner, " in ", place());
      }
      numbers.push_back(static_cast<std::uint32_t>(corner));
      max_corner_ = std::max(max_corner_, numbers.back());
    }
    for (std::size_t n = 1; n + 1 < numbers.size(); ++n) {
      const std::array<std::uint32_t, 3> triangle{numbers[0], numbers[n], numbers[n + 1]};
      if (triangle[0] == triangle[1] || triangle[1] == triangle[2] || triangle[2] == triangle[0]) continue;
      mesh_.triangles.push_back(triangle);
    }
  }

  std::size_t vertex_count() const { return mesh_.vertices_mm.size(); }

  TriangleMesh take(const std::string& name) {
    if (mesh_.triangles.empty()) fail("cannot read triangles from ", name, ": found none");
    if (max_corner_ >= mesh_.vertices_mm.size()) {
      fail("cannot read ", name, ": a corner is vertex ", max_corner_ + 1, ", and there are ",
           mesh_.vertices_mm.size());
    }
    return std::move(mesh_);
  }

 private:
  struct KeyHash {
    std::size_t operator()(const std::array<std::uint32_t, 3>& key) const {
      std::size_t hash = 0;
      for (const std::uint32_t word : key) {
        hash = (hash ^ word) * 0x9e3779b97f4a7c15ULL;
        hash ^= hash >> 32;
      }
      return hash;
    }
  };
  static constexpr std::size_t kMaxVertices = std::size_t{1} << 31;

  TriangleMesh mesh_;
  std::uint32_t max_corner_ = 0;
  std::unordered_map<std::array<std::uint32_t, 3>, std::size_t, KeyHash> numbers_;
};

std::array<double, 3> three_numbers(Words& words, const TextLines& lines) {
  std::array<double, 3> numbers{};
  for (double& number : numbers) {
    const std::string_view word = words.next();
    const std::optional<double> found = parse_number(word);
    if (!found) fail("expected three numbers, found ", in_quotes(word), " in ", lines.place());
    number = *found;
  }
  return numbers;
}

TriangleMesh parse_binary_stl(const fs::path& path) {
  FileReader file(path);
  std::string_view head;
  file.bytes(84, head);
  std::uint32_t count = 0;
  std::memcpy(&count, head.data() + 80, sizeof count);
  MeshRows rows;
  for (std::uint32_t n = 0; n < count; ++n) {
    const auto place = [&] { return file.name() + ", triangle " + std::to_string(n + 1); };
    std::string_view bytes;
    if (!file.bytes(50, bytes)) fail("cannot read ", file.name(), ": cut short");
    std::array<float, 12> numbers{};  // a normal, three corners
    std::memcpy(numbers.data(), bytes.data(), sizeof numbers);
    std::array<double, 3> corners{};
    for (std::size_t c = 0; c < 3; ++c) {
      const float* const p = numbers.data() + 3 * (c + 1);
      corners[c] = rows.add_once({p[0], p[1], p[2]}, place);
    }
    rows.add_face(corners, place);
  }
  return rows.take(file.name());
}

TriangleMesh parse_text_stl(const fs::path& path) {
  FileReader file(path);
  TextLines lines(file);
  MeshRows rows;
  std::vector<double> corners;
  bool has_ended = false;
  for (std::string_view line; lines.next(line);) {
    Words words(line);
    const std::string_view word = words.next();
    const auto place = [&] { return lines.place(); };
    if (word == "vertex") {
      corners.push_back(rows.add_once(three_numbers(words, lines), place));
    } else if (word == "endloop") {
      rows.add_face(corners, place);
      corners.clear();
    } else if (word == "endsolid") {
      has_ended = true;
    }
  }
  if (!has_ended || !corners.empty()) fail("cannot read ", path.string(), ": cut short, or no STL file");
  return rows.take(path.string());
}

}  // namespace

TriangleMesh parse_stl(const fs::path& path) {
  constexpr std::size_t kHead = 80 + 4;
  constexpr std::uint64_t kTriangle = 50;
  const std::uint64_t size = regular_file_size(path);
  FileReader file(path);
  std::string_view head;
  if (file.bytes(kHead, head)) {
    std::uint32_t count = 0;
    std::memcpy(&count, head.data() + 80, sizeof count);
    if (size >= kHead + kTriangle * count) return parse_binary_stl(path);
    if (head.starts_with("solid")) return parse_text_stl(path);
  }
  fail("cannot read ", path.string(), ": cut short, or no STL file");
}

TriangleMesh parse_ply(const fs::path& path) {
  FileReader file(path);
  const PlyHead head = read_ply_head(file);
  MeshRows rows;
  std::vector<double> corners;
  for (const PlyElement& element : head.elements) {
    const auto property = [&](std::string_view name) {
      const auto found = std::find_if(element.properties.begin(), element.properties.end(),
                                      [&](const PlyProperty& one) { return one.name == name; });
      return static_cast<std::size_t>(found - element.properties.begin());
    };
    const std::size_t none = element.properties.size();
    const std::array<std::size_t, 3> at{property("x"), property("y"), property("z")};
    const std::size_t list = std::min(property("vertex_indices"), property("vertex_index"));
    const bool is_vertex = element.name == "vertex";
    if (!is_vertex && element.name != "face") {
      skip_ply_element(file, head.format, element);
      continue;
    }
    const auto is_number = [&](std::size_t p) { return p < none && !element.properties[p].count_type; };
    if (is_vertex && !std::all_of(at.begin(), at.end(), is_number)) {
      fail("expected vertices with x, y and z, found others in ", file.name());
    }
    if (!is_vertex && (list == none || is_number(list))) {
      fail("expected faces with a list vertex_indices, found none in ", file.name());
    }
    check_ply_count(element, head.format, file);
    PlyElements elements(file, head.format);
    const auto place = [&] { return elements.place(); };
    for (std::uint64_t n = 0; n < element.count; ++n) {
      elements.begin(element, n);
      std::array<double, 3> p{};
      for (std::size_t one = 0; one < none; ++one) {
        const PlyProperty& read = element.properties[one];
        const auto* const axis = std::find(at.begin(), at.end(), one);
        if (is_vertex && axis != at.end()) {
          p[static_cast<std::size_t>(axis - at.begin())] = elements.number(read.type);
        } else if (!is_vertex && one == list) {
          elements.list(read, corners);
        } else {
          elements.skip(read);
        }
      }
      elements.end();
      if (is_vertex) {
        rows.add_vertex(p, place);
      } else {
        rows.add_face(corners, place);
      }
    }
  }
  return rows.take(file.name());
}

TriangleMesh parse_obj(const fs::path& path) {
  FileReader file(path);
  TextLines lines(file);
  MeshRows rows;
  std::vector<double> corners;
  for (std::string_view line; lines.next(line);) {
    Words words(line);
    const std::string_view kind = words.next();
    const auto place = [&] { return lines.place(); };
    if (kind == "v") {
      rows.add_vertex(three_numbers(words, lines), place);
    } else if (kind == "f") {
      corners.clear();
      for (std::string_view word = words.next(); !word.empty(); word = words.next()) {
        if (word == "\\") fail("expected a face on one line, found it going on in ", lines.place());
        const std::string_view number = word.substr(0, word.find('/'));
        std::int64_t corner = 0;
        const auto [end, error] = std::from_chars(number.data(), number.data() + number.size(), corner);
        if (error != std::errc{} || end != number.data() + number.size() || corner == 0) {
          fail("expected a vertex's number, found ", in_quotes(word), " in ", lines.place());
        }
        // Below 0: counted back from the last.
        const auto before = static_cast<double>(rows.vertex_count());
        corners.push_back(corner > 0 ? static_cast<double>(corner) - 1.0 : before + static_cast<double>(corner));
      }
      rows.add_face(corners, place);
    }
  }
  return rows.take(path.string());
}

TriangleMesh parse_off(const fs::path& path) {
  FileReader file(path);
  TextLines lines(file);
  std::string_view line;
  const auto next = [&] {
    for (;;) {
      if (!lines.next(line)) fail("cannot read ", path.string(), ": cut short, or no OFF file");
      line = line.substr(0, line.find('#'));
      if (!trimmed(line).empty()) return Words(line);
    }
  };
  Words words = next();
  const std::string_view kind = words.next();
  // Before it: what stands behind a vertex's coordinates.
  constexpr std::array<std::string_view, 8> kKinds{"OFF",   "COFF",  "NOFF",   "NCOFF",
                                                   "CNOFF", "STOFF", "STCOFF", "STNOFF"};
  if (std::find(kKinds.begin(), kKinds.end(), kind) == kKinds.end() || words.next() == "BINARY") {
    fail("expected an OFF file of text, found another: ", path.string());
  }
  words = next();
  const std::array<double, 3> counts = three_numbers(words, lines);
  // A vertex takes six bytes, a face eight.
  const auto bytes = static_cast<double>(file.max_bytes_left());
  if (!(counts[0] >= 0.0 && counts[1] >= 0.0 && 6.0 * counts[0] + 8.0 * counts[1] <= bytes + 2.0)) {
    fail("expected ", counts[0], " vertices and ", counts[1], " faces, found no room for them (cut short?) in ",
         path.string());
  }
  MeshRows rows;
  const auto place = [&] { return lines.place(); };
  for (double n = 0.0; n < counts[0]; n += 1.0) {
    words = next();
    rows.add_vertex(three_numbers(words, lines), place);
  }
  std::vector<double> corners;
  for (double n = 0.0; n < counts[1]; n += 1.0) {
    words = next();
    const std::optional<double> count = parse_number(words.next());
    if (!count || !(*count <= static_cast<double>(line.size()))) {
      fail("expected a face's corners, found others in ", lines.place());
    }
    corners.clear();
    for (double c = 0.0; c < *count; c += 1.0) {
      const std::optional<double> corner = parse_number(words.next());
      if (!corner) fail("expected a face's corners, found fewer in ", lines.place());
      corners.push_back(*corner);
    }
    rows.add_face(corners, place);
  }
  return rows.take(path.string());
}

}  // namespace spinaltap::detail
