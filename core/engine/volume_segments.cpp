#include "core/engine/volume_segments.h"

#include <algorithm>
#include <cmath>

#include "core/base/error.h"

namespace spinaltap {
namespace {

class JointEngine final : public DrillEngine {
 public:
  explicit JointEngine(std::vector<std::unique_ptr<DrillEngine>> engines) : engines_(std::move(engines)) {
    if (engines_.empty()) fail("drilling: expected one volume or more, found none");
  }

  StepResult step(const Pose& pose) noexcept override {
    StepResult sum;
    for (const auto& engine : engines_) {
      const StepResult part = engine->step(pose);
      sum.removed += part.removed;
      sum.tested += part.tested;
      sum.removed_hu += part.removed_hu;
      sum.removed_mm3 += part.removed_mm3;
      sum.work_n_mm += part.work_n_mm;
      sum.moment_n_mm2 += part.moment_n_mm2;
      for (std::size_t n = 0; n < sum.work_back_n_mm.size(); ++n) sum.work_back_n_mm[n] += part.work_back_n_mm[n];
    }
    return sum;
  }

  void reset_motion() noexcept override {
    for (const auto& engine : engines_) engine->reset_motion();
  }

  std::size_t memory_bytes() const override {
    std::size_t bytes = sizeof(*this) + engines_.size() * sizeof(engines_[0]);
    for (const auto& engine : engines_) bytes += engine->memory_bytes();
    return bytes;
  }

 private:
  std::vector<std::unique_ptr<DrillEngine>> engines_;
};

}  // namespace

std::vector<PointVolume> make_segments(const DrillPath& path, const std::vector<VolumeSegment>& segments,
                                       const PointVolumeOptions& options) {
  check_path(path);
  check_straight(path, "discs of more than one spacing");
  if (segments.empty()) fail("point volume: expected one segment or more, found none");
  std::vector<PointVolume> volumes;
  double end_mm = segments.front().begin_mm;
  for (const VolumeSegment& segment : segments) {
    if (!(segment.end_mm > segment.begin_mm) || !(std::abs(segment.begin_mm - end_mm) < 1e-9)) {
      fail("point volume: expected segments that follow one upon the other, found one from ", segment.begin_mm, " to ",
           segment.end_mm, " mm after ", end_mm, " mm");
    }
    end_mm = segment.end_mm;
    // A disc stands for the layer around it: the first lies half a spacing within the segment.
    DrillPath part = path;
    part.entry_mm = path.entry_mm + (segment.begin_mm + 0.5 * segment.spacing_mm) * path.direction();
    part.target_mm = path.entry_mm + (segment.end_mm + 0.5 * segment.spacing_mm) * path.direction();
    PointVolumeOptions own = options;
    own.spacing_mm = segment.spacing_mm;
    own.lead_in_mm = 0.0;
    own.jitter_seed = options.jitter_seed + volumes.size();
    volumes.emplace_back(part, own);
  }
  return volumes;
}

std::vector<VolumeSegment> fine_near_surface(const DrillPath& path, double lead_in_mm, const BoneSampler& bone,
                                             double near_mm, double tip_mm, double fine_mm, double coarse_mm) {
  check_path(path);
  check_straight(path, "discs of more than one spacing");
  if (!(coarse_mm > 0.0) || !(fine_mm > 0.0) || !(near_mm >= 0.0) || !(tip_mm >= 0.0) || !(lead_in_mm >= 0.0)) {
    fail("point volume: expected spacings above 0 mm and lengths of 0 mm or more");
  }
  // Layers of one coarse spacing, each fine or not. Whole layers, so that neither spacing leaves a gap.
  const double length_mm = lead_in_mm + path.length_mm();
  const auto layers = static_cast<std::size_t>(std::max(1.0, std::round(length_mm / coarse_mm)));
  const double layer_mm = length_mm / static_cast<double>(layers);
  std::vector<Vec3> points_mm(layers + 1);
  for (std::size_t n = 0; n <= layers; ++n) {
    points_mm[n] = path.entry_mm + (static_cast<double>(n) * layer_mm - lead_in_mm) * path.direction();
  }
  std::vector<float> distance_mm(points_mm.size());
  bone(points_mm, distance_mm, {});
  std::vector<bool> is_fine(layers, false);
  const auto refine = [&](double from_mm, double to_mm) {
    const double first = std::max(0.0, std::floor(from_mm / layer_mm));
    for (auto n = static_cast<std::size_t>(first); n < layers && static_cast<double>(n) * layer_mm < to_mm; ++n) {
      is_fine[n] = true;
    }
  };
  for (std::size_t n = 0; n < layers; ++n) {
    const bool passes = (distance_mm[n] < 0.0F) != (distance_mm[n + 1] < 0.0F);
    const double at_mm = (static_cast<double>(n) + 0.5) * layer_mm;
    if (passes) refine(at_mm - near_mm, at_mm + near_mm);
  }
  if (tip_mm > 0.0) refine(length_mm - tip_mm, length_mm);
  std::vector<VolumeSegment> segments;
  for (std::size_t n = 0; n < layers; ++n) {
    const double end_mm = static_cast<double>(n + 1) * layer_mm - lead_in_mm;
    if (n > 0 && is_fine[n] == is_fine[n - 1]) {
      segments.back().end_mm = end_mm;
    } else {
      segments.push_back({end_mm - layer_mm, end_mm, is_fine[n] ? fine_mm : coarse_mm});
    }
    if (n > 0 && segments.size() > 1) segments.back().begin_mm = segments[segments.size() - 2].end_mm;
  }
  return segments;
}

std::unique_ptr<DrillEngine> make_joint_engine(std::vector<std::unique_ptr<DrillEngine>> engines) {
  return std::make_unique<JointEngine>(std::move(engines));
}

}  // namespace spinaltap
