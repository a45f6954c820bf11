#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <memory>
#include <optional>

#include "apps/report/picture_view.h"
#include "apps/report/png.h"
#include "apps/report/view_picture.h"
#include "apps/spinaltap/command.h"
#include "apps/spinaltap/input_warnings.h"
#include "apps/spinaltap/level_output.h"
#include "apps/spinaltap/plan_check.h"
#include "core/base/error.h"
#include "core/base/staged_output.h"
#include "core/base/text_fields.h"
#include "core/base/text_writer.h"
#include "core/files/plan_file.h"
#include "core/files/recorded_setup.h"
#include "vdb/grid/bone_hash.h"
#include "vdb/picture/render.h"
#include "vdb/picture/view.h"
#include "vdb/sim/bone_identity.h"
#include "vdb/sim/recorded_hole.h"
#include "vdb/sim/replay.h"

namespace spinaltap {
namespace {

struct Options {
  std::filesystem::path bone, output = "bone.png", plan, record, frames;
  Level level = Level::kNone;
  std::string path, view, cut, size = "900x700";
  std::optional<double> at_s;
  std::optional<double> close_up_mm;
  double opacity = 1.0;
  double frames_per_s = 25.0;
  double speed = 1.0;
  bool is_depth = false;
  PlanCheckOptions check;
};

/// "900x700"
std::array<int, 2> size_of(const std::string& text) {
  std::array<int, 2> size{};
  const char* const end = text.data() + text.size();
  const auto [next, trouble] = std::from_chars(text.data(), end, size[0]);
  if (trouble == std::errc() && next != end && *next == 'x') {
    const auto [last, also] = std::from_chars(next + 1, end, size[1]);
    if (also == std::errc() && last == end) return size;
  }
  fail("size: expected WIDTHxHEIGHT in pixels, such as 900x700; found \"", text, "\"");
}

/// The record that is shown, and what it drills.
struct Recorded {
  SessionRecord record;
  SessionSetup setup;

  Recorded(const std::filesystem::path& file, const BoneModel& bone)
      : record(read_record(file)), setup(recorded_setup(record.setup, file)) {
    const std::string hash = bone_hash(bone);
    if (hash != setup.bone_hash && std::ranges::count(setup.further_bone_hashes, hash) == 0) {
      fail("expected the bone that was drilled in ", file.string(), ", before it was; found another one");
    }
  }
};

/// One picture after the other from the same place.
class Painter {
 public:
  Painter(const Options& options, const BoneModel& before, std::vector<DrillPath> paths) {
    const std::array<int, 2> size = size_of(options.size);
    const DrillPath* const path = paths.empty() ? nullptr : &paths.front();
    if (!options.cut.empty()) render_.cut = named_cut(options.cut, path, before);
    PictureView view{Vec3(0.0, 1.0, 0.3), Vec3::UnitZ()};
    if (!options.view.empty()) {
      view = named_view(options.view, path, before);
    } else if (render_.cut) {
      view = view_onto(*render_.cut);
    }
    // What lies between the eye and the plane is taken away.
    if (render_.cut && render_.cut->normal.dot(view.from) < 0.0) render_.cut->normal = -render_.cut->normal;
    render_.width = size[0];
    render_.height = size[1];
    render_.from = view.from;
    render_.up = view.up;
    render_.opacity = options.opacity;
    if (options.close_up_mm) {
      if (path == nullptr) fail("--close-up needs a path: give a plan (--plan) or a record (--record)");
      render_.close_up = CloseUp{path->entry_mm, *options.close_up_mm};
    }
    render_.paths = std::move(paths);
    if (options.is_depth) camera_ = camera_from(view, before);
  }

  void show(const DrillBit& bit, const Pose& pose) { render_.bit = RenderedBit{bit, pose}; }

