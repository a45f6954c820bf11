#pragma once

#include <array>
#include <cstdint>
#include <memory>

#include "core/anatomy/wall_distance.h"
#include "core/grading/grade.h"

namespace spinaltap {

/// Where a tool stands out of the bone: what PathGrade says of it, without all else.
struct ScrewBreach {
  double breach_mm = 0.0;                  ///< 0: the tool stays in the bone, behind the entry opening's end
  double depth_mm = 0.0;                   ///< where it is; of no meaning without one, as the next two
  PathSide side = PathSide::lateral;       ///< of the breach
  bool is_canal = false;                   ///< the breach is into the canal
  double outer_mm = 0.0, canal_mm = 0.0;   ///< through each wall: the larger is breach_mm
  std::array<double, 5> side_breach_mm{};  ///< the largest breach to each PathSide; PathSide::anterior: the tip's

  Grade grade() const { return gertzbein_robbins(breach_mm); }
};

/// Which of side_breach_mm are wanted.
enum class ScrewSides : std::uint8_t {
  all,
  anterior  ///< sooner; the others' may be told too small
};

/// Grades very many screws of one bone by their breaches: thousands a second. Safe to ask from many threads.
class ScrewGrader {
 public:
  /// `walls` must outlive this. Throws Error on options that make no sense.
  explicit ScrewGrader(const WallDistance& walls, const GradeOptions& options = {});
  ScrewGrader(ScrewGrader&&) noexcept;
  ScrewGrader& operator=(ScrewGrader&&) noexcept;
  ~ScrewGrader();

  /// Of the path's screw or, where it has none, its bit: as grade_path() tells it. Throws Error on paths that make no
  /// sense.
  ScrewBreach grade(const DrillPath& path, ScrewSides sides = ScrewSides::all) const;

 private:
  struct Impl;
  std::unique_ptr<const Impl> impl_;
};

}  // namespace spinaltap
