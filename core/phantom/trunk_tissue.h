#pragma once

#include <optional>
#include <vector>

#include "core/phantom/level_body.h"
#include "core/phantom/spine.h"
#include "core/phantom/surroundings.h"

namespace spinaltap {

inline constexpr double kBloodHu = 42.0;     ///< without contrast
inline constexpr double kShoulderMm = 45.0;  ///< TrunkTissueOptions::shoulder_mm of who has arms at his sides

/// What a whole trunk has around its spine, beyond SoftTissue.
struct TrunkTissueOptions {
  SoftTissueOptions soft{};           ///< its aorta_hu and muscle_hu hold here too
  double half_width_mm = 170.0;       ///< from the spine to the skin at the sides
  double front_mm = 165.0;            ///< from the bodies' middles to the skin in front
  double shoulder_mm = 0.0;           ///< by which it is wider at each side about T2
  double kidney_hu = 35.0;            ///< 180 with contrast
  double pelvis_of_kidney_hu = 10.0;  ///< its collecting system; over 500 late after contrast
  double gas_share = 0.5;             ///< of the bowel; 0: no gas
  bool table = true;                  ///< a curved shell behind the skin
  bool stent = false;                 ///< a wire tube in the aorta, at T9 to L2
  bool pacemaker = false;             ///< a wire from the left collarbone to the heart, with its case
};

/// A trunk: SoftTissue with an outline, organs, bowel, a table, and metal that is no bone. Outside the skin is air.
class TrunkTissue : public Surroundings {
 public:
  /// `spine`: made from SpineOptions; throws Error for any other, and on options without sense.
  explicit TrunkTissue(const Spine& spine, const TrunkTissueOptions& options = {});

  double hu(const Vec3& p_patient) const override;

 private:
  /// An organ: an ellipsoid along the patient's axes.
  struct Organ {
    Vec3 centre_mm, half_mm;
    double hu;
    double soft_mm;
  };
  struct Stent {
    double low_mm, high_mm;  ///< z
  };

  double organs_hu(double hu, const Vec3& p) const;
  double metal_hu(double hu, const Vec3& p, const SoftTissue::Station& here) const;
  double behind_hu(const Vec3& p) const;

  SoftTissue soft_;
  TrunkTissueOptions options_;
  std::vector<Organ> organs_;
  std::vector<ScrewRod> wires_;
  std::optional<Organ> case_;  ///< of the pacemaker
  std::optional<Stent> stent_;
  double shoulder_z_mm_ = 0.0;  ///< of T2
  double abdomen_z_mm_ = 0.0;   ///< below it lie bowels
  double table_y_mm_ = 0.0;
  double middle_x_mm_ = 0.0;
};

}  // namespace spinaltap
