#include "core/anatomy/detail/landmark_warnings.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <numbers>

#include "core/base/error.h"
#include "core/base/geometry.h"
#include "core/base/text_writer.h"

namespace spinaltap {
namespace {

template <class... Parts>
std::string line(const Parts&... parts) {
  TextWriter text(3);
  (text << ... << parts);
  return text.str();
}

class Warnings {
 public:
  void expect(const std::string& what, double value, double low, double high, const char* unit) {
    if (value >= low && value <= high) return;
    lines_.push_back(line(what, " is ", value, " ", unit, ", expected ", low, " to ", high, " ", unit));
  }
  void add(std::string text) { lines_.push_back(std::move(text)); }
  const std::vector<std::string>& lines() const { return lines_; }

 private:
  std::vector<std::string> lines_;
};

void warn_of_pedicle(Warnings& warnings, const Landmarks& found, const PedicleLandmarks& pedicle, double side) {
  const std::string name = side > 0.0 ? "the left pedicle's " : "the right pedicle's ";
  const Vec3 isthmus = found.to_own(pedicle.isthmus_mm), axis = found.axes.transpose() * pedicle.axis;
  warnings.expect(name + "width", pedicle.width_mm, 2.0, 20.0, "mm");
  warnings.expect(name + "height", pedicle.height_mm, 5.0, 22.0, "mm");
  warnings.expect(name + "distance from the midsagittal plane", side * isthmus.x(), 5.0, 30.0, "mm");
  const double convergence = std::atan2(-side * axis.x(), -axis.y()) * 180.0 / std::numbers::pi;
  warnings.expect(name + "convergence", convergence, -15.0, 45.0, "degrees");
  warnings.expect(name + "tilt", std::asin(axis.z()) * 180.0 / std::numbers::pi, -30.0, 30.0, "degrees");
}

}  // namespace

CutFace find_cut_face(const SurfaceSample& surface) {
  constexpr std::size_t kMaxTried = 1000;
  constexpr double kFlatMm = 0.15, kBeyondMm = 0.5, kBelowMm = 2.0;
  constexpr double kMaxBeyondShare = 0.002;                   // what noise may leave there
  const double flat = std::cos(0.07), bent = std::cos(0.21);  // 4 and 12 degrees
  const std::size_t count = surface.points_mm.size();
  const std::size_t step = std::max<std::size_t>(1, count / kMaxTried);
  std::vector<CutFace> faces(count / step);
  tbb::parallel_for(std::size_t{0}, faces.size(), [&](std::size_t n) {
    const Vec3& p_mm = surface.points_mm[n * step];
    const Vec3& normal = surface.normals[n * step];
    double area_mm2 = 0.0, bent_mm2 = 0.0;
    std::size_t beyond = 0;
    for (std::size_t i = 0; i < count; ++i) {
      const double height_mm = normal.dot(surface.points_mm[i] - p_mm);
      if (height_mm > kBeyondMm) ++beyond;
      if (height_mm < -kBelowMm) continue;
      const double likeness = normal.dot(surface.normals[i]);
      if (std::abs(height_mm) < kFlatMm && likeness > flat) {
        area_mm2 += surface.areas_mm2[i];
      } else if (likeness > bent) {
        bent_mm2 += surface.areas_mm2[i];
      }
    }
    // A cut ends at an edge. Where a surface is only little curved, as an endplate, eight times as much of it is bent
    // by 4 to 12 degrees as by less.
    const bool has_edge = bent_mm2 < area_mm2;
    if (has_edge && static_cast<double>(beyond) <= kMaxBeyondShare * static_cast<double>(count)) {
      faces[n] = {area_mm2, normal};
    }
  });
  CutFace largest;
  for (const CutFace& face : faces) {
    if (face.area_mm2 > largest.area_mm2) largest = face;
  }
  return largest;
}

std::vector<double> piece_volumes_mm3(const BoneShape& bone) {
  // Every second sample of the lattice: pieces that less than 1 mm of bone joins count as apart.
  constexpr int kStep = 2;
  const FloatGrid& lattice = bone.lattice();
  GridGeometry coarse = lattice.geometry;
  for (int& size : coarse.size) size = (size + kStep - 1) / kStep;
  std::vector<std::uint8_t> waits(coarse.voxel_count());
  tbb::parallel_for(0, coarse.size[2], [&](int k) {
    for (int j = 0; j < coarse.size[1]; ++j) {
      for (int i = 0; i < coarse.size[0]; ++i) {
        waits[coarse.offset(i, j, k)] = lattice.at(kStep * i, kStep * j, kStep * k) < 0.0F ? 1 : 0;
      }
    }
  });
  const double voxel_mm3 = std::pow(kStep * BoneShape::kLatticeMm, 3);
  std::vector<double> volumes_mm3;
  std::vector<std::array<int, 3>> front;
  for (int k = 0; k < coarse.size[2]; ++k) {
    for (int j = 0; j < coarse.size[1]; ++j) {
      for (int i = 0; i < coarse.size[0]; ++i) {
        if (waits[coarse.offset(i, j, k)] == 0) continue;
        std::size_t voxels = 0;
        waits[coarse.offset(i, j, k)] = 0;
        front.push_back({i, j, k});
        while (!front.empty()) {
          const std::array<int, 3> at = front.back();
          front.pop_back();
          ++voxels;
          for (std::size_t way = 0; way < 6; ++way) {
            std::array<int, 3> next = at;
            next[way / 2] += way % 2 == 0 ? 1 : -1;
            if (!coarse.contains(next[0], next[1], next[2])) continue;
            std::uint8_t& is_waiting = waits[coarse.offset(next[0], next[1], next[2])];
            if (is_waiting == 0) continue;
            is_waiting = 0;
            front.push_back(next);
          }
        }
        volumes_mm3.push_back(voxel_mm3 * static_cast<double>(voxels));
      }
    }
  }
  std::sort(volumes_mm3.begin(), volumes_mm3.end(), std::greater<>());
  return volumes_mm3;
}

const char* side_of_patient(const Vec3& direction) {
  Eigen::Index axis = 0;
  direction.cwiseAbs().maxCoeff(&axis);
  constexpr std::array<const char*, 3> kUp{"left", "back", "top"}, kDown{"right", "front", "bottom"};
  return (direction[axis] > 0.0 ? kUp : kDown)[static_cast<std::size_t>(axis)];
}

std::vector<std::string> warnings_about(const Landmarks& found, double asymmetry_mm, const CutFace& cut_face) {
  constexpr double kCutMm2 = 25.0;
  Warnings warnings;
  if (cut_face.area_mm2 >= kCutMm2) {
    warnings.add(line("the bone ends at the patient's ", side_of_patient(cut_face.normal), " in a flat face of ",
                      cut_face.area_mm2, " mm²: something is cut off there"));
  }
  warn_of_pedicle(warnings, found, found.left_pedicle, 1.0);
  warn_of_pedicle(warnings, found, found.right_pedicle, -1.0);
  warnings.expect("the left pedicle's width over the right one's",
                  found.left_pedicle.width_mm / found.right_pedicle.width_mm, 0.6, 1.7, "");
  const Landmarks::Body& body = found.body;
  warnings.expect("the body's width", body.width_mm, 18.0, 70.0, "mm");
  warnings.expect("the body's depth", body.depth_mm, 12.0, 50.0, "mm");
  warnings.expect("the body's height", body.height_mm, 10.0, 42.0, "mm");
  warnings.expect("the body's height over its depth", body.height_mm / body.depth_mm, 0.45, 1.4, "");
  warnings.expect("the angle between the endplates", angle_between_rad(body.upper.normal, -body.lower.normal) / kDegree,
                  0.0, 25.0, "degrees");
  warnings.expect("the angle between the canal and the endplates' normals",
                  angle_between_rad(found.canal.axis, found.superior()) / kDegree, 0.0, 25.0, "degrees");
  warnings.expect("the canal's width", found.canal.width_mm, 10.0, 35.0, "mm");
  warnings.expect("the canal's depth", found.canal.depth_mm, 8.0, 30.0, "mm");
  warnings.expect("the distance between the surface and its mirror image", asymmetry_mm, 0.0, 1.5, "mm");
  return warnings.lines();
}

}  // namespace spinaltap
