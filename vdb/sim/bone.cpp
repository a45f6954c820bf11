#include "vdb/sim/bone.h"

#include <algorithm>
#include <mutex>

#include "core/anatomy/bone_density.h"
#include "core/base/error.h"
#include "core/base/staged_output.h"
#include "core/ct/made_up_slices.h"
#include "vdb/grid/bone_field.h"
#include "vdb/grid/bone_hash.h"
#include "vdb/grid/bone_model.h"
#include "vdb/grid/isosurface.h"
#include "vdb/grid/spine_file.h"
#include "vdb/picture/view.h"
#include "vdb/sim/auto_plan.h"
#include "vdb/sim/bake_ct.h"
#include "vdb/sim/bone_identity.h"
#include "vdb/sim/detail/bone_surface_error.h"

namespace spinaltap {

struct Bone::State {
  explicit State(BoneModel bone) : model(std::move(bone)) {}

  BoneModel model;
  std::filesystem::path file;  ///< that it was loaded from; empty: none
  std::once_flag has_hash, has_identity, has_shape, has_landmarks, has_walls, has_neighbours, has_surface_error,
      has_doubtful;
  std::string hash;
  BoneIdentity identity;
  std::optional<BoneShape> shape;
  Landmarks landmarks;
  std::string no_landmarks;
  std::optional<WallDistance> walls;
  std::vector<Bone> neighbours;
  std::optional<CtSurfaceError> surface_error;
  DoubtfulBone doubtful;
};

Bone::Bone(BoneModel model) : state_(std::make_shared<State>(std::move(model))) {}

namespace {

void check_inputs(std::span<const std::string> warnings, bool accepts_warnings) {
  if (warnings.empty() || accepts_warnings) return;
  std::string words;
  for (const std::string& warning : warnings) words += (words.empty() ? "" : "; ") + warning;
  fail("the CT or its label map is likely not what it seems (", words, "): look at it, then accept it");
}

}  // namespace

Bone Bone::from_ct(const std::filesystem::path& ct, const BoneFromCt& options, const Progress& progress) {
  const CtVolume volume = read_ct(ct, options.reading, progress);
  check_inputs(volume.warnings, options.accepts_warnings);  // before the work
  BakedCt baked = bake_ct(volume, options.bake, progress);
  check_inputs(input_warnings_in(baked.bone.metadata()), options.accepts_warnings);
  if (baked.warnings && baked.warnings->is_suspect() && !options.accepts_warnings) {
    std::string words;
    for (const std::string& warning : baked.warnings->warnings) words += "; " + warning;
    fail("the vertebra is likely not right (severity ", baked.warnings->severity, words,
         "): look at it, then accept it");
  }
  return Bone(std::move(baked.bone));
}

Bone Bone::load(const std::filesystem::path& file, Level level) {
  Bone bone(read_bone(file, level));
  bone.state_->file = std::filesystem::absolute(file);
  return bone;
}

void Bone::save(const std::filesystem::path& file) const {
  StagedOutput output;
  write_bone(model(), output.stage(file));
  output.commit();
}

const BoneModel& Bone::model() const { return state_->model; }

const std::string& Bone::hash() const {
  std::call_once(state_->has_hash, [&] { state_->hash = bone_hash(state_->model); });
  return state_->hash;
}

const BoneIdentity& Bone::identity() const {
  std::call_once(state_->has_identity, [&] { state_->identity = identity_of(state_->model); });
  return state_->identity;
}

std::optional<LevelWarnings> Bone::warnings() const { return warnings_in(model().metadata()); }

std::vector<std::string> Bone::input_warnings() const { return input_warnings_in(model().metadata()); }

std::vector<std::string> Bone::input_remarks() const {
  std::vector<std::string> lines = input_warnings();
  if (const std::string change = hu_change_in(model().metadata()); !change.empty()) {
    lines.push_back("its numbers were changed: " + change);
  }
  return lines;
}

Level Bone::level() const {
  const auto recorded = model().metadata().find("level");
  return recorded == model().metadata().end() ? Level::kNone : level_from_name(recorded->second).value_or(Level::kNone);
}

std::vector<float> Bone::distance(std::span<const Vec3> points_mm) const {
  std::vector<float> distance_mm(points_mm.size());
  model().sample(points_mm, distance_mm, {});
  return distance_mm;
}

std::vector<float> Bone::hu(std::span<const Vec3> points_mm) const {
  std::vector<float> hu(points_mm.size());
  model().hu(points_mm, hu, {});
  return hu;
}

std::vector<Vec3> Bone::normals(std::span<const Vec3> points_mm) const {
  std::vector<Vec3> normals(points_mm.size());
  model().normals(points_mm, normals);
  return normals;
}

HuSampler Bone::hu_sampler() const {
  return [model = model()](std::span<const Vec3> points_mm, std::span<float> hu) { model.hu(points_mm, hu, {}); };
}

TriangleMesh Bone::surface() const { return bone_surface(model()); }

View Bone::view(const Camera& camera) const { return view_bone(model(), camera); }

// Tri-quadratic values are the distance up to one voxel from the surface; see BoneModel::distance().
const BoneShape& Bone::shape(const Progress& progress) const {
  std::call_once(state_->has_shape, [&] {
    state_->shape.emplace(std::make_shared<BoneField>(model()), model().bounds_mm(), model().voxel_mm(), progress);
  });
  return *state_->shape;
}

const std::string& Bone::no_landmarks(const Progress& progress) const {
  std::call_once(state_->has_landmarks, [&] {
    const BoneShape& its_shape = shape(progress);
    try {
      state_->landmarks = find_landmarks(its_shape, progress);
    } catch (const Cancelled&) {
      throw;  // the next call begins again
    } catch (const Error& error) {
      state_->no_landmarks = error.what();
      state_->landmarks = {};
      state_->landmarks.is_canal_wall.assign(its_shape.points_mm().size(), 0);
    }
  });
  return state_->no_landmarks;
}

const Landmarks& Bone::landmarks(const Progress& progress) const {
  if (!no_landmarks(progress).empty()) fail(state_->no_landmarks);
  return state_->landmarks;
}

const WallDistance& Bone::walls(const Progress& progress) const {
  no_landmarks(progress);
  std::call_once(state_->has_walls, [&] { state_->walls.emplace(*state_->shape, state_->landmarks); });
  return *state_->walls;
}

const std::vector<Bone>& Bone::neighbours() const {
  std::call_once(state_->has_neighbours, [&] {
    if (state_->file.empty()) return;
    const std::vector<Level> levels = levels_in(state_->file);  // from the head down
    const auto own = std::find(levels.begin(), levels.end(), level());
    if (own == levels.end()) return;
    if (own != levels.begin()) state_->neighbours.push_back(load(state_->file, *(own - 1)));
    if (own + 1 != levels.end()) state_->neighbours.push_back(load(state_->file, *(own + 1)));
  });
  return state_->neighbours;
}

const DoubtfulBone& Bone::doubtful() const {
  std::call_once(state_->has_doubtful, [&] {
    state_->doubtful = {made_up_in(model().metadata()), warnings().value_or(LevelWarnings{}).unsure_mm};
  });
  return state_->doubtful;
}

std::optional<CtSurfaceError> Bone::surface_error() const {
  std::call_once(state_->has_surface_error, [&] { state_->surface_error = bone_surface_error(model(), shape()); });
  return state_->surface_error;
}

std::vector<Suggestion> Bone::suggest(const AutoPlanOptions& options, const Progress& progress) const {
  landmarks(progress);
  AutoPlanOptions settings = options;
  if (settings.level == Level::kNone) settings.level = level();
  std::vector<Suggestion> suggestions = auto_plan(walls(progress), hu_sampler(), settings, progress);
  const auto finish = [&](SuggestedPath& one) {
    note_doubts(doubtful(), one.path, one.grade);
    one.path.bone = identity();
  };
  for (Suggestion& suggestion : suggestions) {
    if (suggestion.best) finish(*suggestion.best);
    for (SuggestedPath& other : suggestion.others) finish(other);
  }
  return suggestions;
}

std::vector<Neighbour> neighbours_among(std::span<const Bone> bones, const Progress& progress) {
  std::vector<Neighbour> neighbours;
  neighbours.reserve(bones.size());
  for (const Bone& bone : bones) neighbours.push_back({bone.level(), &bone.shape(progress)});
  return neighbours;
}

ScrewFixation screw_fixation(const Bone& bone, const DrillPath& path, const HuToDensity& calibration,
                             const FixationModel& model) {
  return screw_fixation(path, bone_density(bone.shape(), bone.hu_sampler(), calibration), model);
}

PathGrade grade(const Bone& bone, const DrillPath& path, const GradeOptions& options, const Material& material,
                const Progress& progress) {
  if (!path.bone.is_empty()) check_path_is_of(path, bone.identity());
  bone.landmarks(progress);
  PathGrade graded = grade_path(bone.walls(progress), bone.hu_sampler(), material, path, options);
  if (!bone.neighbours().empty()) note_neighbours(neighbours_among(bone.neighbours(), progress), path, graded);
  note_doubts(bone.doubtful(), path, graded);
  return graded;
}

}  // namespace spinaltap
