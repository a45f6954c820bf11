#include "apps/spinaltap-planner/ct_levels.h"

#include <QDir>
#include <QFile>
#include <QFileInfo>
#include <QMetaObject>
#include <QStandardPaths>
#include <algorithm>
#include <cmath>
#include <utility>

#include "apps/spinaltap-planner/window/words.h"

namespace spinaltap {
namespace {

/// Weights are seconds of a clinical CT.
const std::vector<JobStage>& search_stages() {
  static const std::vector<JobStage> stages{
      {"finding the spinal canal", 4.0}, {"finding the vertebral bodies", 3.0}, {"parting the vertebrae", 13.0}};
  return stages;
}
const std::vector<JobStage>& bake_stages() {
  static const std::vector<JobStage> stages{{"surface points", 13.0},
                                            {"solving", 10.0},
                                            {"baking the distance", 6.0},
                                            {"measuring distances", 17.0},
                                            {"meshing", 1.0},
                                            {"reading the bone's shape", 1.5},
                                            {"measuring the bone's depth", 2.5},
                                            {"finding the vertebra's landmarks", 5.0}};
  return stages;
}

/// Of finished stages of bakes; empty where the user has none that can be written: a bake then keeps nothing.
std::filesystem::path bake_cache_folder() {
  const QString folder = QStandardPaths::writableLocation(QStandardPaths::CacheLocation) + "/bakes";
  if (!QDir().mkpath(folder) || !QFileInfo(folder).isWritable()) return {};
  QFile::setPermissions(folder, QFile::ReadOwner | QFile::WriteOwner | QFile::ExeOwner);  // it holds anatomy
  return folder.toStdString();
}

}  // namespace

QString CtLevel::name() const {
  if (!is_pointed_at()) return text_of(report.name);
  if (bone && bone->bone->level() != Level::kNone) return text_of(level_name(bone->bone->level()));
  return CtLevels::tr("at the crosshair");
}

Box3 CtLevel::box_mm() const {
  const Vec3 size_mm = is_pointed_at() ? Vec3(45.0, 35.0, 28.0) : report.body_size_mm;
  return {report.body_centre_mm - size_mm.cwiseProduct(Vec3(1.1, 0.9, 1.2)),
          report.body_centre_mm + size_mm.cwiseProduct(Vec3(1.1, 2.1, 1.2))};
}

CtLevels::CtLevels(QObject* parent) : QObject(parent) {
  connect(&job_, &BackgroundJob::finished, this, &CtLevels::take_end);
}

void CtLevels::set_ct(std::shared_ptr<const OpenedBone> ct) {
  ct_ = std::move(ct);
  found_.reset();
  levels_.clear();
  search_ = ct_ ? Search::running : Search::none;
  job_.cancel();
  Q_EMIT changed();
  go_on();
}

void CtLevels::find() {
  if (!ct_ || search_ == Search::running || found_) return;
  search_ = Search::running;
  Q_EMIT changed();
  go_on();
}

int CtLevels::at(const Vec3& p_mm) const {
  if (!found_) return -1;
  const LabelVolume& labels = found_->labels;
  const Eigen::Array3d p = labels.geometry.to_index(p_mm).array().round();
  if (!p.allFinite() || (p.abs() > 1e6).any()) return -1;
  const auto v = p.cast<int>().eval();
  if (!labels.geometry.contains(v.x(), v.y(), v.z())) return -1;
  const int label = labels.labels[labels.geometry.offset(v.x(), v.y(), v.z())];
  const auto level = std::find_if(levels_.begin(), levels_.end(),
                                  [&](const CtLevel& one) { return label != 0 && one.report.label == label; });
  return level == levels_.end() ? -1 : static_cast<int>(level - levels_.begin());
}

int CtLevels::named(Level level) const {
  const auto found =
      std::find_if(levels_.begin(), levels_.end(), [&](const CtLevel& one) { return one.report.level == level; });
  return found == levels_.end() || level == Level::kNone ? -1 : static_cast<int>(found - levels_.begin());
}

int CtLevels::of(const OpenedBone* bone) const {
  const auto found =
      std::find_if(levels_.begin(), levels_.end(), [&](const CtLevel& one) { return one.bone.get() == bone; });
  return found == levels_.end() || bone == nullptr ? -1 : static_cast<int>(found - levels_.begin());
}

int CtLevels::largest() const {
  const auto size = [](const CtLevel& level) {
    return std::pair(!level.report.is_cut, level.report.body_size_mm.prod());
  };
  const auto found = std::max_element(levels_.begin(), levels_.end(),
                                      [&](const CtLevel& a, const CtLevel& b) { return size(a) < size(b); });
  return found == levels_.end() ? -1 : static_cast<int>(found - levels_.begin());
}

int CtLevels::only_whole() const {
  const auto is_whole = [](const CtLevel& level) { return !level.report.is_cut; };
  return std::count_if(levels_.begin(), levels_.end(), is_whole) == 1 ? largest() : -1;
}

void CtLevels::bake(int index) {
  CtLevel& level = levels_.at(static_cast<std::size_t>(index));
  if (level.state != CtLevel::State::found && level.state != CtLevel::State::failed) return;
  level.state = CtLevel::State::waiting;
  level.why.clear();
  Q_EMIT changed();
  go_on();
}

int CtLevels::pointed_at(const Vec3& p_mm) {
  int index = at(p_mm);
  if (index < 0) {
    const auto idle = std::find_if(levels_.begin(), levels_.end(), [](const CtLevel& one) {
      return one.is_pointed_at() && (one.state == CtLevel::State::failed || one.state == CtLevel::State::found);
    });
    index = static_cast<int>(idle - levels_.begin());
    if (idle == levels_.end()) levels_.emplace_back();
    levels_[static_cast<std::size_t>(index)].report.body_centre_mm = p_mm;
  }
  return index;
}

void CtLevels::cancel() {
  for (CtLevel& level : levels_) {
    if (level.state == CtLevel::State::waiting) level.state = CtLevel::State::found;
  }
  job_.cancel();
  const bool has_begun = worked_on_ == ct_;
  if (search_ == Search::running && !has_begun) search_ = Search::cancelled;
  Q_EMIT changed();
  if (search_ == Search::cancelled && !has_begun) Q_EMIT search_ended();
}

bool CtLevels::is_baking() const {
  return std::any_of(levels_.begin(), levels_.end(), [](const CtLevel& level) {
    return level.state == CtLevel::State::waiting || level.state == CtLevel::State::baking;
  });
}

bool CtLevels::is_working() const { return search_ == Search::running || is_baking(); }

/// The search comes first: it says which levels there are.
void CtLevels::go_on() {
  if (!ct_ || job_.is_running()) return;
  if (search_ == Search::running) return start_search();
  if (const int index = next(); index >= 0) start_bake(static_cast<std::size_t>(index));
}

int CtLevels::next() const {
  const auto waiting = std::find_if(levels_.begin(), levels_.end(),
                                    [](const CtLevel& level) { return level.state == CtLevel::State::waiting; });
  return waiting == levels_.end() ? -1 : static_cast<int>(waiting - levels_.begin());
}

void CtLevels::start_search() {
  worked_on_ = ct_;
  job_.start(
      tr("Looking for the vertebrae"),
      [this, ct = ct_](const Progress& progress) {
        auto found = std::make_shared<const SpineSegmentation>(find_levels(*ct, progress));
        return [this, ct, found = std::move(found)] {
          if (ct_ == ct) take_found(found);
        };
      },
      search_stages());
}

void CtLevels::take_found(std::shared_ptr<const SpineSegmentation> found) {
  const std::vector<CtLevel> pointed = std::exchange(levels_, {});
  found_ = std::move(found);
  for (const LevelReport& report : found_->levels) levels_.push_back({report, CtLevel::State::found, {}, nullptr});
  for (const CtLevel& one : pointed) {
    const int index = at(one.report.body_centre_mm);
    if (index < 0) {
      levels_.push_back(one);
    } else if (one.state == CtLevel::State::waiting) {
      levels_[static_cast<std::size_t>(index)].state = CtLevel::State::waiting;
    }
  }
  search_ = Search::found;
}

void CtLevels::start_bake(std::size_t index) {
  worked_on_ = ct_;
  baking_ = index;
  CtLevel& level = levels_[index];
  level.state = CtLevel::State::baking;
  Q_EMIT changed();
  job_.start(
      tr("Baking %1").arg(level.name()),
      [this, ct = ct_, found = found_, report = level.report, index](const Progress& progress) {
        std::shared_ptr<const OpenedBone> bone =
            report.label != 0 ? bake_level(*ct, *found, report, bake_cache_folder(), progress)
                              : bake_vertebra_at(*ct, report.body_centre_mm, bake_cache_folder(), progress);
        return [this, ct, index, bone = std::move(bone)] {
          if (ct_ == ct) levels_[index].bone = bone;
        };
      },
      bake_stages());
}

void CtLevels::take_end(bool is_done, const QString& why) {
  const bool is_of_this = std::exchange(worked_on_, nullptr) == ct_ && ct_;
  const std::optional<std::size_t> baking = std::exchange(baking_, std::nullopt);
  // Not from within the end of the work: who shows it has not heard of it yet.
  QMetaObject::invokeMethod(this, &CtLevels::go_on, Qt::QueuedConnection);
  if (!is_of_this) return;
  if (!baking) {
    if (!is_done) search_ = why.isEmpty() ? Search::cancelled : Search::failed;
    why_none_ = why;
    Q_EMIT changed();
    Q_EMIT search_ended();
    return;
  }
  CtLevel& level = levels_[*baking];
  level.state = is_done ? CtLevel::State::baked : why.isEmpty() ? CtLevel::State::found : CtLevel::State::failed;
  level.why = why;
  const bool has_failed = level.state == CtLevel::State::failed;
  Q_EMIT changed();
  if (is_done) Q_EMIT baked(static_cast<int>(*baking));
  if (has_failed) Q_EMIT failed(static_cast<int>(*baking));
}

}  // namespace spinaltap
