// openvdb_grids BONE SURFACE: a baked bone in a program of OpenVDB alone, which knows nothing of SpinalTap. Meshes the
// level set `sdf` to an OBJ file, and prints volume and area of the bone and the CT numbers 2 mm below its surface.
#include <openvdb/openvdb.h>
#include <openvdb/tools/GridOperators.h>
#include <openvdb/tools/Interpolation.h>
#include <openvdb/tools/LevelSetMeasure.h>
#include <openvdb/tools/VolumeToMesh.h>

#include <algorithm>
#include <cstdio>
#include <exception>
#include <fstream>
#include <vector>

namespace {

openvdb::FloatGrid::Ptr read_grid(openvdb::io::File& file, const char* name) {
  return openvdb::gridPtrCast<openvdb::FloatGrid>(file.readGrid(name));
}

/// CT numbers (HU) at a depth (mm) below each point, along the distance's gradient.
std::vector<float> hu_below(const openvdb::FloatGrid& sdf, const openvdb::FloatGrid& hu,
                            const std::vector<openvdb::Vec3s>& points_mm, double depth_mm) {
  const openvdb::VectorGrid::ConstPtr outward = openvdb::tools::gradient(sdf);
  const openvdb::tools::GridSampler<openvdb::VectorGrid, openvdb::tools::BoxSampler> normals(*outward);
  const openvdb::tools::GridSampler<openvdb::FloatGrid, openvdb::tools::BoxSampler> numbers(hu);
  std::vector<float> found;
  for (const openvdb::Vec3s& point_mm : points_mm) {
    openvdb::Vec3d normal = normals.wsSample(point_mm);
    if (normal.normalize()) found.push_back(numbers.wsSample(openvdb::Vec3d(point_mm) - depth_mm * normal));
  }
  std::ranges::sort(found);
  return found;
}

}  // namespace

int main(int count, char** arguments) {
  if (count != 3) return 2;
  try {
    openvdb::initialize();
    openvdb::io::File file(arguments[1]);
    file.open();
    const openvdb::FloatGrid::Ptr sdf = read_grid(file, "sdf");  // mm, negative inside; patient LPS, mm
    const openvdb::FloatGrid::Ptr hu = read_grid(file, "hu");    // its voxels are those of the CT

    std::vector<openvdb::Vec3s> points_mm;
    std::vector<openvdb::Vec4I> faces;
    openvdb::tools::volumeToMesh(*sdf, points_mm, faces, 0.0);
    std::ofstream mesh(arguments[2]);
    for (const openvdb::Vec3s& p : points_mm) mesh << "v " << p.x() << ' ' << p.y() << ' ' << p.z() << '\n';
    // OpenVDB winds faces inward; OBJ counts from 1.
    for (const openvdb::Vec4I& f : faces) {
      mesh << "f " << f[3] + 1 << ' ' << f[2] + 1 << ' ' << f[1] + 1 << ' ' << f[0] + 1 << '\n';
    }
    if (!mesh.flush()) throw std::runtime_error(std::string(arguments[2]) + " cannot be written");

    const std::vector<float> below = hu_below(*sdf, *hu, points_mm, 2.0);
    if (below.empty()) throw std::runtime_error("no surface");
    std::printf("%zu points, %zu faces\n", points_mm.size(), faces.size());
    std::printf("volume %.1f mm3, area %.1f mm2\n", openvdb::tools::levelSetVolume(*sdf),
                openvdb::tools::levelSetArea(*sdf));
    std::printf("2 mm below the surface: median %.0f HU, from %.0f to %.0f\n", double{below[below.size() / 2]},
                double{below.front()}, double{below.back()});
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
}
