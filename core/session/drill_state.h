#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <string_view>

namespace spinaltap {

/// The five states of drilling a pedicle (Hu et al. 2013), by what the chisel edge meets.
enum class DrillState : std::uint8_t {
  initial,         ///< not yet in bone
  outer_cortical,  ///< in the cortex at the entry
  cancellous,
  transitional,   ///< bone is getting denser: the far cortex is near
  inner_cortical  ///< in the far cortex, or through it
};
/// "initial", "outer cortical", "cancellous", "transitional", "inner cortical".
std::string_view name_of(DrillState state);

/// How states are told apart. docs/sessions.md derives them.
struct StateRules {
  double contact_g_cm3 = 0.1;     ///< density at the chisel edge: above, it is in bone
  double cancellous_g_cm3 = 0.2;  ///< of vertebrae's cancellous bone, where this one's is not known
  double cortical_g_cm3 = 0.65;   ///< of a far cortex where its surface is not known
  double near_mm = 5.0;           ///< of bone left ahead: within, denser bone is the far cortex
  double rise = 1.25;             ///< times the cancellous bone's density: dense enough to be a cortex
  double hold_mm = 0.1;           ///< a state begins when the tip has gone so far in it
  double no_cortex_mm = 0.5;      ///< bone that has not become dense for so long has no cortex at the entry
};
/// Rejects values that are not finite or below 0, and densities that do not rise from contact to cortex.
void check_state_rules(const StateRules& rules);

/// What a tip meets.
struct TipMeets {
  double depth_mm = 0.0;       ///< along the path
  double density_g_cm3 = 0.0;  ///< just ahead of the chisel edge
  /// Of bone left ahead of it along its axis. Infinite: far. Not a number: not known; then density alone tells.
  double ahead_mm = std::numeric_limits<double>::quiet_NaN();
};

/// Recognises the states from the density at the chisel edge, which the thrust of a robot's drill shows as well, and
/// from how much bone is left ahead. Cortex ends and begins half way between its own density and that of the cancellous
/// bone beside it (as CTs are read: Prevrhal et al. 1999), both learned on the way, so that soft bones and CTs that
/// blur have states too. Goes forward only, but for transitional to cancellous, where the density was a strut. A
/// state's depth is where it began, not where it was certain.
class StateRecogniser {
 public:
  /// Throws Error as check_state_rules() does.
  explicit StateRecogniser(const StateRules& rules = {});

  /// After a cycle. Only cycles that take the tip deeper than ever count; each brings the next state at most.
  DrillState update(const TipMeets& tip) noexcept;

  DrillState state() const { return state_; }
  /// Depth at which the present state began, mm.
  double begin_mm() const { return begin_mm_; }

 private:
  /// Where a density last went over a level, as it is now thought to be; levels change as bone is learned.
  struct Stretch {
    bool is_on = false;
    double since_mm = 0.0;

    void update(double depth_mm, bool is_on_now) noexcept {
      if (is_on_now != is_on) since_mm = depth_mm;
      is_on = is_on_now;
    }
  };
  /// Densities of the last millimetres, a place each kTraceMm.
  class Trace {
   public:
    static constexpr double kTraceMm = 0.01;
    void add(double depth_mm, double density_g_cm3) noexcept;
    /// Where the density last rose over `level`, before which it was below for all that is kept or a hold's length.
    double rose_over_mm(double level_g_cm3, double hold_mm) const noexcept;

   private:
    static constexpr std::size_t kPlaces = 1024;
    std::array<double, kPlaces> density_g_cm3_{};
    std::size_t count_ = 0;  ///< all that were added
    double begin_mm_ = 0.0;
  };
  bool enter(DrillState next, double since_mm, double hold_mm) noexcept;
  void leave_entry(const TipMeets& tip) noexcept;
  void approach_far_side(const TipMeets& tip) noexcept;
  void learn_cancellous(const TipMeets& tip, double way_mm) noexcept;

  StateRules rules_;
  DrillState state_ = DrillState::initial;
  double begin_mm_ = 0.0;
  double deepest_mm_ = -std::numeric_limits<double>::infinity();
  Stretch contact_, below_, rising_, cortical_;
  Trace trace_;
  double entry_cortex_g_cm3_ = 0.0;  ///< the densest so far, at the entry
  double cancellous_g_cm3_ = 0.0;    ///< mean of the last millimetres of it
  double learned_mm_ = 0.0;          ///< of how much, 5 at most
  double far_cortex_g_cm3_ = 0.0;    ///< the densest since it is near the far side
};

}  // namespace spinaltap
