#include "apps/report/picture_view.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <sstream>
#include <utility>

#include "core/base/error.h"
#include "core/base/text_fields.h"
#include "core/tool/path_curve.h"
#include "vdb/picture/render.h"

namespace spinaltap {
namespace {

/// 1 where the path enters on the patient's left of the bone's middle, -1 on the right.
double side_of(const DrillPath& path, const BoneModel& bone) {
  return path.entry_mm.x() >= bone.bounds_mm().center().x() ? 1.0 : -1.0;
}

std::optional<Vec3> direction_of(const std::string& text) {
  std::istringstream parts(text);
  std::string part;
  Vec3 direction = Vec3::Zero();
  Eigen::Index count = 0;
  for (; std::getline(parts, part, ','); ++count) {
    const std::optional<double> value = parse_number(part);
    if (!value || count == 3) return std::nullopt;
    direction[count] = *value;
  }
  if (count != 3 || !direction.allFinite() || !(direction.norm() > 0.0)) return std::nullopt;
  return direction.normalized();
}

const DrillPath& path_for(const DrillPath* path, const char* what) {
  if (path == nullptr) fail(what, " needs a path: give a plan (--plan) or a record (--record)");
  return *path;
}

}  // namespace

PictureView view_of_hole(const DrillPath& path, const BoneModel& bone) {
  return {-path.direction() + side_of(path, bone) * 0.45 * Vec3::UnitX() + 0.25 * Vec3::UnitZ(), Vec3::UnitZ()};
}

CutPlane cut_along_path(const DrillPath& path) {
  const Vec3 along = path.direction();
  const Vec3 upward = Vec3::UnitZ() - Vec3::UnitZ().dot(along) * along;
  // Straight down a path from head to foot there is no such plane: any that holds it will do.
  return {path.entry_mm, upward.norm() > 1e-6 ? Vec3(-upward.normalized()) : Vec3(Vec3::UnitX())};
}

CutPlane upright_cut(const DrillPath& path, const BoneModel& bone) {
  Vec3 normal = path.direction().cross(cut_along_path(path).normal).normalized();
  if (normal.x() * side_of(path, bone) < 0.0) normal = -normal;
  return {path.entry_mm, normal};
}

PictureView view_onto(const CutPlane& cut) {
  constexpr double kUpright = 0.7;  // more upright views have the patient's front up
  const bool is_from_below = std::abs(cut.normal.z()) > kUpright;
  return {cut.normal, is_from_below ? Vec3(-Vec3::UnitY()) : Vec3(Vec3::UnitZ())};
}

PictureView named_view(const std::string& name, const DrillPath* path, const BoneModel& bone) {
  static const std::map<std::string, PictureView> views{
      {"behind", {Vec3::UnitY(), Vec3::UnitZ()}}, {"front", {-Vec3::UnitY(), Vec3::UnitZ()}},
      {"left", {Vec3::UnitX(), Vec3::UnitZ()}},   {"right", {-Vec3::UnitX(), Vec3::UnitZ()}},
      {"above", {Vec3::UnitZ(), -Vec3::UnitY()}}, {"below", {-Vec3::UnitZ(), -Vec3::UnitY()}},
  };
  if (name == "hole") return view_of_hole(path_for(path, "the view \"hole\""), bone);
  if (const auto found = views.find(name); found != views.end()) return found->second;
  const std::optional<Vec3> direction = direction_of(name);
  if (!direction) {
    fail("view: expected behind, front, left, right, above, below, hole or a direction x,y,z; found \"", name, "\"");
  }
  const bool is_upright = std::abs(direction->z()) < 0.99;
  return {*direction, is_upright ? Vec3(Vec3::UnitZ()) : Vec3(-Vec3::UnitY())};
}

CutPlane named_cut(const std::string& name, const DrillPath* path, const BoneModel& bone) {
  const Vec3 middle_mm =
      path != nullptr ? Vec3(0.5 * (path->entry_mm + path->target_mm)) : Vec3(bone.bounds_mm().center());
  if (name == "axial") return {middle_mm, -Vec3::UnitZ()};
  if (name == "sagittal") return {middle_mm, Vec3::UnitX()};
  if (name == "coronal") return {middle_mm, Vec3::UnitY()};
  if (name == "path") return cut_along_path(path_for(path, "the cut \"path\""));
  if (name == "upright") return upright_cut(path_for(path, "the cut \"upright\""), bone);
  fail("cut: expected axial, sagittal, coronal, path or upright; found \"", name, "\"");
}

std::vector<ReportPicture> planned_pictures(const BoneModel& bone, const std::vector<DrillPath>& paths,
                                            const Progress& progress) {
  RenderOptions options;
  options.width = 480;
  options.height = 300;
  options.opacity = 0.55;
  Box3 shown_mm = bone.bounds_mm();
  for (const DrillPath& path : paths) {
    const PathCurve curve(path);
    options.tools.push_back(
        {path.screw ? path.screw->outline() : path.bit, {path.target_mm, curve.direction_at(curve.length_mm())}});
    if (path.is_curved()) options.paths.push_back(path);
    if (const std::optional<BodyBehind> head = head_of(path)) {
      options.tools.push_back({head->outline, head->pose});
      const Vec3 end_mm = head->pose.tip_mm - head->outline.length_mm * head->pose.axis;
      for (const Vec3& p_mm : {head->pose.tip_mm, end_mm}) {
        const Vec3 around_mm = Vec3::Constant(0.5 * head->outline.diameter_mm);
        shown_mm.extend(Box3(Vec3(p_mm - around_mm), Vec3(p_mm + around_mm)));
      }
    }
  }
  std::vector<ReportPicture> pictures;
  for (const auto& [name, caption] :
       {std::pair{"behind", "From behind"}, std::pair{"left", "From the patient's left"},
        std::pair{"right", "From the patient's right"}, std::pair{"above", "From above"}}) {
    const PictureView view = named_view(name, nullptr, bone);
    options.from = view.from;
    options.up = view.up;
    const Vec3 right = view.up.cross(view.from).cwiseAbs();
    const double wide_mm = right.dot(shown_mm.sizes());
    const double high_mm = view.up.cwiseAbs().dot(shown_mm.sizes());
    options.close_up = CloseUp{shown_mm.center(), 1.04 * std::max(wide_mm, high_mm * options.width / options.height)};
    pictures.push_back({render_bone(bone, options, progress), caption});
  }
  return pictures;
}

std::vector<ReportPicture> drill_pictures(const BoneModel& bone, const BoneModel& drilled, const DrillPath& path,
                                          const Progress& progress) {
  const RenderOptions behind{.from = Vec3(0.0, 1.0, 0.3)};
  const auto seen = [](const PictureView& view, const std::optional<CutPlane>& cut) {
    RenderOptions options;
    options.from = view.from;
    options.up = view.up;
    options.cut = cut;
    return options;
  };
  const RenderOptions oblique = seen(view_of_hole(path, bone), {});
  const CutPlane along = cut_along_path(path);
  const CutPlane upright = upright_cut(path, bone);

  std::vector<ReportPicture> pictures;
  pictures.push_back({render_bone(bone, behind, progress), "Before, from behind"});
  pictures.push_back({render_drilled(drilled, pictures.back().image, behind, progress), "After, from behind"});
  pictures.push_back({render_bone(bone, oblique, progress), "Before, from the side of the hole"});
  pictures.push_back(
      {render_drilled(drilled, pictures.back().image, oblique, progress), "After, from the side of the hole"});
  pictures.push_back(
      {render_bone(drilled, seen(view_onto(along), along), progress),
       "After, cut open along the path and seen from the feet, as on the axial slice: cancellous bone red, cortex "
       "white, by CT number"});
  pictures.push_back({render_bone(drilled, seen(view_onto(upright), upright), progress),
                      "After, cut upright along the path and seen from the side of the hole"});
  return pictures;
}

}  // namespace spinaltap
