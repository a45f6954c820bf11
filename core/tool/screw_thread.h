#pragma once

namespace spinaltap {

/// The thread of a bone screw, of one outer diameter along its shaft; its core may be a cone. Lengths in mm.
struct ScrewThread {
  double core_diameter_mm = 4.2;      ///< between the threads: the minor diameter, of a cone the one below the head
  double tip_core_diameter_mm = 0.0;  ///< of a conical core where the tip begins; 0: a cylinder
  double pitch_mm = 2.75;             ///< from thread to thread along the axis
  int starts = 1;                     ///< threads side by side: a turn advances the screw by so many pitches
  double crest_mm = 0.2;              ///< width of the thread's outer edge
  double flank_deg = 15.0;            ///< between a flank and the plane across the axis, both flanks alike

  /// How far a turn advances the screw, mm.
  double lead_mm() const;
  /// From core to outer diameter below the head, mm, of a screw of that diameter.
  double depth_mm(double diameter_mm) const;

  bool operator==(const ScrewThread&) const = default;
};

/// The usual thread of a pedicle screw of a diameter: core and pitch are the means of twelve screws of 6 to 7.5 mm in
/// clinical use (Weidling et al. 2022, table 2): 0.65 of the diameter, and 0.43 of it but at most 3 mm.
ScrewThread usual_thread(double diameter_mm);

/// Throws Error on sizes that make no sense for a screw of that diameter. The message begins with the size at fault.
void check_thread(const ScrewThread& thread, double diameter_mm);

}  // namespace spinaltap
