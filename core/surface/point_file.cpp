#include "core/surface/point_file.h"

#include <array>
#include <bit>
#include <cstring>

#include "core/base/error.h"
#include "core/base/ply_head.h"
#include "core/base/staged_output.h"

namespace spinaltap {

void write_points(const SurfaceSamples& samples, const std::filesystem::path& path) {
  static_assert(std::endian::native == std::endian::little, "the file is little endian");
  const std::size_t count = samples.positions_mm.size();
  if (samples.normals.size() != count || samples.values_mm.size() != count) {
    fail("points: expected a normal and a value for each of ", count, " points");
  }
  PlyHead head{.comments = {"mm, patient LPS; value: signed distance from the surface, mm, negative inside"},
               .elements = {{"vertex", count}}};
  for (const char* name : {"x", "y", "z", "nx", "ny", "nz", "value"}) head.elements[0].properties.push_back({name});
  std::string bytes = encode(head);
  const std::size_t head_size = bytes.size();
  constexpr std::size_t kPointBytes = 7 * sizeof(float);
  bytes.resize(head_size + count * kPointBytes);
  for (std::size_t i = 0; i < count; ++i) {
    std::array<float, 7> point{};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      point[axis] = static_cast<float>(samples.positions_mm[i][static_cast<Eigen::Index>(axis)]);
      point[3 + axis] = static_cast<float>(samples.normals[i][static_cast<Eigen::Index>(axis)]);
    }
    point[6] = static_cast<float>(samples.values_mm[i]);
    std::memcpy(bytes.data() + head_size + i * kPointBytes, point.data(), kPointBytes);
  }
  write_whole_file(path, bytes);
}

}  // namespace spinaltap
