#pragma once

#include <optional>
#include <vector>

#include "core/base/progress.h"
#include "core/segment/vertebral_body.h"

namespace spinaltap {

/// The bodies of a CT's spine and what was learned on the way.
struct SpineBodies {
  BoneLevels levels;
  SpinalCanal canal;
  std::vector<BodySpan> chain;        ///< from below upward; the sacrum's first body is the lowest where it was found
  std::vector<VertebralBody> bodies;  ///< one for each of the chain
  bool has_sacrum = false;
};

/// Finds the bodies of all vertebrae in a CT, with `near_mm` (a point in one of them, patient LPS) those of the spine
/// that it lies in. Empty lists where there is no spine. `threshold_hu`: bone is at least this dense; by default chosen
/// from the CT (choose_bone_levels()).
SpineBodies find_spine_bodies(const CtVolume& ct, std::optional<double> threshold_hu = std::nullopt,
                              const std::optional<Vec3>& near_mm = std::nullopt, const Progress& progress = {});

/// The body that holds a point (patient LPS, mm), or whose wall it lies on within 2 mm; nothing where none does.
std::optional<std::size_t> body_at(const SpineBodies& spine, const Vec3& p_mm);

}  // namespace spinaltap
