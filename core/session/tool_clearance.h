#pragma once

#include <limits>
#include <memory>
#include <span>

#include "core/anatomy/wall_distance.h"
#include "core/base/geometry.h"
#include "core/base/progress.h"
#include "core/session/cycle.h"
#include "core/tool/bit_profile.h"
#include "core/tool/path_curve.h"
#include "core/tool/plate.h"

namespace spinaltap {

/// The walls' distances around a path, kept so that a cycle finds a bit's clearance within microseconds. What a hole's
/// entry opening breaks is meant to be broken: there the outer surface does not count (docs/grading.md's rule). Safe to
/// ask from many threads.
class ClearanceField {
 public:
  static constexpr double kSpacingMm = 0.4;
  static constexpr double kReachMm = 8.0;
  static constexpr double kBehindMm = 5.0;
  static constexpr double kBeyondMm = 20.0;

  /// Distances within `reach_mm` of the path's line, from `behind_mm` before the entry to `beyond_mm` past the target;
  /// further out a bit has no clearance. `walls` must outlive this; it may be asked from many threads. Throws Error on
  /// bad paths and on ranges over 200 mm.
  ClearanceField(const WallDistance& walls, const DrillPath& path, double reach_mm = kReachMm,
                 double behind_mm = kBehindMm, double beyond_mm = kBeyondMm, const Progress& progress = {});
  /// The same with those ranges, and further aside by half a plate's width.
  ClearanceField(const WallDistance& walls, const DrillPath& path, const Progress& progress)
      : ClearanceField(walls, path, reach_of(path), kBehindMm, kBeyondMm, progress) {}
  /// Of several bones together: what lies in one of them is in the bone. The first is the one of the path's entry.
  /// Throws Error where there is none.
  ClearanceField(std::span<const WallDistance* const> walls, const DrillPath& path, const Progress& progress);
  /// Without a path: everywhere in a box around the bones, every kFreeSpacingMm, and 3 mm around it; to 0.3 mm where
  /// two walls are equally far. Only the canal has a clearance there, of the whole tool, and tip_at() its place: a tool
  /// has to come through the outer surface somewhere. Throws Error where there is no bone.
  ClearanceField(std::span<const WallDistance* const> walls, const Box3& bones_mm, const Progress& progress);
  static constexpr double kFreeSpacingMm = 1.0;
  ~ClearanceField();
  ClearanceField(ClearanceField&&) noexcept;

  /// The same distances for another path near by, which has an entry opening of its own. Takes milliseconds and no
  /// memory.
  ClearanceField with_entry_of(const DrillPath& path) const;

  /// Of a bit at `pose` (patient LPS), to 0.05 mm; above 8 mm it may be 0.15 mm too small where two walls are equally
  /// far. `bit` as BitProfile has it. Of places behind the path's entry nothing counts. Allocates and locks nothing.
  Clearance of(const BitProfile& bit, const Pose& pose) const noexcept;
  /// Of a plate at a sound pose, to 0.1 mm.
  Clearance of(const PlateBox& plate, const Pose& pose) const noexcept;

  /// Of a tip at a pose (patient LPS), to 0.1 mm; infinite out of the lattice. Allocates and locks nothing.
  TipPlace tip_at(const Pose& pose) const noexcept;
  /// The way into bone across its surface at a place (patient LPS), unit; zero where that is not known.
  Vec3 into_bone_at(const Vec3& p_mm) const noexcept;
  static constexpr double kAheadMm = 12.0;

  bool has_path() const { return has_path_; }
  /// Depth from which on the outer surface counts, along the path, mm.
  double entry_end_mm() const { return entry_end_mm_; }
  std::size_t memory_bytes() const;

 private:
  struct Lattice;
  static double reach_of(const DrillPath& path) {
    return path.bit.is_plate() ? kReachMm + path.bit.radius_mm() : kReachMm;
  }
  template <class Find>
  Clearance found(double length_mm, const Pose& pose, const Find& find) const noexcept;
  static std::shared_ptr<const Lattice> lattice_of(std::span<const WallDistance* const> walls, const DrillPath& path,
                                                   double reach_mm, double behind_mm, double beyond_mm,
                                                   const Progress& progress, double spacing_mm = kSpacingMm);
  ClearanceField(std::shared_ptr<const Lattice> lattice, const DrillPath& path);
  /// Without a path.
  ClearanceField(std::shared_ptr<const Lattice> lattice, const PathCurve& line);

  std::shared_ptr<const Lattice> lattice_;
  PathCurve curve_;
  double entry_end_mm_;
  bool has_path_ = true;
};

}  // namespace spinaltap
