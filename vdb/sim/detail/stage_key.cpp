#include "vdb/sim/detail/stage_key.h"

#include <optional>
#include <type_traits>

#include "core/base/hash.h"

namespace spinaltap::detail {
namespace {

/// Names a stage's result by all that it depends on. Numbers count by all their digits.
class StageKey {
 public:
  StageKey(std::string_view code, const std::string& ct_hash) { add(std::string(code), ct_hash); }

  template <class... Parts>
  StageKey& add(const Parts&... parts) {
    (add_one(parts), ...);
    return *this;
  }
  std::string hex() const { return hash_.hex(); }

 private:
  void add_one(const std::string& part) {
    add_one(part.size());
    hash_.add(part.data(), part.size());
  }
  template <class Number>
  void add_one(Number number) {
    static_assert(std::is_arithmetic_v<Number>);
    hash_.add(&number, sizeof number);
  }
  void add_one(const std::optional<double>& number) { number ? add(true, *number) : add(false); }
  void add_one(const std::optional<Vec3>& place) { place ? add(true, place->x(), place->y(), place->z()) : add(false); }

  WordHash64 hash_;
};

}  // namespace

std::string mask_key(std::string_view code, const std::string& ct_hash, const SegmentOptions& options) {
  StageKey key(code, ct_hash);
  key.add(options.seed_mm, options.threshold_hu, options.names.size());
  for (const LevelPoint& name : options.names) key.add(level_name(name.level), std::optional(name.p_mm));
  for (const Correction& one : options.corrections) key.add(level_name(one.level), std::optional(one.p_mm));
  return key.hex();
}

std::string fit_key(std::string_view code, const std::string& ct_hash, const BoneMask& mask,
                    const SurfaceOptions& surface, const SurfaceFitOptions& options) {
  StageKey key(code, ct_hash);
  WordHash64 mask_hash;
  mask_hash.add(mask.inside.data(), mask.inside.size());
  key.add(mask_hash.value(), surface.smooth_mm, surface.refine_by_hu);
  key.add(options.spacing_mm, options.off_surface_mm, options.smoothing_mm, options.accuracy_mm, options.reduction_mm);
  return key.hex();
}

}  // namespace spinaltap::detail
