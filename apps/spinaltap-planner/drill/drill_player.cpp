#include "apps/spinaltap-planner/drill/drill_player.h"

#include <QMetaObject>
#include <algorithm>
#include <exception>
#include <utility>

#include "apps/spinaltap-planner/drill/drill_threads.h"
#include "core/base/error.h"
#include "vdb/remaining/live_mesh.h"

namespace spinaltap {
namespace {

constexpr int kLookMs = 33;
constexpr double kRateS = 0.5;  ///< over which rates are measured
constexpr std::size_t kUndoBytes = std::size_t{1} << 30U;

double seconds_since(std::chrono::steady_clock::time_point then) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - then).count();
}

}  // namespace

DrillPlayer::DrillPlayer(PlanDocument& document, QObject* parent) : QObject(parent), document_(document) {
  timer_.setInterval(kLookMs);
  timer_.setTimerType(Qt::PreciseTimer);
  connect(&timer_, &QTimer::timeout, this, &DrillPlayer::look);
  connect(&job_, &BackgroundJob::finished, this, &DrillPlayer::end_preparing);
  connect(&document_, &PlanDocument::bone_changed, this, &DrillPlayer::reset);
}

DrillPlayer::~DrillPlayer() = default;

void DrillPlayer::start(const DrillPlan& plan) {
  guard([&] {
    stop();
    const DrillPath* path = document_.chosen_path();
    if (!document_.bone()) fail("expected a bone to drill: open a CT or a bone first");
    if (path == nullptr) fail("expected a path to drill: add or choose one first");
    if (plan.source && !plan.source->is_live() && !drilled_.empty()) {
      fail("expected the bone without holes for a record: undo its holes first");
    }
    const SessionSetup setup = session_setup(*path, plan);
    const OperatorChoice tool_operator = operator_choice(plan);
    plan_ = plan;
    Q_EMIT started();
    std::vector<std::shared_ptr<const PlayedHole>> earlier;
    for (const Hole& hole : drilled_) earlier.push_back(hole.played);
    // Undone holes too: those who drill a path again mostly undo it first.
    std::shared_ptr<const PlayedHole> known;
    if (!earlier.empty()) known = earlier.back();
    if (!undone_.empty()) known = undone_.back().played;
    prepare(tr("Preparing"),
            [this, plan, setup, tool_operator, earlier, known, bone = document_.bone(),
             mesh = mesh_](const Progress& progress) -> std::function<void()> {
              SessionSetup whole = setup;
              for (const auto& hole : earlier) whole.holes.push_back(hole->drilled());
              const auto hole = std::make_shared<PlayedHole>(bone, std::move(whole), tool_operator, known.get(),
                                                             progress, plan.source);
              progress.report("meshing", 0.0);
              const auto drilled_mesh =
                  mesh ? mesh
                       : std::make_shared<LiveMesh>(bone->model(), RemainingBoneOptions{.voxel_mm = kSurfaceVoxelMm,
                                                                                        .undo_bytes = kUndoBytes});
              return [this, plan, hole, bone, drilled_mesh] {
                bone_ = bone;
                mesh_ = drilled_mesh;
                mesh_->end_hole();
                drilled_.push_back({hole, plan, mesh_->holes_to_undo()});
                drill_on();
              };
            });
  });
}

void DrillPlayer::stop() {
  if (state_ == State::preparing) job_.cancel();
  if (state_ == State::drilling) end_drilling();
}

bool DrillPlayer::is_over() const { return !drilled_.empty() && !threads_ && drilled_.back().played->is_over(); }
bool DrillPlayer::can_go_on() const { return state_ == State::stopped && !is_over(); }

void DrillPlayer::go_on() {
  if (can_go_on()) guard([this] { drill_on(); });
}

bool DrillPlayer::can_step_back() const {
  return (state_ == State::stopped || state_ == State::drilling) && seconds() > 0.0;
}

void DrillPlayer::step_back(double seconds) {
  if (!can_step_back()) return;
  stop();
  guard([&] {
    const std::shared_ptr<const PlayedHole> hole = drilled_.back().played;
    const std::size_t cycles = hole->cycles_before(seconds);
    prepare(tr("Going back"), [this, hole, cycles](const Progress& progress) -> std::function<void()> {
      const std::shared_ptr<PlayedHole> then = hole->after(cycles, progress);
      return [this, then] {
        drilled_.back().played = then;
        undone_.clear();
        rewind_mesh();
        set_state(State::stopped);
      };
    });
  });
}

/// Takes the last hole out of the mesh, of whose holes it is one, or more where it was drilled on after another had
/// been undone.
std::size_t DrillPlayer::undo_in_mesh() {
  const std::size_t holes = mesh_->holes_to_undo() - drilled_.back().mesh_before;
  for (std::size_t n = 0; n < holes; ++n) {
    mesh_->undo_hole();
    surface_.give(mesh_->updates());
  }
  return holes;
}