  std::string png(const BoneModel& bone, const Progress& progress) const {
    if (camera_) return encode_png(view_picture(view_bone(bone, *camera_, render_.bit)));
    return encode_png(render_bone(bone, render_, progress));
  }

 private:
  /// So far away that the whole bone is seen, or what is to be seen of it.
  Camera camera_from(const PictureView& view, const BoneModel& before) const {
    constexpr double kFieldOfView = 30.0 * kDegree;
    const Box3 box_mm = before.bounds_mm();
    const Vec3 centre_mm = render_.close_up ? render_.close_up->centre_mm : box_mm.center();
    const double width_mm = render_.close_up ? render_.close_up->width_mm : box_mm.diagonal().norm();
    const double away_mm = 0.5 * width_mm / std::tan(0.5 * kFieldOfView);
    return look_at(centre_mm + away_mm * view.from.normalized(), centre_mm, view.up, kFieldOfView, render_.width,
                   render_.height);
  }

  RenderOptions render_;
  std::optional<Camera> camera_;
};

std::vector<DrillPath> paths_of(const Options& options, const std::optional<Recorded>& recorded) {
  if (recorded) return {recorded->setup.path};
  if (options.plan.empty()) return {};
  std::vector<DrillPath> paths = read_plan(options.plan);
  if (options.path.empty()) return paths;
  return {choose_path(paths, options.path)};
}

/// Throws Error where a path names another bone, unless that is taken.
void check_paths(const Options& options, const std::vector<DrillPath>& paths, const BoneModel& bone) {
  std::vector<std::string> notes;
  options.check.check_paths(paths, identity_of(bone), notes);
  for (const std::string& note : notes) print_figure("note", note);
}

/// Numbered pictures at even times of a record, from its begin to its end.
Json write_frames(const Options& options, Painter& painter, RecordedHole& hole, const Progress& progress) {
  constexpr double kMaxFrames = 1e5;
  const double step_s = options.speed / options.frames_per_s;
  const double last = std::ceil(hole.end_s() / step_s);
  if (!(last < kMaxFrames)) fail("frames: expected fewer than ", kMaxFrames, ", found ", last);
  const auto count = static_cast<std::size_t>(last) + 1;
  StagedOutput output;
  for (std::size_t n = 0; n < count; ++n) {
    progress.report("drawing frames", static_cast<double>(n) / static_cast<double>(count));
    hole.go_to(static_cast<double>(n) * step_s);
    painter.show(hole.tool(), hole.pose());
    output.write(options.frames / (padded_number(n + 1, 5) + ".png"), painter.png(hole.drilled(), {}));
  }
  output.list_in(options.frames);
  output.commit();
  progress.report("drawing frames", 1.0);
  print_figure("frames", static_cast<double>(count), "", 0);
  print_figure("written", options.frames.string());
  return {{"frames", count}, {"seconds", hole.end_s()}, {"frames_per_s", options.frames_per_s}};
}

Json write_picture(const Options& options, const Painter& painter, const BoneModel& bone, const Progress& progress) {
  StagedOutput output;
  output.write(options.output, painter.png(bone, progress));
  output.commit();
  print_figure("written", options.output.string());
  return {{"picture", options.output.string()}};
}

Json draw(const Options& options, const BoneModel& bone, const Progress& progress) {
  const BoneModel before = before_drilling(bone);
  std::optional<Recorded> recorded;
  if (!options.record.empty()) recorded.emplace(options.record, bone);
  const std::vector<DrillPath> paths = paths_of(options, recorded);
  if (!recorded) check_paths(options, paths, bone);
  Painter painter(options, before, paths);
  if (!recorded) return write_picture(options, painter, bone, progress);
  RecordedHole hole(bone, recorded->record, recorded->setup);
  if (!options.frames.empty()) return write_frames(options, painter, hole, progress);
  hole.go_to(options.at_s.value_or(hole.end_s()));
  painter.show(hole.tool(), hole.pose());
  return write_picture(options, painter, hole.drilled(), progress);
}

Json render(const Options& options, const Progress& progress) {
  const BoneModel bone = read_bone(options.bone, options.level);
  Json figures = Json::object();
  report_bone_warnings(bone, figures);
  figures.update(draw(options, bone, progress));
  return figures;
}

}  // namespace

void add_render(CLI::App& program, Command& command) {
  const auto options = std::make_shared<Options>();
  CLI::App* app = add_command(
      program, command, "render", "Draw a bone, its paths and holes as PNG, or the frames of a film of a record",
      "Example: spinaltap render bone.vdb --plan plan.json --opacity 0.4 -o planned.png\n"
      "         spinaltap render drilled.vdb --plan plan.json --cut path -o cut.png\n"
      "         spinaltap render bone.vdb --record run.h5 --at 12.5 --view hole -o moment.png\n"
      "         spinaltap render bone.vdb --record run.h5 --cut upright --frames film --fps 25\n"
      "Walls of holes and cuts are coloured by CT number, cancellous bone red to cortex white. No display is needed.");
  app->add_option("bone", options->bone,
                  "bone.vdb, spine.vdb or drilled.vdb; with --record the bone before it was drilled")
      ->required()
      ->type_name("BONE");
  add_level(*app, options->level);
  app->add_option("-o,--output", options->output, "The picture to write")->capture_default_str()->type_name("FILE");
  CLI::Option* plan = app->add_option("--plan", options->plan, "Draw the paths of this plan")->type_name("FILE");
  options->check.add_other_ct(*app);
  app->add_option("--path", options->path, "Of these, only the one of this name")->needs(plan)->type_name("NAME");
  CLI::Option* record =
      app->add_option("--record", options->record, "Drill what this record holds, and draw its bit and path");
  record->excludes(plan)->type_name("RECORD");
  CLI::Option* at = app->add_option("--at", options->at_s, "Up to this moment of the record, s; default: its end");
  at->needs(record)->check(CLI::NonNegativeNumber);
  app->add_option("--view", options->view,
                  "From where: behind, front, left, right (of the patient), above, below, hole, or the direction to\n"
                  "the eye as x,y,z; default: behind and a little above, or straight onto the cut")
      ->type_name("NAME");
  CLI::Option* depth = app->add_flag(
      "--depth", options->is_depth,
      "Depth, normals and mask of a pinhole camera side by side, each of that size, as programs get them");
  app->add_option("--cut", options->cut,
                  "Cut the bone open: axial, sagittal, coronal through the path's middle, or path, upright along it")
      ->excludes(depth)
      ->type_name("NAME");
  app->add_option("--close-up", options->close_up_mm, "Show only so much around the path's entry, mm across")
      ->check(CLI::PositiveNumber);
  app->add_option("--opacity", options->opacity, "Of the bone's own surface, 0 to 1")
      ->capture_default_str()
      ->check(CLI::Range(0.0, 1.0));
  app->add_option("--size", options->size, "Width and height, pixels")->capture_default_str()->type_name("WxH");
  CLI::Option* frames =
      app->add_option("--frames", options->frames, "Write 00001.png, 00002.png, ... of the whole record there");
  frames->needs(record)->excludes(at)->type_name("FOLDER");
  app->add_option("--fps", options->frames_per_s, "Frames a second")
      ->needs(frames)
      ->capture_default_str()
      ->check(CLI::PositiveNumber);
  app->add_option("--speed", options->speed, "Seconds of the record in a second of the film")
      ->needs(frames)
      ->capture_default_str()
      ->check(CLI::PositiveNumber);
  command.outputs = [options]() -> std::vector<std::filesystem::path> {
    if (options->frames.empty()) return {options->output};
    return {options->frames / "00001.png", options->frames / StagedOutput::kListName};
  };
  command.run = [options](const Progress& progress) { return render(*options, progress); };
}

}  // namespace spinaltap
