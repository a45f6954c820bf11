#include "apps/spinaltap-planner/planner.h"

#include <QMetaObject>
#include <algorithm>
#include <map>
#include <utility>

#include "apps/report/grade_report.h"
#include "apps/spinaltap-planner/drill/played_hole.h"
#include "apps/spinaltap-planner/window/words.h"
#include "core/base/error.h"
#include "core/base/staged_output.h"
#include "core/files/plan_file.h"
#include "core/tool/path_curve.h"
#include "vdb/sim/auto_plan.h"
#include "vdb/sim/bone_identity.h"
#include "vdb/sim/bone_path.h"

namespace spinaltap {
namespace {

bool meets(const DrillPath& path, const BoneModel& bone) {
  try {
    check_path_meets_bone(path, bone);
  } catch (const Error&) {
    return false;
  }
  return true;
}

/// What speaks against a plan for a bone, a line each: another bone that it names, paths that do not fit.
QString against_plan(const Bone& bone, const std::vector<DrillPath>& paths) {
  QStringList lines;
  for (const DrillPath& path : paths) {
    try {
      check_path_is_of(path, bone.identity());
    } catch (const Error& error) {
      lines += text_of(error.what());
    }
    const PathCheck check = check_path_on_bone(bone, path);
    if (!check.fits()) lines += text_of(check.words(path));
  }
  return lines.join("\n");
}

QString name_of_file(const std::filesystem::path& path) { return text_of(path.filename().string()); }

}  // namespace

Planner::Planner(QObject* parent) : QObject(parent), player_(document_) {
  connect(&job_, &BackgroundJob::finished, this, [this](bool, const QString& why) {
    is_opening_ = false;
    if (next_) {
      // Not from within the end of the work: who shows it has not heard of it yet.
      QMetaObject::invokeMethod(
          this, [this] { open_next(); }, Qt::QueuedConnection);
    }
    if (!why.isEmpty()) Q_EMIT trouble(job_.what(), why);
  });
  connect(&levels_, &CtLevels::search_ended, this, &Planner::take_levels);
  connect(&levels_, &CtLevels::baked, this, &Planner::take_baked);
  connect(&levels_, &CtLevels::failed, this, [this](int index) {
    const CtLevel& level = levels_.levels()[static_cast<std::size_t>(index)];
    const QString what = tr("Baking %1").arg(level.name()), why = level.why;
    if (index == wanted_) {
      wanted_ = -1;
      plan_waiting_.clear();
    }
    Q_EMIT trouble(what, why);
  });
  connect(&document_, &PlanDocument::chosen_changed, this, &Planner::show_chosen_path);
}

/// Slices go to the path that is chosen, unless they show it already.
void Planner::show_chosen_path() {
  constexpr double kShownMm = 1.0;
  const DrillPath* path = document_.chosen_path();
  if (path == nullptr) return;
  const PathCurve curve(*path);
  const double depth_mm = std::clamp(curve.nearest_mm(view_.crosshair_mm()), 0.0, curve.length_mm());
  const Vec3 nearest_mm = curve.at_mm(depth_mm);
  if ((view_.crosshair_mm() - nearest_mm).norm() > kShownMm) view_.set_crosshair(path->entry_mm);
}

std::optional<PathFigures> Planner::figures() const {
  const DrillPath* path = document_.chosen_path();
  if (!document_.bone() || path == nullptr) return std::nullopt;
  PathFigures figures = grader_.figures(*document_.bone(), *path);
  add_reasons(suggested_, figures);
  return figures;
}

bool Planner::is_working() const { return job_.is_running() || next_ || levels_.is_working(); }

void Planner::cancel() {
  next_.reset();
  job_.cancel();
}

void Planner::open(const std::filesystem::path& path, const OpenOptions& options) {
  if (kind_of_file(path) == FileKind::plan) {
    open_plan(path);
  } else if (job_.is_running()) {
    next_ = {path, options};
    if (is_opening_) job_.cancel();
  } else {
    open_at_once(path, options);
  }
}

void Planner::open_next() {
  if (!next_) return;
  if (job_.is_running()) return;  // another work was quicker: its end comes
  const ToOpen next = *std::exchange(next_, std::nullopt);
  open_at_once(next.path, next.options);
}

void Planner::open_at_once(const std::filesystem::path& path, const OpenOptions& options) {
  const bool is_bone = kind_of_file(path) == FileKind::bone;
  job_.start(tr("Opening %1").arg(name_of_file(path)),
             [this, path, is_bone, options](const Progress& progress) -> std::function<void()> {
               try {
                 std::shared_ptr<const OpenedBone> bone =
                     is_bone ? open_bone(path, progress, options.level) : open_ct(path, options, progress);
                 return [this, bone = std::move(bone)] { offer_bone(bone); };
               } catch (const SeveralSeries& several) {
                 return [this, path, options, several] {
                   if (!questions_.which_series) throw SeveralSeries(several);
                   questions_.which_series(path, options, several);
                 };
               } catch (const UnevenSlices& uneven) {
                 return [this, path, options, uneven] {
                   if (!questions_.whether_to_resample) throw UnevenSlices(uneven);
                   questions_.whether_to_resample(path, options, uneven);
                 };
               }
             });
  is_opening_ = true;
}

void Planner::show_level(int index) {
  const CtLevel& level = levels_.levels().at(static_cast<std::size_t>(index));
  wanted_ = -1;
  if (level.bone) return show_bone(level.bone);
  wanted_ = index;
  if (view_.crosshair_mm() == placed_mm_) put_crosshair(level.report.body_centre_mm);
  levels_.bake(index);
}

void Planner::bake_all() {
  if (!levels_.is_baking()) wanted_ = -1;
  for (std::size_t n = 0; n < levels_.levels().size(); ++n) {
    if (!levels_.levels()[n].report.is_cut) levels_.bake(static_cast<int>(n));
  }
}

int Planner::level_here() {
  const std::shared_ptr<const OpenedBone> opened = document_.opened();
  if (!opened || !opened->is_whole_ct) fail("expected an open CT, found none: a baked bone holds but one vertebra");
  return levels_.pointed_at(view_.crosshair_mm());
}

/// The search for levels has ended.
void Planner::take_levels() {
  document_.set_levels(levels_.found());
  if (levels_.search() == CtLevels::Search::cancelled) return give_plan_up(tr("the search for its vertebra was ended"));
  if (levels_.search() == CtLevels::Search::failed || levels_.levels().empty()) {
    plan_waiting_.clear();
    Q_EMIT no_bone(levels_.found() ? tr("of the spine the sacrum is all that is in it") : levels_.why_none());
    return;
  }
  if (!plan_waiting_.empty()) return bake_for_plan();
  if (levels_.is_baking()) wanted_ = levels_.next();  // it was pointed at before
  if (document_.bone() || levels_.is_baking()) return;
  const OpenOptions& options = document_.opened()->options;
  if (options.level != Level::kNone) {
    const int named = levels_.named(options.level);
    if (named >= 0) return show_level(named);
    QStringList names;
    for (const CtLevel& level : levels_.levels()) names += level.name();
    Q_EMIT trouble(tr("Opening %1").arg(name_of_file(document_.opened()->file)),
                   tr("expected %1 in this CT, found %2").arg(text_of(level_name(options.level)), names.join(", ")));
  } else if (const int only = levels_.only_whole(); only >= 0 && options.bakes_only_whole) {
    show_level(only);
  }
}

void Planner::take_baked(int index) {
  const CtLevel& level = levels_.levels()[static_cast<std::size_t>(index)];
  const bool is_wanted = index == wanted_ || (!document_.bone() && wanted_ < 0);
  if (is_wanted && !has_unsaved_changes() && !player_.has_unsaved()) {
    show_level(index);
  } else {
    if (is_wanted) wanted_ = -1;
    Q_EMIT said(tr("%1 is baked").arg(level.name()));
  }
}

/// The level that most of the plan's first path lies in.
void Planner::bake_for_plan() {
  try {
    const std::vector<DrillPath> paths = read_plan(plan_waiting_);
    std::map<int, int> votes;
    constexpr int kPlaces = 40;
    const PathCurve curve(paths.front());
    for (int n = 0; n <= kPlaces; ++n) {
      if (const int level = levels_.at(curve.at_mm(curve.length_mm() * n / kPlaces)); level >= 0) ++votes[level];
    }
    if (votes.empty()) {
      fail("the first path of ", plan_waiting_.string(),
           " lies in no vertebra that was found in this CT: the plan is for another one, or in another frame");
    }
    show_level(std::max_element(votes.begin(), votes.end(), [](const auto& a, const auto& b) {
                 return a.second < b.second;
               })->first);
  } catch (const Error& error) {
    give_plan_up(text_of(error.what()));
  }
}

void Planner::give_plan_up(const QString& why) {
  if (plan_waiting_.empty()) return;
  const std::filesystem::path file = std::exchange(plan_waiting_, {});
  Q_EMIT trouble(tr("Opening %1").arg(name_of_file(file)), why);
}

/// Shows it, where the person agrees to what goes with that.
void Planner::offer_bone(const std::shared_ptr<const OpenedBone>& bone) {
  const auto show = [this, bone] { show_bone(bone); };
  questions_.before_replacing ? questions_.before_replacing(show) : show();
}

void Planner::show_bone(const std::shared_ptr<const OpenedBone>& bone) {
  const bool is_of_open_ct = document_.opened() && document_.opened()->volume == bone->volume;
  const bool is_crosshair_moved = is_of_open_ct && view_.crosshair_mm() != placed_mm_;
  take_plan_file({});
  suggested_.clear();
  document_.set_bone(bone);
  if (!is_crosshair_moved) put_crosshair(bone->options.seed_mm.value_or(bone->bounds_mm().center()));
  const QString file = text_of(bone->file.string());
  const std::string warning = bone->bone ? bone->bone->no_landmarks() : "";
  Q_EMIT said(warning.empty() ? tr("Opened %1").arg(file) : tr("Opened %1; %2").arg(file, text_of(warning)));
  Q_EMIT opened(file);
  if (!is_of_open_ct) {
    wanted_ = -1;
    plan_waiting_.clear();
    levels_.set_ct(bone->bone ? nullptr : bone);
    if (!bone->bone && bone->options.seed_mm) show_level(levels_.pointed_at(*bone->options.seed_mm));
  } else if (!plan_waiting_.empty()) {
    const std::filesystem::path plan = std::exchange(plan_waiting_, {});
    try {
      open_plan(plan);
    } catch (const Error& error) {
      Q_EMIT trouble(tr("Opening %1").arg(name_of_file(plan)), text_of(error.what()));
    }
  }
}

void Planner::put_crosshair(const Vec3& p_mm) {
  placed_mm_ = p_mm;
  view_.set_crosshair(p_mm);
}

void Planner::take_plan_file(const std::filesystem::path& file) {
  plan_file_ = file;
  std::error_code none;
  const std::filesystem::file_time_type time = std::filesystem::last_write_time(file, none);
  plan_file_time_ = none ? std::nullopt : std::optional(time);
}

bool Planner::is_plan_file_foreign() const {
  std::error_code none;
  const std::filesystem::file_time_type time = std::filesystem::last_write_time(plan_file_, none);
  return !none && plan_file_time_ != time;
}

void Planner::open_plan(const std::filesystem::path& file) {
  std::vector<DrillPath> paths = read_plan(file);
  const bool is_found = levels_.search() == CtLevels::Search::found;
  if (!document_.bone() && (is_found || levels_.search() == CtLevels::Search::running)) {
    plan_waiting_ = file;
    Q_EMIT said(tr("%1 opens when its vertebra is baked").arg(name_of_file(file)));
    if (is_found) bake_for_plan();
    return;
  }
  if (!document_.bone()) {
    fail("expected a bone for the plan ", file.string(), ", found none: open the CT or the bone it is for first");
  }
  const bool meets_any = std::any_of(paths.begin(), paths.end(),
                                     [&](const DrillPath& path) { return meets(path, document_.bone()->model()); });
  if (!meets_any) {
    const PathCheck check = check_path_on_bone(*document_.bone()->bone, paths.front());
    fail("none of the ", paths.size(), " paths of ", file.string(),
         " meets this bone: the plan is for another one, or in another frame; ", check.words(paths.front()));
  }
  const QString against = against_plan(*document_.bone()->bone, paths);
  if (against.isEmpty()) {
    take_plan(std::move(paths), file);
  } else if (questions_.whether_to_take_plan) {
    questions_.whether_to_take_plan(file, against, [this, paths, file, bone = document_.bone()] {
      if (document_.bone() == bone) take_plan(paths, file);
    });
  } else {
    fail(file.string(), ": ", against.simplified().toStdString());
  }
}

void Planner::take_plan(std::vector<DrillPath> paths, const std::filesystem::path& file) {
  const auto met = std::count_if(paths.begin(), paths.end(),
                                 [&](const DrillPath& path) { return meets(path, document_.bone()->model()); });
  const bool names_ct =
      std::all_of(paths.begin(), paths.end(), [](const DrillPath& path) { return path.bone.names_ct(); });
  document_.set_paths(std::move(paths));
  const bool is_ours = !file.string().ends_with(".mrk.json");
  take_plan_file(is_ours ? file : std::filesystem::path());
  view_.set_crosshair(document_.chosen_path()->entry_mm);
  const auto beside = static_cast<std::ptrdiff_t>(document_.paths().size()) - met;
  QString what = tr("Opened %1").arg(name_of_file(file));
  if (beside > 0) what += tr("; %1 of its paths do not meet this bone").arg(beside);
  if (!names_ct) what += tr("; this plan does not name its CT");
  Q_EMIT said(what);
  Q_EMIT opened(text_of(file.string()));
}

void Planner::save_plan(const std::filesystem::path& path) {
  if (document_.paths().empty()) fail("expected a path to save, found none: add one, or let paths be suggested");
  std::vector<DrillPath> paths = document_.paths();
  for (DrillPath& one : paths) {
    if (one.bone.is_empty() && document_.bone()) one.bone = document_.bone()->bone->identity();
  }
  write_plan(paths, path);
  if (!path.string().ends_with(".mrk.json")) {
    take_plan_file(path);
    document_.undo_stack().setClean();
  }
  Q_EMIT said(tr("Saved %1").arg(text_of(path.string())));
}

void Planner::save_bone(const std::filesystem::path& path) {
  if (!document_.bone()) fail("expected a bone to save, found none");
  job_.start(tr("Saving the bone"), [this, path, bone = document_.bone()](const Progress&) {
    StagedOutput output;
    write_bone(bone->model(), output.stage(path));
    output.commit();
    return [this, path] { Q_EMIT said(tr("Saved %1").arg(text_of(path.string()))); };
  });
}

void Planner::save_report(const std::filesystem::path& path) {
  if (!document_.bone() || document_.paths().empty()) fail("expected a bone with a path for a report, found none");
  const OpenedBone& bone = *document_.bone();
  GradeReportData data;
  data.title = "Planned paths";
  for (const DrillPath& one : document_.paths()) {
    PathFigures figures = grader_.figures(bone, one);
    if (!figures.is_graded) fail(figures.warnings.front().text);
    add_reasons(suggested_, figures);
    data.paths.push_back(figures.graded);
    data.reasons.push_back(figures.reasons);
  }
  data.hu_bands = grader_.hu_bands();
  data.landmarks = bone.landmarks();
  data.ct = &bone.ct;
  data.bone_bounds_mm = bone.model().bounds_mm();
  data.bone = &*bone.bone;
  // `data` looks into the bone, which the work keeps.
  job_.start(tr("Writing the report"),
             [this, path, data = std::move(data), kept = document_.bone()](const Progress& progress) {
               StagedOutput output;
               output.write(path, grade_report(data, progress));
               output.commit();
               return [this, path] { Q_EMIT said(tr("Saved %1").arg(text_of(path.string()))); };
             });
}

void Planner::save_record(const std::filesystem::path& path) {
  write_drilling(tr("Saving the record"), path, [path](const DoneDrilling& drilling, const Progress& progress) {
    write_record(drilling, path, progress);
  });
}

void Planner::write_drill_report(const std::filesystem::path& folder) {
  write_drilling(tr("Writing the report"), folder, [folder](const DoneDrilling& drilling, const Progress& progress) {
    write_report(drilling, folder, progress);
  });
}

void Planner::write_drilling(const QString& what, const std::filesystem::path& path,
                             const std::function<void(const DoneDrilling&, const Progress&)>& write) {
  std::optional<DoneDrilling> drilling = player_.done();
  if (!drilling) fail("expected a drilling that stands still: drill a path, or stop the drilling first");
  job_.start(what, [this, path, write, drilling = *std::move(drilling),
                    written = player_.progresses()](const Progress& progress) {
    write(drilling, progress);
    return [this, path, written] {
      player_.mark_saved(written);
      Q_EMIT said(tr("Saved %1").arg(text_of(path.string())));
    };
  });
}

void Planner::suggest() {
  if (!document_.bone()) fail("expected a bone to suggest paths for, found none");
  if (document_.bone()->landmarks() == nullptr) {
    fail("cannot suggest paths: ", document_.bone()->bone->no_landmarks());
  }
  job_.start(tr("Suggesting paths"), [this, bone = document_.bone()](const Progress& progress) {
    const std::vector<Suggestion> suggestions = bone->bone->suggest({}, progress);
    return [this, bone, suggestions] {
      if (document_.bone() != bone) return;  // another one was opened meanwhile
      QStringList rejections;
      std::vector<DrillPath> paths;
      suggested_.clear();
      for (const Suggestion& suggestion : suggestions) {
        if (suggestion.best) {
          paths.push_back(suggestion.best->path);
          suggested_.push_back(*suggestion.best);
        } else {
          rejections += text_of(suggestion.rejection);
        }
      }
      document_.add_paths(std::move(paths), tr("suggest paths"));
      if (const DrillPath* path = document_.chosen_path()) view_.set_crosshair(path->entry_mm);
      if (rejections.isEmpty()) {
        Q_EMIT said(tr("Suggested %1 paths").arg(suggestions.size()));
      } else {
        Q_EMIT trouble(tr("Suggesting paths"), rejections.join("\n"));
      }
    };
  });
}

}  // namespace spinaltap
