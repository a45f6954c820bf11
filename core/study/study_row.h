#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

#include "core/study/study_design.h"

namespace spinaltap {

/// Columns of a study's table, in its order; docs/studies.md says what they mean. The factors come first, as
/// StudyFactor has them.
enum class StudyColumn : std::uint8_t {
  run = kStudyFactors,
  patient,                 ///< counts from 1
  screw,                   ///< counts from 1, bone after bone
  level,                   ///< the vertebra's: Level; not a number where it is not known
  side,                    ///< 0: a path through the left pedicle, 1: the right one; not a number where there is none
  seed,                    ///< of the tremor
  contact,                 ///< 1: the bit removed bone
  breach,                  ///< 1: the bit went beyond a wall
  breach_outer_mm,         ///< how far at most beyond the outer surface, its entry opening not counted; 0: not at all
  breach_canal_mm,         ///< into the canal
  min_clearance_outer_mm,  ///< min clearance; infinite where the bone has no such wall
  min_clearance_canal_mm,  ///< likewise
  grade,                   ///< Gertzbein-Robbins, of the bit, by the deeper breach: 0 (A) to 4 (E)
  max_thrust_n,            ///< of cutting
  max_torque_n_mm,         ///< of cutting
  plunge_depth_mm,         ///< way after a stop or a breakthrough until the operator stood still
  depth_mm,                ///< deepest place of the tip, along the planned path
  time_s,                  ///< of drilling, not of computing
  outer_cortical_mm,       ///< depth at which the state first began; not a number where it never did
  cancellous_mm,           ///< likewise
  transitional_mm,         ///< likewise
  inner_cortical_mm,       ///< likewise
  breakthrough_mm,         ///< depth at which the tip left the bone; not a number where it never did
  stop_mm,                 ///< depth at which a rule asked to stop; not a number where none did
  gave_up_mm,              ///< how far short of its target the operator gave up; not a number where it did not
  removed_points,          ///< of the volume
  removed_mm3,             ///< of bone
  screw_pullout_n,         ///< median, of the path's screw in the hole as drilled; not a number without a screw
  screw_torque_n_mm,       ///< its largest insertion torque, likewise
  max_temperature_c,       ///< of the bone beside the hole so far; not a number where the study works out no heat
  outside_volume_mm,       ///< how far at most the bit cut beyond the points' cylinder; 0: not at all
  events_lost,             ///< that found no room
  error_medial_mm,         ///< the screw's error of placement, drawn: PlacementError; not a number without a model
  error_cranial_mm,        ///< likewise
  error_along_mm,          ///< likewise
  error_medial_deg,        ///< likewise
  error_cranial_deg,       ///< likewise
  turn_left_deg,           ///< the registration's error, drawn: a rotation vector
  turn_back_deg,           ///< likewise
  turn_head_deg,           ///< likewise
  shift_left_mm,           ///< and a shift of the centre of its covariance
  shift_back_mm,           ///< likewise
  shift_head_mm,           ///< likewise
  off_medial_mm,           ///< the entry from the planned one, of all errors together; not a number without landmarks
  off_cranial_mm,          ///< likewise
  off_medial_deg,          ///< the direction, likewise
  off_cranial_deg,         ///< likewise
  off_entry_mm,            ///< distance of the entry from the planned one, of all errors together
  off_target_mm,           ///< of the target
  off_angle_deg,           ///< between the line and the planned one
  screw_grade,             ///< Gertzbein-Robbins, of the screw where it lies: 0 (A) to 4 (E)
  screw_breach_mm,         ///< the deepest
  screw_breach_side,       ///< of it: PathSide; not a number without a breach
  screw_breach_depth_mm,   ///< along the path; likewise
  screw_canal_mm,          ///< breach into the canal; 0: none
  screw_anterior_mm,       ///< beyond the anterior wall; 0: none
  screw_neighbour_mm       ///< how deep another vertebra's bone lies in it; not a number where none is known
};
constexpr std::size_t kStudyColumns = static_cast<std::size_t>(StudyColumn::screw_neighbour_mm) + 1;

/// As the head of the table has it.
std::string_view name_of(StudyColumn column);

/// One run: a number for each column, not a number where there is none.
class StudyRow {
 public:
  double& operator[](StudyColumn column) { return cells_[static_cast<std::size_t>(column)]; }
  double operator[](StudyColumn column) const { return cells_[static_cast<std::size_t>(column)]; }
  double& operator[](StudyFactor factor) { return cells_[static_cast<std::size_t>(factor)]; }
  double operator[](StudyFactor factor) const { return cells_[static_cast<std::size_t>(factor)]; }

  std::size_t run() const { return static_cast<std::size_t>((*this)[StudyColumn::run]); }

 private:
  std::array<double, kStudyColumns> cells_{};
};

/// The names of the columns, comma by comma, without an end of line. The number of the run comes first.
std::string study_csv_head();
/// A row: the shortest digits that give each number back exactly, empty where there is none, grades as letters. The
/// same row gives the same text.
std::string study_csv(const StudyRow& row);
/// A row of study_csv() for other programs: what is infinite is an empty field; see append_csv_number().
std::string study_csv_for_others(std::string_view row);
/// Reads what study_csv() made. Throws Error that names the column at fault.
StudyRow read_study_csv(std::string_view text);

}  // namespace spinaltap
