#include "core/tool/drill_path.h"

#include <algorithm>
#include <cmath>

#include "core/base/error.h"
#include "core/base/geometry.h"

namespace spinaltap {

double ScrewThread::lead_mm() const { return pitch_mm * starts; }

double ScrewThread::depth_mm(double diameter_mm) const { return 0.5 * (diameter_mm - core_diameter_mm); }

ScrewThread usual_thread(double diameter_mm) {
  constexpr double kCoreShare = 0.65, kPitchShare = 0.43, kMaxPitchMm = 3.0;
  // To the hundredth, as tables have them.
  const auto rounded = [](double mm) { return std::round(100.0 * mm) / 100.0; };
  ScrewThread thread;
  thread.core_diameter_mm = rounded(kCoreShare * diameter_mm);
  thread.pitch_mm = rounded(std::min(kPitchShare * diameter_mm, kMaxPitchMm));
  return thread;
}

void check_thread(const ScrewThread& thread, double diameter_mm) {
  const auto within = [](double value, double lowest, double highest, const char* what) {
    if (!(value >= lowest && value <= highest)) {
      fail("expected ", what, " from ", lowest, " to ", highest, ", found ", value);
    }
  };
  within(thread.core_diameter_mm, 0.1 * diameter_mm, diameter_mm, "a core's diameter (mm)");
  within(thread.tip_core_diameter_mm, 0.0, thread.core_diameter_mm, "a core's diameter at the tip (mm)");
  within(thread.pitch_mm, 0.1, 20.0, "a pitch (mm)");
  within(thread.starts, 1, 8, "a number of threads side by side");
  within(thread.crest_mm, 0.0, thread.pitch_mm, "a thread's width at its crest (mm)");
  within(thread.flank_deg, 0.0, 60.0, "a flank's angle (degrees)");
  const double root_mm = thread.crest_mm + 2.0 * thread.depth_mm(diameter_mm) * std::tan(thread.flank_deg * kDegree);
  within(root_mm, 0.0, thread.pitch_mm, "a thread's width at its root (mm)");
}

}  // namespace spinaltap
