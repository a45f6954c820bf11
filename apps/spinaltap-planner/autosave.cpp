#include "apps/spinaltap-planner/autosave.h"

#include <fcntl.h>
#include <unistd.h>

#include <QCryptographicHash>
#include <QDir>
#include <QFile>
#include <QFileInfo>
#include <QUuid>
#include <algorithm>
#include <cerrno>
#include <cstring>
#include <nlohmann/json.hpp>

#include "apps/spinaltap-planner/planner.h"
#include "apps/spinaltap-planner/window/words.h"
#include "core/base/error.h"
#include "core/base/file_lock.h"
#include "core/files/json_file.h"
#include "core/files/milling_file.h"
#include "core/files/plan_file.h"

namespace spinaltap {

/// A file beside the one with the work, locked while its window runs. The system unlocks it when the program ends,
/// whatever ends it.
class WorkLock {
 public:
  explicit WorkLock(const std::filesystem::path& work)
      : file_(work.string() + ".lock"), descriptor_(::open(file_.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0600)) {
    if (descriptor_ < 0) fail_as(ErrorKind::disk, "cannot write ", file_.string(), ": ", std::strerror(errno));
    is_held_ = try_lock(descriptor_, true) == FileLock::held;
  }
  ~WorkLock() { ::close(descriptor_); }
  WorkLock(const WorkLock&) = delete;
  WorkLock& operator=(const WorkLock&) = delete;

  bool is_held() const { return is_held_; }
  void remove_file() const {
    std::error_code ignored;
    std::filesystem::remove(file_, ignored);
  }

