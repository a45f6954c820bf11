#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/anatomy/landmarks.h"
#include "core/anatomy/wall_distance.h"
#include "core/base/geometry.h"
#include "core/base/progress.h"
#include "core/base/triangle_mesh.h"
#include "core/base/view.h"
#include "core/ct/bone_identity.h"
#include "core/ct/hu_to_density.h"
#include "core/ct/level.h"
#include "core/ct/read_ct.h"
#include "core/grading/grade.h"
#include "core/grading/path_findings.h"
#include "core/grading/screw_fixation.h"
#include "core/plan/suggest.h"
#include "core/points/material.h"
#include "core/segment/level_figures.h"
#include "core/tool/drill_path.h"
#include "core/uncertainty/ct_surface_error.h"
#include "vdb/bake/bake_options.h"
#include "vdb/grid/bone_model.h"

namespace spinaltap {

class BoneShape;

/// How Bone::from_ct() reads, finds and bakes.
struct BoneFromCt {
  CtReadOptions reading = {};
  BakeCtOptions bake = {};  ///< which vertebra, and how it is baked
  /// Take a vertebra or a CT that is likely not right; what speaks against them is kept: Bone::warnings() and
  /// input_warnings().
  bool accepts_warnings = false;
};

/// A baked bone and all that planning and drilling ask of it. Copies share what they stand on; nothing changes it, and
/// any number of threads may use it at once. What takes seconds to work out (shape, landmarks, walls) is worked out
/// when it is first asked for, and kept.
class Bone {
 public:
  /// Of grids that are there: read_bone(), bake_bone().
  explicit Bone(BoneModel model);

  /// From a folder with a DICOM series, or a NIfTI file: reads, segments, fits and bakes. Throws Error as read_ct() and
  /// bake_ct() do, and on a vertebra or a CT that is suspect where that was not accepted.
  static Bone from_ct(const std::filesystem::path& ct, const BoneFromCt& options = {}, const Progress& progress = {});
  /// From a bone.vdb, or one level of a spine.vdb. Throws Error as read_bone() does.
  static Bone load(const std::filesystem::path& file, Level level = Level::kNone);
  /// Writes a bone.vdb, whole or not at all. Throws Error when the disk is full.
  void save(const std::filesystem::path& file) const;

  /// Its grids.
  const BoneModel& model() const;
  /// A fingerprint of its grids: the same however the file was written.
  const std::string& hash() const;
  /// What whoever marked it thinks of it; nothing where it was marked by hand.
  std::optional<LevelWarnings> warnings() const;
  /// What speaks against the CT and the label map that it was made of, a line each.
  std::vector<std::string> input_warnings() const;
  /// These, and what was made of the CT's numbers before, in words: what reports say.
  std::vector<std::string> input_remarks() const;

  /// Which vertebra of which CT it is; see identity_of(). Plans, records and registrations of it name that.
  const BoneIdentity& identity() const;
  /// Which vertebra it is; kNone where the file does not say.
  Level level() const;

  /// At places (patient LPS, mm): distance to the surface (mm, negative inside, at most the band's width), CT number
  /// (HU), and unit normals (outward; zero further than the band). See BoneModel.
  std::vector<float> distance(std::span<const Vec3> points_mm) const;
  std::vector<float> hu(std::span<const Vec3> points_mm) const;
  std::vector<Vec3> normals(std::span<const Vec3> points_mm) const;
  /// Of baked CT numbers, for grading; keeps the bone.
  HuSampler hu_sampler() const;
  /// Triangles, outward, patient LPS, mm.
  TriangleMesh surface() const;
  /// What a camera sees of it: depth, normals, a mask. See view_bone().
  View view(const Camera& camera) const;

  /// Samples of its surface: for the library itself, BoneShape is not promised.
  const BoneShape& shape(const Progress& progress = {}) const;
  /// Throws Error where the bone has none: it is no vertebra, or not a whole one.
  const Landmarks& landmarks(const Progress& progress = {}) const;
  /// Why there are no landmarks; empty where there are.
  const std::string& no_landmarks(const Progress& progress = {}) const;
  /// Distances to the outer surface and, where there are landmarks, to the canal.
  const WallDistance& walls(const Progress& progress = {}) const;

  /// The vertebrae next above and below it in the spine.vdb that it was loaded from, which is read when they are first
  /// asked for; none of any other bone. Throws Error as load() does.
  const std::vector<Bone>& neighbours() const;

  /// Where it is open whether there is bone, or whose it is: slices that were made up, and what its segmentation was
  /// unsure of.
  const DoubtfulBone& doubtful() const;

  /// How well the CT that it was baked from shows its surface; nothing where the CT's noise is not known.
  std::optional<CtSurfaceError> surface_error() const;

  /// A screw and a path for each pedicle, with its grade, or why there is none. Throws Error without landmarks.
  std::vector<Suggestion> suggest(const AutoPlanOptions& options = {}, const Progress& progress = {}) const;

 private:
  struct State;
  std::shared_ptr<State> state_;
};

/// How well a path's screw holds; see core/grading/screw_fixation.h. Throws Error as that does.
ScrewFixation screw_fixation(const Bone& bone, const DrillPath& path, const HuToDensity& calibration = {},
                             const FixationModel& model = {});

/// As what instruments may meet. The bones must outlive it.
std::vector<Neighbour> neighbours_among(std::span<const Bone> bones, const Progress& progress = {});

/// How safe a path is; see grade_path(), of bone.neighbours() note_neighbours(), and of bone.doubtful() note_doubts().
/// Throws Error without landmarks.
PathGrade grade(const Bone& bone, const DrillPath& path, const GradeOptions& options = {},
                const Material& material = {}, const Progress& progress = {});

}  // namespace spinaltap
