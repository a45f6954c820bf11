#include "vdb/leaf_engine.h"

#include <vector>

#include "core/base/error.h"
#include "vdb/detail/leaf_volume_engine.h"
#include "vdb/shared_points.h"

namespace spinaltap {
namespace {

/// Each volume keeps its own frame, in which its points are decided about, and its own tree along it.
class SeveralVolumesEngine final : public DrillEngine {
 public:
  explicit SeveralVolumesEngine(std::vector<std::unique_ptr<DrillEngine>> engines) : engines_(std::move(engines)) {}

  StepResult step(const Pose& pose) noexcept override {
    StepResult sum;
    for (const auto& engine : engines_) {
      const StepResult result = engine->step(pose);
      sum.removed += result.removed;
      sum.tested += result.tested;
      sum.removed_hu += result.removed_hu;
      sum.work_n_mm += result.work_n_mm;
      // All advance by the same way.
      sum.thrust_n += result.thrust_n;
    }
    return sum;
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

std::unique_ptr<DrillEngine> make_leaf_engine(PointVolume& volume, const DrillBit& bit, const Material& material) {
  return std::make_unique<detail::LeafVolumeEngine>(volume, bit, material);
}

std::unique_ptr<DrillEngine> make_leaf_engine(std::span<PointVolume* const> volumes, const DrillBit& bit,
                                              const Material& material) {
  if (volumes.empty()) fail("leaf engine: expected at least one volume");
  drop_shared_points(volumes);
  std::vector<std::unique_ptr<DrillEngine>> engines;
  for (PointVolume* volume : volumes) engines.push_back(make_leaf_engine(*volume, bit, material));
  return std::make_unique<SeveralVolumesEngine>(std::move(engines));
}

}  // namespace spinaltap
