#pragma once

#include <openvdb/openvdb.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>

#include "core/base/geometry.h"
#include "vdb/detail/bone_grids.h"
#include "vdb/grid/bone_model.h"

namespace spinaltap::test {

/// A level set of the values of `distance_mm` themselves, without any baking, over the voxels within `box_mm`.
inline openvdb::FloatGrid::Ptr made_sdf(const std::function<double(const Vec3&)>& distance_mm, const Box3& box_mm,
                                        double voxel_mm) {
  const double band_mm = 3.0 * voxel_mm;
  auto grid = openvdb::FloatGrid::create(static_cast<float>(band_mm));
  grid->setTransform(openvdb::math::Transform::createLinearTransform(voxel_mm));
  grid->setGridClass(openvdb::GRID_LEVEL_SET);
  grid->setName("sdf");
  auto accessor = grid->getAccessor();
  const auto low = openvdb::Coord::floor(detail::to_vdb(box_mm.min() / voxel_mm));
  const auto high = openvdb::Coord::ceil(detail::to_vdb(box_mm.max() / voxel_mm));
  for (const openvdb::Coord& voxel : openvdb::CoordBBox(low, high)) {
    const double value_mm = distance_mm(voxel_mm * Vec3(voxel.x(), voxel.y(), voxel.z()));
    if (std::abs(value_mm) < band_mm) {
      accessor.setValue(voxel, static_cast<float>(value_mm));
    } else {
      accessor.setValueOff(voxel, static_cast<float>(std::clamp(value_mm, -band_mm, band_mm)));
    }
  }
  grid->pruneGrid();
  return grid;
}

/// A bone of grids by formula; the CT numbers are 300 HU within the box.
inline BoneModel made_bone(const std::function<double(const Vec3&)>& distance_mm, const Box3& box_mm, double voxel_mm) {
  auto grids = std::make_shared<detail::BoneGrids>();
  grids->sdf = made_sdf(distance_mm, box_mm, voxel_mm);
  auto hu = openvdb::FloatGrid::create(-1024.0F);
  hu->setName("hu");
  hu->fill({openvdb::Coord::floor(detail::to_vdb(box_mm.min())), openvdb::Coord::ceil(detail::to_vdb(box_mm.max()))},
           300.0F);
  grids->hu = hu;
  return BoneModel(grids);
}

}  // namespace spinaltap::test