/// Drills the last hole again, as far as it now goes.
void DrillPlayer::rewind_mesh() {
  undo_in_mesh();
  const PlayedHole& hole = *drilled_.back().played;
  mesh_->take_bit(hole.setup().path.bit, hole.setup().options.max_jump_mm);
  mesh_->update(hole.inputs());
  surface_.give(mesh_->updates());
  show_hole();
}

void DrillPlayer::set_speed(double speed) {
  plan_.speed = speed;
  if (threads_) threads_->set_speed(speed);
}

bool DrillPlayer::can_undo_hole() const { return state_ == State::stopped && !drilled_.empty(); }

void DrillPlayer::undo_hole() {
  if (!can_undo_hole()) return;
  Hole hole = drilled_.back();
  hole.mesh_holes = undo_in_mesh();
  drilled_.pop_back();
  undone_.push_back(std::move(hole));
  show_hole();
  set_state(drilled_.empty() ? State::idle : State::stopped);
}

bool DrillPlayer::can_redo_hole() const { return !is_busy() && !undone_.empty(); }

void DrillPlayer::redo_hole() {
  if (!can_redo_hole()) return;
  for (std::size_t n = 0; n < undone_.back().mesh_holes; ++n) {
    mesh_->redo_hole();
    surface_.give(mesh_->updates());
  }
  drilled_.push_back(std::move(undone_.back()));
  undone_.pop_back();
  show_hole();
  set_state(State::stopped);
}

void DrillPlayer::reset() {
  threads_.reset();
  timer_.stop();
  surface_.take();
  if (state_ == State::preparing) {
    job_.cancel();
    wants_reset_ = true;
    return;
  }
  forget_all();
}

void DrillPlayer::forget_all() {
  wants_reset_ = false;
  drilled_.clear();
  undone_.clear();
  if (mesh_ && bone_ == document_.bone()) {
    mesh_->reset();
    surface_.give(mesh_->updates());
  } else {
    mesh_.reset();
    bone_.reset();
  }
  show_hole();
  set_state(State::idle);
}

void DrillPlayer::prepare(const QString& what, std::function<std::function<void()>(const Progress&)> work) {
  job_.start(what, std::move(work));
  set_state(State::preparing);
}

void DrillPlayer::end_preparing(bool is_done, const QString& trouble) {
  if (wants_reset_) {
    threads_.reset();
    forget_all();
  } else if (!is_done) {
    set_state(drilled_.empty() ? State::idle : State::stopped);
    if (!trouble.isEmpty()) Q_EMIT failed(trouble);
  }
}

void DrillPlayer::drill_on() {
  PlayedHole& hole = *drilled_.back().played;
  undone_.clear();
  mesh_->take_bit(hole.setup().path.bit, hole.setup().options.max_jump_mm);
  if (!hole.inputs().empty()) mesh_->update(hole.inputs().back());
  show_hole();
  rows_ = hole.rows();
  rates_ = {std::chrono::steady_clock::now(), hole.inputs().size(), 0};
  cycles_per_s_ = surface_updates_per_s_ = 0.0;
  known_cycles_ = hole.inputs().size();
  threads_ = std::make_unique<DrillThreads>(hole, *mesh_, plan_.speed, [this, run = ++run_] {
    QMetaObject::invokeMethod(
        this,
        [this, run] {
          if (threads_ && run == run_) end_drilling();
        },
        Qt::QueuedConnection);
  });
  timer_.start();
  set_state(State::drilling);
}

void DrillPlayer::end_drilling() {
  timer_.stop();
  threads_->stop();
  surface_.give(threads_->take_surface());
  if (cycles_per_s_ == 0.0) measure_rates(threads_->take_news(), 1e-3);
  const QString trouble = QString::fromStdString(threads_->trouble());
  threads_.reset();
  drilled_.back().played->stop();
  show_hole();
  set_state(State::stopped);
  if (!trouble.isEmpty()) Q_EMIT failed(trouble);
}

void DrillPlayer::look() {
  if (!threads_) return;
  DrillNews news = threads_->take_news();
  surface_.give(threads_->take_surface());
  measure_rates(news, kRateS);
  give_surface();
  if (!news.is_new) return;
  rows_.insert(rows_.end(), news.rows.begin(), news.rows.end());
  last_ = news.last;
  events_ = std::move(news.events);
  removed_ = news.removed;
  known_cycles_ = news.cycles;
  Q_EMIT progressed();
}

void DrillPlayer::measure_rates(const DrillNews& news, double min_s) {
  const double passed_s = seconds_since(rates_.since);
  if (passed_s < min_s || news.cycles < rates_.cycles) return;
  cycles_per_s_ = static_cast<double>(news.cycles - rates_.cycles) / passed_s;
  surface_updates_per_s_ = static_cast<double>(news.surface_updates - rates_.surface_updates) / passed_s;
  rates_ = {std::chrono::steady_clock::now(), news.cycles, news.surface_updates};
}

