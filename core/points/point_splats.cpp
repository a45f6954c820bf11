#include "core/points/point_splats.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

#include "core/base/error.h"
#include "core/base/hu_colour.h"
#include "core/base/text_writer.h"

namespace spinaltap {
namespace {

/// Of the shortest distance: what lies beside a point, also aslant.
constexpr double kBesideSpacings = 1.5;

std::vector<double> values_at(const ScalarField& bone, std::span<const Vec3> points_mm, std::vector<Vec3>& gradients) {
  std::vector<double> values(points_mm.size());
  gradients.resize(points_mm.size());
  bone.evaluate(points_mm, values, gradients);
  return values;
}

/// From the wall towards the bit; on its axis towards the base.
Vec3 towards_bit(const BitProfile& bit, const Pose& pose, const Vec3& p_mm) {
  constexpr double kStepMm = 1e-3;
  Vec3 slope;
  for (int axis = 0; axis < 3; ++axis) {
    const Vec3 step_mm = kStepMm * Vec3::Unit(axis);
    slope[axis] = bit_distance_mm(bit, pose, p_mm + step_mm) - bit_distance_mm(bit, pose, p_mm - step_mm);
  }
  return slope.norm() > kStepMm ? Vec3(-slope.normalized()) : Vec3(-pose.axis);
}

template <class Number>
void append(std::string& bytes, const Number& number) {
  bytes.append(reinterpret_cast<const char*>(&number), sizeof number);
}

}  // namespace

PointSplats::PointSplats(const PointVolume& volume, const ScalarField& bone)
    : splats_(volume.point_count()), occupied_(volume.occupancy_words().begin(), volume.occupancy_words().end()) {
  // Half a cube's diagonal: the farthest that a place of a surface is from the nearest point of a lattice.
  constexpr double kRadiusSpacings = 0.8661;
  const DiscPattern& pattern = volume.pattern();
  const std::size_t count = pattern.point_count();
  const double spacing_mm = pattern.spacing_mm();
  tbb::parallel_for(0, volume.disc_count(), [&](int disc) {
    std::vector<Vec3> points_mm(count);
    for (std::size_t n = 0; n < count; ++n) points_mm[n] = volume.frame().to_patient(volume.point_in_path_mm(disc, n));
    std::vector<Vec3> gradients;
    const std::vector<double> depths_mm = values_at(bone, points_mm, gradients);
    for (std::size_t n = 0; n < count; ++n) {
      PointSplat& splat = splats_[static_cast<std::size_t>(disc) * count + n];
      splat.position_mm = points_mm[n].cast<float>();
      splat.radius_mm = static_cast<float>(kRadiusSpacings * spacing_mm);
      splat.hu = volume.hu(disc, n);
      const bool is_surface = volume.is_occupied(disc, n) && depths_mm[n] > -spacing_mm && gradients[n].norm() > 0.0;
      if (!is_surface) continue;
      splat.alpha = 1.0F;
      splat.normal = gradients[n].normalized().cast<float>();
    }
  });
  const double beside_mm = kBesideSpacings * spacing_mm;
  for (std::size_t a = 0; a < count; ++a) {
    first_.push_back(neighbours_.size());
    const int ring = DiscPattern::ring_of(a);
    const int last_ring = std::min(ring + 2, pattern.ring_count() - 1);
    const std::size_t end = DiscPattern::ring_start(last_ring) + DiscPattern::ring_size(last_ring);
    for (std::size_t b = DiscPattern::ring_start(std::max(0, ring - 2)); b < end; ++b) {
      if ((pattern.point_mm(a) - pattern.point_mm(b)).norm() < beside_mm) {
        neighbours_.push_back(static_cast<std::uint32_t>(b));
      }
    }
  }
  first_.push_back(neighbours_.size());
}

std::size_t PointSplats::update(const PointVolume& volume, const DrillBit& bit, const Pose& pose) {
  const std::span<const std::uint64_t> now = volume.occupancy_words();
  if (now.size() != occupied_.size() || volume.point_count() != splats_.size()) {
    fail("splats: expected the volume that they were made from");
  }
  const BitProfile profile(bit);
  const std::size_t count = volume.pattern().point_count();
  const std::size_t words = volume.occupancy_words(0).size();
  std::size_t changed = 0;
  const auto bring_to_light = [&](int disc, std::size_t index) {
    PointSplat& splat = splats_[static_cast<std::size_t>(disc) * count + index];
    if (splat.alpha > 0.0F || !volume.is_occupied(disc, index)) return;
    splat.alpha = 1.0F;
    splat.normal = towards_bit(profile, pose, splat.position_mm.cast<double>()).cast<float>();
    ++changed;
  };
  for (std::size_t n = 0; n < now.size(); ++n) {
    for (std::uint64_t gone = occupied_[n] & ~now[n]; gone != 0; gone &= gone - 1) {
      const auto disc = static_cast<int>(n / words);
      const std::size_t index = n % words * 64 + static_cast<std::size_t>(std::countr_zero(gone));
      PointSplat& splat = splats_[static_cast<std::size_t>(disc) * count + index];
      changed += splat.alpha > 0.0F ? 1 : 0;
      splat.alpha = 0.0F;
      for (int beside = std::max(disc - 1, 0); beside <= std::min(disc + 1, volume.disc_count() - 1); ++beside) {
        for (std::size_t k = first_[index]; k < first_[index + 1]; ++k) bring_to_light(beside, neighbours_[k]);
      }
    }
    occupied_[n] = now[n];
  }
  return changed;
}

std::string splats_ply(std::span<const PointSplat> splats) {
  const auto shown =
      std::count_if(splats.begin(), splats.end(), [](const PointSplat& splat) { return splat.alpha > 0.0F; });
  TextWriter head;
  head << "ply\nformat binary_little_endian 1.0\ncomment SpinalTap: points that show, patient LPS, mm\nelement vertex "
       << shown << "\n";
  for (const char* name : {"x", "y", "z", "nx", "ny", "nz", "radius"}) head << "property float " << name << "\n";
  for (const char* name : {"red", "green", "blue", "alpha"}) head << "property uchar " << name << "\n";
  head << "property short hu\nend_header\n";
  std::string ply = head.str();
  for (const PointSplat& splat : splats) {
    if (!(splat.alpha > 0.0F)) continue;
    for (int axis = 0; axis < 3; ++axis) append(ply, splat.position_mm[axis]);
    for (int axis = 0; axis < 3; ++axis) append(ply, splat.normal[axis]);
    append(ply, splat.radius_mm);
    for (const double part : hu_colour(splat.hu)) append(ply, static_cast<std::uint8_t>(std::lround(255.0 * part)));
    append(ply, static_cast<std::uint8_t>(std::lround(255.0F * splat.alpha)));
    append(ply, splat.hu);
  }
  return ply;
}

}  // namespace spinaltap