 private:
  std::filesystem::path file_;
  int descriptor_;
  bool is_held_ = false;
};

namespace {

constexpr const char* kSession = "session";

/// All that is kept, to be written on another thread.
struct Work {
  std::vector<DrillPath> paths;
  int chosen = -1;
  std::vector<HoleOrder> holes;
  std::shared_ptr<const OpenedBone> bone;
};

Json session_json(const Work& work) {
  const OpenOptions& options = work.bone->options;
  Json opened{{"file", fingerprint_of_name(work.bone->file)}, {"bone", work.bone->bone->hash()}};
  if (options.level != Level::kNone) opened["level"] = level_name(options.level);
  if (!options.reading.series.empty()) opened["series"] = options.reading.series;  // its number: ask_series()
  if (options.reading.resample) opened["resample"] = true;
  if (options.seed_mm) opened["seed_mm"] = to_json(*options.seed_mm);
  Json session{{"opened", opened}, {"chosen", work.chosen}, {"holes", Json::array()}};
  for (const HoleOrder& hole : work.holes) {
    Json kept{{"plan", parse_json(plan_text({hole.path}), "a plan")},
              {"operator", hole.plan.tool_operator},
              {"feed_mm_s", hole.plan.feed_mm_s},
              {"push_n", hole.plan.push_n},
              {"stops_on_breach", hole.plan.stops_on_breach},
              {"speed", hole.plan.speed},
              {"engine", name_of(hole.plan.engine)},
              {"cycles", hole.cycles}};
    if (hole.plan.milling) kept["milling"] = parse_json(milling_text(*hole.plan.milling), "a milling");
    session["holes"].push_back(std::move(kept));
  }
  return session;
}

LostWork read_work(const std::filesystem::path& file) {
  LostWork lost;
  lost.kept_in = file;
  lost.changed = QFileInfo(text_of(file.string())).lastModified();
  const Json json = read_json(file);
  if (const Json& paths = JsonObject(json, file).at("paths"); !paths.empty())
    lost.paths = paths_of_text(json.dump(), file);
  const Json& session = json.at(kSession);
  lost.chosen = static_cast<int>(std::clamp(JsonObject(session, file).number("chosen"), -1.0, 1e6));
  const Json& opened = session.at("opened");
  lost.file = opened.at("file").get<std::string>();
  lost.bone = opened.at("bone").get<std::string>();
  lost.options.level = level_from_name(opened.value("level", "")).value_or(Level::kNone);
  lost.options.reading.series = opened.value("series", "");
  lost.options.reading.resample = opened.value("resample", false);
  if (opened.contains("seed_mm")) lost.options.seed_mm = JsonObject(opened, file).vector("seed_mm");
  for (const Json& hole : session.at("holes")) {
    HoleOrder order;
    order.path = paths_of_text(hole.at("plan").dump(), file).front();
    order.plan = {hole.at("operator").get<std::string>(), hole.at("feed_mm_s").get<double>(),
                  hole.at("push_n").get<double>(), hole.at("stops_on_breach").get<bool>(),
                  hole.at("speed").get<double>()};
    const auto engine = engine_kinds().find(hole.value("engine", "auto"));
    if (engine == engine_kinds().end()) fail("expected an engine that is known in ", file.string());
    order.plan.engine = engine->second;
    if (hole.contains("milling")) {
      order.plan.milling = std::make_shared<const Milling>(milling_of_text(hole.at("milling").dump(), file));
    }
    order.cycles = JsonObject(hole, file).whole_number("cycles");
    lost.holes.push_back(std::move(order));
  }
  return lost;
}

}  // namespace

std::string fingerprint_of_name(const std::filesystem::path& file) {
  const QByteArray name = QFileInfo(text_of(file.string())).absoluteFilePath().toUtf8();
  return QCryptographicHash::hash(name, QCryptographicHash::Sha256).toHex().toStdString();
}

std::filesystem::path work_folder() {
  QString state = QString::fromLocal8Bit(qgetenv("XDG_STATE_HOME"));
  if (state.isEmpty()) state = QDir::homePath() + "/.local/state";
  return (state + "/spinaltap-planner").toStdString();
}

std::vector<LostWork> lost_work() {
  std::vector<LostWork> all;
  std::error_code none;
  for (const auto& entry : std::filesystem::directory_iterator(work_folder(), none)) {
    if (entry.path().extension() != ".json") continue;
    try {
      const auto lock = std::make_shared<WorkLock>(entry.path());
      if (!lock->is_held()) continue;
      LostWork lost = read_work(entry.path());
      lost.lock = lock;
      all.push_back(std::move(lost));
    } catch (const Error&) {  // another version's
    } catch (const Json::exception&) {
    }
  }
  std::sort(all.begin(), all.end(), [](const LostWork& a, const LostWork& b) { return a.changed > b.changed; });
  return all;
}

void remove_lost_work(const LostWork& lost) {
  std::error_code ignored;
  std::filesystem::remove(lost.kept_in, ignored);
  lost.lock->remove_file();
}

Autosave::Autosave(Planner& planner) : planner_(planner), job_(std::make_unique<BackgroundJob>()) {
  constexpr int kChangeMs = 300, kDrillingMs = 3000;
  due_.setSingleShot(true);
  connect(&due_, &QTimer::timeout, this, &Autosave::save);
  const auto soon = [this] { save_soon(kChangeMs); };
  connect(&planner.document(), &PlanDocument::paths_changed, this, soon);
  connect(&planner.document(), &PlanDocument::chosen_changed, this, soon);
  connect(&planner.document().undo_stack(), &QUndoStack::cleanChanged, this, soon);
  connect(&planner, &Planner::said, this, soon);  // what was saved need not be kept
  connect(&planner.player(), &DrillPlayer::state_changed, this, soon);
  connect(&planner.player(), &DrillPlayer::progressed, this, [this] { save_soon(kDrillingMs); });
  connect(job_.get(), &BackgroundJob::finished, this, [this](bool, const QString& why) {
    if (!why.isEmpty() && !is_in_trouble_)
      Q_EMIT planner_.said(tr("Cannot keep a copy for after a crash: %1").arg(why));
    is_in_trouble_ = !why.isEmpty();
  });
}

Autosave::~Autosave() { forget(); }

void Autosave::forget() {
  due_.stop();
  job_.reset();  // ends what it writes
  std::error_code ignored;
  if (!file_.empty()) std::filesystem::remove(file_, ignored);
  if (lock_) lock_->remove_file();
  lock_.reset();
  file_.clear();
}

void Autosave::keep(const std::vector<HoleOrder>& holes) {
  promised_ = holes;
  save();
  if (job_) job_->wait();
}

void Autosave::save_soon(int after_ms) {
  if (job_ && (!due_.isActive() || due_.remainingTime() > after_ms)) due_.start(after_ms);
}

void Autosave::save() {
  if (!job_) return;
  if (job_->is_running()) {
    save_soon(50);
    return;
  }
  const PlanDocument& document = planner_.document();
  const DrillPlayer& player = planner_.player();
  Work work{document.paths(), document.chosen(), player.orders(), document.bone()};
  if (!work.holes.empty() || player.state() != DrillPlayer::State::preparing) promised_.clear();
  if (work.holes.empty()) work.holes = promised_;
  const bool has_lost_plan = planner_.has_unsaved_changes() && !work.paths.empty();
  const bool has_lost_holes = !work.holes.empty() && (player.has_unsaved() || !promised_.empty());
  if (!work.bone || !(has_lost_plan || has_lost_holes)) {
    std::error_code ignored;
    if (!file_.empty()) std::filesystem::remove(file_, ignored);
    return;
  }
  try {
    if (file_.empty()) {
      const QString folder = text_of(work_folder().string());
      if (!QDir().mkpath(folder)) fail_as(ErrorKind::disk, "cannot make the folder ", work_folder().string());
      QFile::setPermissions(folder, QFile::ReadOwner | QFile::WriteOwner | QFile::ExeOwner);
      const auto file = work_folder() / (QUuid::createUuid().toString(QUuid::Id128).toStdString() + ".json");
      lock_ = std::make_shared<WorkLock>(file);
      file_ = file;
    }
    job_->start(tr("Autosave"), [work = std::move(work), file = file_](const Progress&) -> std::function<void()> {
      Json json = parse_json(plan_text(work.paths), "the plan");
      json[kSession] = session_json(work);
      write_json(json, file);
      return {};
    });
  } catch (const Error& error) {
    if (!is_in_trouble_) Q_EMIT planner_.said(tr("Cannot keep a copy for after a crash: %1").arg(error.what()));
    is_in_trouble_ = true;
  }
}

}  // namespace spinaltap
