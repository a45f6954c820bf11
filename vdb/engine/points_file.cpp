#include "vdb/engine/points_file.h"

#include <openvdb/openvdb.h>
#include <openvdb/points/AttributeArray.h>
#include <openvdb/points/PointAttribute.h>
#include <openvdb/points/PointConversion.h>
#include <openvdb/points/PointDataGrid.h>
#include <openvdb/tools/PointIndexGrid.h>

#include "core/base/error.h"
#include "core/base/staged_output.h"
#include "core/points/occupied_bits.h"
#include "vdb/detail/bone_grids.h"
#include "vdb/detail/vdb_file.h"

namespace spinaltap {
namespace {

namespace points = openvdb::points;
using openvdb::tools::PointIndexGrid;
using points::PointDataGrid;

constexpr const char* kGridName = "points";
constexpr const char* kHu = "hu";
constexpr const char* kDensity = "density";

struct OccupiedPoints {
  std::vector<openvdb::Vec3R> positions_mm;
  std::vector<int> hu;
};

OccupiedPoints occupied_points(const PointVolume& volume) {
  OccupiedPoints occupied;
  const std::size_t count = volume.occupied_count();
  occupied.positions_mm.reserve(count);
  occupied.hu.reserve(count);
  for (int disc = 0; disc < volume.disc_count(); ++disc) {
    visit_up(volume.occupancy_words(disc).data(), 0, volume.pattern().point_count(), [&](std::size_t index) {
      occupied.positions_mm.push_back(detail::to_vdb(volume.frame().to_patient(volume.point_in_path_mm(disc, index))));
      occupied.hu.push_back(volume.hu(disc, index));
      return true;
    });
  }
  return occupied;
}

template <class Value>
void add_attribute(PointDataGrid& grid, const PointIndexGrid& index, const char* name,
                   const std::vector<Value>& values) {
  points::appendAttribute<Value>(grid.tree(), name);
  points::populateAttribute(grid.tree(), index.tree(), name, points::PointAttributeVector<Value>(values));
}

PointDataGrid::Ptr make_grid(const OccupiedPoints& occupied, const PointVolume& volume,
                             const PointsFileOptions& options) {
  // About eight points to a voxel, as OpenVDB advises. The origin lies in the volume, so that indices are small.
  const auto transform = openvdb::math::Transform::createLinearTransform(2.0 * volume.pattern().spacing_mm());
  transform->postTranslate(detail::to_vdb(volume.frame().to_patient(Vec3::Zero())));
  const points::PointAttributeVector<openvdb::Vec3R> positions(occupied.positions_mm);
  const auto index = openvdb::tools::createPointIndexGrid<PointIndexGrid>(positions, *transform);
  auto grid = points::createPointDataGrid<points::FixedPointCodec<false, points::PositionRange>, PointDataGrid>(
      *index, positions, *transform);
  grid->setName(kGridName);
  add_attribute(*grid, *index, kHu, occupied.hu);
  if (options.density) {
    std::vector<float> density;
    density.reserve(occupied.hu.size());
    for (const int hu : occupied.hu) density.push_back(static_cast<float>(options.density->density_g_cm3(hu)));
    add_attribute(*grid, *index, kDensity, density);
  }
  return grid;
}

void add_metadata(PointDataGrid& grid, const PointVolume& volume, const DrillPath& path) {
  const auto add = [&](const char* key, const openvdb::Metadata& value) {
    grid.insertMeta(std::string(detail::kMetadataPrefix) + key, value);
  };
  const double spacing_mm = volume.pattern().spacing_mm();
  add("path", openvdb::StringMetadata(path.name));
  add("entry_mm", openvdb::Vec3DMetadata(detail::to_vdb(path.entry_mm)));
  add("target_mm", openvdb::Vec3DMetadata(detail::to_vdb(path.target_mm)));
  add("spacing_mm", openvdb::DoubleMetadata(spacing_mm));
  add("radius_mm", openvdb::DoubleMetadata(volume.pattern().ring_count() * spacing_mm));
}

/// Calls read(handle, place) for each point of the leaf. Throws Error where the leaf has no such attribute.
template <class Value, class Read>
void read_attribute(const PointDataGrid::TreeType::LeafNodeType& leaf, const char* name, const Read& read) {
  const points::AttributeArray* array = leaf.attributeSet().getConst(name);
  if (array == nullptr || array->valueType() != openvdb::typeNameAsString<Value>()) {
    fail("expected the attribute ", name, " of type ", openvdb::typeNameAsString<Value>());
  }
  const points::AttributeHandle<Value> handle(*array);
  for (auto point = leaf.beginIndexOn(); point; ++point) read(handle.get(*point), point);
}

}  // namespace

void write_points(const PointVolume& volume, const DrillPath& path, const std::filesystem::path& file,
                  const PointsFileOptions& options) {
  initialize_openvdb();
  const OccupiedPoints occupied = occupied_points(volume);
  const PointDataGrid::Ptr grid = make_grid(occupied, volume, options);
  add_metadata(*grid, volume, path);
  StagedOutput output;
  const std::filesystem::path staged = output.stage(file);
  try {
    detail::write_vdb(staged, {grid});
    // OpenVDB does not look whether its last bytes reached the disk; reading them back does.
    detail::VdbFile(staged).read_points(kGridName);
  } catch (const std::exception&) {
    fail_as(ErrorKind::disk, "cannot write ", file.string(), ": is the disk full, or the folder not writable?");
  }
  output.commit();
}

SavedPoints read_points(const std::filesystem::path& file) {
  detail::VdbFile in(file);
  if (!in.has(kGridName)) fail("expected a grid of points named ", kGridName, " in ", file.string());
  const PointDataGrid::Ptr grid = in.read_points(kGridName);
  SavedPoints saved;
  const std::string prefix = detail::kMetadataPrefix;
  for (auto meta = grid->beginMeta(); meta != grid->endMeta(); ++meta) {
    if (meta->first.rfind(prefix, 0) == 0) saved.metadata[meta->first.substr(prefix.size())] = meta->second->str();
  }
  try {
    for (auto leaf = grid->tree().cbeginLeaf(); leaf; ++leaf) {
      read_attribute<openvdb::Vec3f>(*leaf, "P", [&](const openvdb::Vec3f& in_voxel, const auto& point) {
        const openvdb::Vec3d p_index = openvdb::Vec3d(in_voxel) + point.getCoord().asVec3d();
        saved.positions_mm.push_back(detail::from_vdb(grid->transform().indexToWorld(p_index)));
      });
      read_attribute<int>(*leaf, kHu, [&](int hu, const auto&) { saved.hu.push_back(hu); });
      if (leaf->attributeSet().getConst(kDensity) == nullptr) continue;
      read_attribute<float>(*leaf, kDensity, [&](float value, const auto&) { saved.density_g_cm3.push_back(value); });
    }
  } catch (const std::exception& error) {
    fail("cannot read ", file.string(), ": ", detail::printable(error.what()));
  }
  return saved;
}

}  // namespace spinaltap
