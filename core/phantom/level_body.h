#pragma once

#include <memory>
#include <vector>

#include "core/phantom/vertebra.h"

namespace spinaltap {

/// A metal screw: a round rod from its head to its tip, patient LPS, mm.
struct ScrewRod {
  Vec3 head_mm, tip_mm;
  double radius_mm;
};

/// A round pit in a surface, patient LPS, mm.
struct Pit {
  Vec3 centre_mm;
  double radius_mm;
};

/// A lump of bone cement, patient LPS, mm: what of it lies in the bone is cement.
struct CementLump {
  Vec3 centre_mm;
  double radius_mm;
};
inline constexpr double kCementHu = 1900.0;

/// CT number of the metal, where most scanners clamp.
inline constexpr double kMetalHu = 3071.0;

/// A vertebra with pits (Schmorl's nodes), screws and cement. Screws count as part of the body: what lies in one lies
/// inside.
class LevelBody : public Solid {
 public:
  LevelBody(std::shared_ptr<const Vertebra> vertebra, std::vector<Pit> pits, std::vector<ScrewRod> screws,
            std::vector<CementLump> cement = {});

  void evaluate(std::span<const Vec3> points_mm, std::span<double> values_mm, std::span<Vec3> gradients) const override;
  Box3 bounds_mm() const override;
  double hu(const Vec3& p_patient, double distance_mm, double aperture_mm) const override;

 private:
  double screw_value_mm(const Vec3& p) const;
  double value_mm(const Vec3& p) const;

  std::shared_ptr<const Vertebra> vertebra_;
  std::vector<Pit> pits_;
  std::vector<ScrewRod> screws_;
  std::vector<CementLump> cement_;
};

/// Distance of a point from a segment, mm.
double segment_distance_mm(const Vec3& p, const Vec3& start, const Vec3& end);

}  // namespace spinaltap