/// All that is known of the last hole, when no thread drills it.
void DrillPlayer::show_hole() {
  rows_.clear();
  last_.reset();
  events_.clear();
  removed_ = 0;
  if (!drilled_.empty()) {
    const PlayedHole& hole = *drilled_.back().played;
    rows_ = hole.all_rows();
    if (!hole.inputs().empty()) last_ = hole.last();
    events_.assign(hole.events().begin(), hole.events().end());
    removed_ = hole.removed();
  }
  give_surface();
  Q_EMIT progressed();
}

void DrillPlayer::give_surface() {
  if (const std::vector<SurfaceUpdate> updates = surface_.take(); !updates.empty()) Q_EMIT surface_changed(updates);
}

const DrillPath* DrillPlayer::path() const { return setup() == nullptr ? nullptr : &setup()->path; }

std::optional<std::pair<DrillBit, Pose>> DrillPlayer::bit() const {
  if (!last_) return std::nullopt;
  return std::pair{path()->bit, last_->input.pose};
}

const SessionSetup* DrillPlayer::setup() const { return drilled_.empty() ? nullptr : &drilled_.back().played->setup(); }

double DrillPlayer::spindle_rpm() const { return setup() == nullptr ? 0.0 : setup()->options.spindle.rpm; }

std::optional<DoneDrilling> DrillPlayer::done() const {
  if (state_ != State::stopped || !last_) return std::nullopt;
  return drilled_.back().played->done();
}

DrillPlayer::Progresses DrillPlayer::progresses() const {
  Progresses all;
  for (const Hole& hole : drilled_) {
    const bool is_under_way = threads_ && &hole == &drilled_.back();
    all.emplace_back(hole.played, is_under_way ? 0 : hole.played->inputs().size());
  }
  return all;
}

void DrillPlayer::mark_saved(const Progresses& written) {
  for (std::vector<Hole>* holes : {&drilled_, &undone_}) {
    for (Hole& hole : *holes) {
      for (const auto& [played, cycles] : written) {
        if (hole.played == played) hole.saved_cycles = cycles;
      }
    }
  }
}

bool DrillPlayer::has_unsaved() const {
  if (threads_) return true;
  return std::any_of(drilled_.begin(), drilled_.end(),
                     [](const Hole& hole) { return hole.saved_cycles != hole.played->inputs().size(); });
}

std::vector<HoleOrder> DrillPlayer::orders() const {
  std::vector<HoleOrder> orders;
  for (const Hole& hole : drilled_) {
    if (hole.plan.source) break;  // what a hand did is in its record alone, and the next holes began in its bone
    const bool is_under_way = threads_ && &hole == &drilled_.back();
    const std::size_t cycles = is_under_way ? known_cycles_ : hole.played->inputs().size();
    if (cycles > 0) orders.push_back({hole.played->setup().path, hole.plan, cycles});
  }
  return orders;
}

void DrillPlayer::drill_again(const std::vector<HoleOrder>& orders) {
  guard([&] {
    reset();
    if (!document_.bone()) fail("expected a bone to drill: open a CT or a bone first");
    if (orders.empty()) return;
    prepare(tr("Drilling again"), [this, orders, bone = document_.bone()](const Progress& progress) {
      const auto mesh = std::make_shared<LiveMesh>(
          bone->model(), RemainingBoneOptions{.voxel_mm = kSurfaceVoxelMm, .undo_bytes = kUndoBytes});
      std::vector<Hole> holes;
      std::vector<DrilledHole> earlier;
      std::vector<SurfaceUpdate> changed;
      for (const HoleOrder& order : orders) {
        SessionSetup setup = session_setup(order.path, order.plan);
        setup.holes = earlier;
        const auto hole =
            std::make_shared<PlayedHole>(bone, std::move(setup), operator_choice(order.plan), nullptr, progress);
        ProgressCounter counter(progress, "drilling again", order.cycles);
        while (hole->inputs().size() < order.cycles && hole->step()) counter.add();
        if (hole->inputs().empty()) continue;
        mesh->end_hole();
        holes.push_back({hole, order.plan, mesh->holes_to_undo()});
        mesh->take_bit(hole->setup().path.bit, hole->setup().options.max_jump_mm);
        mesh->update(hole->inputs());
        changed.insert(changed.end(), mesh->updates().begin(), mesh->updates().end());
        earlier.push_back(hole->drilled());
      }
      return [this, bone, mesh, holes, changed] {
        bone_ = bone;
        mesh_ = mesh;
        drilled_ = holes;
        if (!holes.empty()) plan_ = holes.back().plan;
        surface_.give(changed);
        show_hole();
        set_state(drilled_.empty() ? State::idle : State::stopped);
      };
    });
  });
}

void DrillPlayer::set_state(State state) {
  if (state == state_) return;
  state_ = state;
  Q_EMIT state_changed();
}

void DrillPlayer::guard(const std::function<void()>& work) {
  try {
    work();
  } catch (const std::exception& error) {
    Q_EMIT failed(QString::fromUtf8(error.what()));
  }
}

}  // namespace spinaltap
