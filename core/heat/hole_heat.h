#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/heat/hole_kernel.h"
#include "core/heat/thermal_bone.h"
#include "core/tool/drill_bit.h"

namespace spinaltap {

/// How far behind the tip lies the ring that heats the wall, mm: a millimetre behind where the bit is first as wide as
/// its hole. What bone keeps is what neither chips nor the next turn took: nearer, the bit would take it once more.
double wall_back_mm(const DrillBit& bit);

struct HoleHeatOptions {
  double radius_mm = 1.5;
  double length_mm = 60.0;                   ///< of the hole, at most; heat beyond it counts as lost
  double distance_mm = 0.5;                  ///< from the wall, where the rise is told
  double wall_transfer_w_mm2_k = 0.0;        ///< to irrigation at the bone's own temperature; 0: dry
  double wall_conductivity_w_mm_k = 5.5e-4;  ///< of the bone that this is set against
};

/// The warmest place beside a hole.
struct HottestPlace {
  double rise_k = 0.0;
  double depth_mm = 0.0;  ///< below the entry, along the path
  double time_s = 0.0;
};

/// The temperature beside a hole while it is drilled, live: the sum of what past rings of heat on its wall have come
/// to, by the solution outside a cylinder (HoleKernel) times that along a line. The entry is a plane that lets no heat
/// through; below, bone goes on without end; each ring spreads as in the bone that it was cut in.
///
/// Heat is kept in bins of 0.25 mm along the hole, of each bin as up to 10 pulses; the older ones merge, those first
/// whose distance in time is the smallest share of their age. A pulse that is long for its age counts as two halves, a
/// deviation before and after its mean time. A cycle goes through so many of them and no more: it costs the same after
/// an hour as after a second. All places beside the hole have their turn, those of a hole of 40 mm in under a second at
/// 1 kHz. `update` allocates, locks and logs nothing; the same inputs give the same bits.
class HoleHeat {
 public:
  /// Throws Error on numbers that make no sense.
  explicit HoleHeat(const HoleHeatOptions& options);

  /// A cycle of `dt_s`: a ring at `depth_mm` on the wall (where the bit is as wide as the hole) gave `heat_w` to bone
  /// of `tissue`. Heat above the entry is lost.
  void update(double depth_mm, double heat_w, double dt_s, const ThermalTissue& tissue) noexcept;

  double time_s() const { return time_s_; }
  /// Of the last turn through all places, or hotter since.
  const HottestPlace& now() const { return now_; }
  /// So far.
  const HottestPlace& ever() const { return ever_; }
  /// Worked out at once, over all pulses: not for a live cycle.
  double rise_k(double depth_mm) const noexcept;

  void reset() noexcept;

 private:
  static constexpr std::size_t kPulses = 10;
  static constexpr double kBinMm = 0.25;

  struct Pulse {
    double heat_k_mm3 = 0.0;    ///< heat over capacity
    double moment_s = 0.0;      ///< the mean time times that
    double square_s2 = 0.0;     ///< the mean square of time times that
    double depth_k_mm4 = 0.0;   ///< the mean depth times that
    double spread_mm2_s = 0.0;  ///< diffusivity times that
    double begin_s = 0.0;
  };
  struct Bin {
    std::array<Pulse, kPulses> pulses;
    std::size_t count = 0;
  };

  void add(double depth_mm, double heat_k_mm3, double diffusivity_mm2_s) noexcept;
  double rise_of(const Pulse& pulse, double age_s, double at_mm, double depth_mm) const noexcept;
  double rise_of(std::size_t bin, double depth_mm, double time_s) const noexcept;
  void go_on() noexcept;
  void begin_place() noexcept;

  HoleKernel kernel_;
  std::vector<Bin> bins_;
  std::size_t first_ = 0, end_ = 0;  ///< bins with heat
  std::size_t open_ = 0;             ///< the bin that heat goes to
  double time_s_ = 0.0;
  double max_diffusivity_mm2_s_ = 0.0;
  double first_s_ = 0.0;

  // The place whose turn it is, and how far its sum is.
  std::size_t place_ = 0, bin_ = 0, bin_end_ = 0;
  double sum_k_ = 0.0;
  double place_s_ = 0.0;
  bool has_place_ = false;

  HottestPlace turn_, now_, ever_;
};

}  // namespace spinaltap
