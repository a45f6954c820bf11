#include "core/phantom/true_labels.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>

namespace spinaltap {
namespace {

/// Voxels [low, high) by column, row and slice.
struct Block {
  std::array<int, 3> low, high;
};

/// Calls `visit` with each voxel that the body may hold: halves blocks whose middle lies nearer to it than their
/// corners.
template <class Value, class Visit>
void visit_near(const GridGeometry& geometry, const Block& block, const Value& value_mm, const Visit& visit) {
  std::array<int, 3> size{};
  Vec3 middle;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    size[axis] = block.high[axis] - block.low[axis];
    middle[static_cast<Eigen::Index>(axis)] = 0.5 * (block.low[axis] + block.high[axis] - 1);
  }
  if (std::min({size[0], size[1], size[2]}) <= 0) return;
  const double reach =
      0.5 * Vec3(size[0] - 1, size[1] - 1, size[2] - 1).cwiseProduct(geometry.spacing_mm).norm() + 1e-9;
  if (value_mm(geometry.to_patient(middle)) > reach) return;
  const auto longest = static_cast<std::size_t>(std::max_element(size.begin(), size.end()) - size.begin());
  if (size[longest] == 1) {
    visit(block.low[0], block.low[1], block.low[2]);
    return;
  }
  Block first = block, second = block;
  first.high[longest] = second.low[longest] = block.low[longest] + size[longest] / 2;
  visit_near(geometry, first, value_mm, visit);
  visit_near(geometry, second, value_mm, visit);
}

}  // namespace

LabelVolume true_labels(const Spine& spine, const GridGeometry& geometry) {
  check_geometry(geometry, "true labels");
  LabelVolume volume{geometry, std::vector<std::uint8_t>(geometry.voxel_count(), 0), {}};
  const auto value_mm = [&](const Vec3& p) {
    double value = 0.0;
    spine.evaluate({&p, 1}, {&value, 1}, {});
    return value;
  };
  constexpr int kSlab = 4;
  const int slabs = (geometry.size[2] + kSlab - 1) / kSlab;
  tbb::parallel_for(0, slabs, [&](int slab) {
    const Block block{{0, 0, slab * kSlab},
                      {geometry.size[0], geometry.size[1], std::min((slab + 1) * kSlab, geometry.size[2])}};
    visit_near(geometry, block, value_mm, [&](int i, int j, int k) {
      volume.labels[geometry.offset(i, j, k)] = spine.label_at(geometry.to_patient(Vec3(i, j, k)));
    });
  });
  std::array<bool, 256> occurs{};
  for (const std::uint8_t label : volume.labels) occurs[label] = true;
  for (int label = 1; label < 256; ++label) {
    if (!occurs[static_cast<std::size_t>(label)]) continue;
    if (label == kRibLabel) {
      volume.names[label] = {"rib", Level::kNone};
    } else if (label == kOtherBoneLabel) {
      volume.names[label] = {"other bone", Level::kNone};
    } else {
      const Level level = level_from_number(label).value_or(Level::kNone);
      volume.names[label] = {level == Level::kNone ? std::string() : level_name(level), level};
    }
  }
  return volume;
}

}  // namespace spinaltap
