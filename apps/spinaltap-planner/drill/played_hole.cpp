#include "apps/spinaltap-planner/drill/played_hole.h"

#include <algorithm>
#include <limits>
#include <utility>

#include "apps/report/drilling_report.h"
#include "apps/report/picture_view.h"
#include "apps/report/text.h"
#include "apps/spinaltap-planner/navigation/record_source.h"
#include "core/base/error.h"
#include "core/base/text_writer.h"
#include "core/files/data_files.h"
#include "core/files/material_file.h"
#include "core/files/thermal_bone_file.h"
#include "core/session/choose_engine.h"
#include "core/session/cutting_motion.h"
#include "core/session/operator/recorded_motion.h"
#include "mesh/remaining_mesh.h"
#include "vdb/grid/bone_field.h"
#include "vdb/sim/drilling.h"

namespace spinaltap {
namespace {

constexpr double kFurtherMm = 20.0;  // operators may go further than the target

OperatorPlan plan_operator(const OperatorChoice& choice, const SessionSetup& setup, const Bone& bone,
                           NavigationSource* source, const Progress& progress) {
  if (source != nullptr) return source->begin(setup, progress);
  const BoneField whole(bone.model());
  return choice.plan(setup.path, setup.volume.lead_in_mm, setup.options.spindle, false, &whole);
}

}  // namespace

OperatorChoice operator_choice(const DrillPlan& plan) {
  OperatorChoice choice;
  if (plan.source) return choice;
  choice.name = plan.tool_operator;
  if (plan.tool_operator == "milling") {
    if (!plan.milling) fail("expected a milling for the operator: choose its file first");
    choice.milling = plan.milling;
  } else if (plan.tool_operator == "push") {
    choice.push_n = plan.push_n;
  } else {
    choice.feed = short_text(plan.feed_mm_s);
  }
  return choice;
}

SessionSetup session_setup(const DrillPath& path, const DrillPlan& plan) {
  SessionSetup setup;
  setup.path = path;
  const HuToDensity density = read_density_calibration(data_file("densities/vertebra.json")).line;
  setup.material = read_material(data_file("materials/vertebra.json"), density);
  setup.engine = plan.engine;
  const bool is_milling = plan.tool_operator == "milling";
  setup.has_clearances = !is_milling;
  setup.options.stop.on_breach = plan.stops_on_breach && !is_milling;
  if (!is_milling && !path.bit.is_plate()) setup.options.heat = HeatOptions{.bone = shipped_thermal_bone()};
  if (plan.source) plan.source->prepare(setup);
  return setup;
}

namespace {

/// Whether a plan of another bone is to be taken was asked when it was opened.
SessionSetup for_bone(SessionSetup setup, const Bone& bone) {
  setup.bone = bone.identity();
  setup.takes_other_ct = !may_be_same(setup.path.bone, setup.bone);
  return setup;
}

}  // namespace

PlayedHole::PlayedHole(std::shared_ptr<const OpenedBone> bone, SessionSetup setup, OperatorChoice tool_operator,
                       const PlayedHole* other, const Progress& progress, std::shared_ptr<NavigationSource> source)
    : bone_(std::move(bone)),
      setup_(setup_for(for_bone(std::move(setup), *bone_->bone),
                       source ? MotionClass{.is_free = true} : tool_operator.motion_class())),
      choice_(std::move(tool_operator)),
      source_(std::move(source)),
      session_(*bone_->bone, setup_.path, setup_, progress, other == nullptr ? nullptr : &other->session_),
      log_(DrillingOptions().log_step_mm, setup_.material,
           setup_.volume.lead_in_mm + setup_.path.length_mm() + kFurtherMm) {
  // Last: a device or a link that waits is not to wait for the bone as well.
  operator_ = plan_operator(choice_, setup_, *bone_->bone, source_.get(), progress);
}

PlayedHole::~PlayedHole() { stop(); }

void PlayedHole::stop() {
  if (!source_ || !source_->is_live()) return;
  is_over_ = true;
  operator_.tool_operator.reset();
  operator_.device.reset();
  source_->end();
}

bool PlayedHole::step() {
  if (!operator_.tool_operator) return false;
  const std::optional<ToolInput> input = operator_.tool_operator->next(session_.feedback());
  if (!input) {
    is_over_ = true;
    return false;
  }
  const Cycle& cycle = session_.step_input(*input);
  inputs_.push_back(*input);
  removed_ += cycle.step.removed;
  log_.add(cycle, std::numeric_limits<double>::quiet_NaN());  // a clock would make other rows of the same cycles
  if (source_) source_->tell(session_);
  return true;
}

std::unique_ptr<PlayedHole> PlayedHole::after(std::size_t cycles, const Progress& progress) const {
  std::shared_ptr<NavigationSource> source = source_;
  if (source && source->is_live()) {
    // Nobody moves a hand the same way again: what it did is all there is.
    source = std::make_shared<RecordSource>(
        setup_, std::vector<ToolInput>(inputs_.begin(), inputs_.begin() + static_cast<std::ptrdiff_t>(cycles)),
        operator_.words);
  }
  auto hole = std::make_unique<PlayedHole>(bone_, setup_, choice_, this, progress, std::move(source));
  ProgressCounter counter(progress, "going back", cycles);
  while (hole->inputs_.size() < cycles && hole->step()) counter.add();
  return hole;
}

std::size_t PlayedHole::cycles_before(double seconds) const {
  std::size_t cycles = inputs_.size();
  double past_s = 0.0;
  while (cycles > 1 && past_s < seconds - 0.5 * inputs_[cycles - 1].dt_s) past_s += inputs_[--cycles].dt_s;
  return std::max<std::size_t>(cycles, 1);
}

DrilledHole PlayedHole::drilled() const { return hole_of(inputs_, setup_); }

void write_record(const DoneDrilling& drilling, const std::filesystem::path& path, const Progress& progress) {
  Session session(*drilling.bone->bone, drilling.setup.path, drilling.setup, progress);
  session.record(path, {.words = record_words(drilling.operator_words, "planner"), .may_replace = true});
  RecordedMotion tool_operator(drilling.inputs, false);
  session.run(tool_operator, {}, progress);
  session.end_record();
}

void write_report(const DoneDrilling& drilling, const std::filesystem::path& folder, const Progress& progress) {
  const DrillPath& path = drilling.setup.path;
  RecordedMotion tool_operator(drilling.inputs, false);
  const Drilling again = drill_bone(*drilling.bone->bone, drilling.setup, tool_operator, {}, progress);
  progress.report("meshing", 0.0);
  TriangleMesh surface = sharp_surface(again.drilled);
  const LooseChips chips = drop_loose_chips(surface);
  const MeshQuality quality = measure_mesh(surface);
  DrillReportData data =
      report_data("Drilling " + path.name, &drilling.bone->ct,
                  {again, *drilling.bone->bone, drilling.setup, drilling.operator_words, quality, chips});
  data.renders = drill_pictures(again.before, again.drilled, path, progress);
  data.notes.emplace_back("Drilled in the planner. Rates are those of the same cycles run again as fast as they go.");
  if (!drilling.setup.holes.empty()) {
    data.notes.push_back("Holes that were in the bone before: " + std::to_string(drilling.setup.holes.size()) + ".");
  }
  StagedOutput output;
  stage_drilling(again, surface, data, folder, output);
  output.list_in(folder);
  output.commit();
}

}  // namespace spinaltap
