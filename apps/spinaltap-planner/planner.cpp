#include "apps/spinaltap-planner/planner.h"

#include <QDir>
#include <QFile>
#include <QFileInfo>
#include <QStandardPaths>
#include <algorithm>
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

/// Empty where the user has none that can be written: a bake then keeps nothing.
std::filesystem::path bake_cache_folder() {
  const QString folder = QStandardPaths::writableLocation(QStandardPaths::CacheLocation) + "/bakes";
  if (!QDir().mkpath(folder) || !QFileInfo(folder).isWritable()) return {};
  QFile::setPermissions(folder, QFile::ReadOwner | QFile::WriteOwner | QFile::ExeOwner);  // it holds anatomy
  return folder.toStdString();
}

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
    if (!why.isEmpty()) Q_EMIT trouble(job_.what(), why);
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

void Planner::open(const std::filesystem::path& path, const OpenOptions& options) {
  const FileKind kind = kind_of_file(path);
  if (kind == FileKind::plan) {
    open_plan(path);
    return;
  }
  job_.start(tr("Opening %1").arg(name_of_file(path)),
             [this, path, kind, options](const Progress& progress) -> std::function<void()> {
               try {
                 std::shared_ptr<const OpenedBone> bone = kind == FileKind::bone
                                                              ? open_bone(path, progress, options.level)
                                                              : open_ct(path, options, bake_cache_folder(), progress);
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
}

void Planner::bake_here() {
  const std::shared_ptr<const OpenedBone> opened = document_.opened();
  if (!opened || !opened->is_whole_ct) fail("expected an open CT, found none: a baked bone holds but one vertebra");
  job_.start(tr("Baking the vertebra here"), [this, opened, seed_mm = view_.crosshair_mm()](const Progress& progress) {
    std::shared_ptr<const OpenedBone> other = bake_vertebra_at(*opened, seed_mm, bake_cache_folder(), progress);
    return [this, other = std::move(other)] { offer_bone(other); };
  });
}

/// Shows it, where the person agrees to what goes with that.
void Planner::offer_bone(const std::shared_ptr<const OpenedBone>& bone) {
  const auto show = [this, bone] { show_bone(bone); };
  questions_.before_replacing ? questions_.before_replacing(show) : show();
}

void Planner::show_bone(const std::shared_ptr<const OpenedBone>& bone) {
  take_plan_file({});
  suggested_.clear();
  document_.set_bone(bone);
  view_.set_crosshair(bone->options.seed_mm.value_or(bone->bounds_mm().center()));
  const QString file = text_of(bone->file.string());
  const std::string warning = bone->bone ? bone->bone->no_landmarks() : "no vertebra was found in it";
  Q_EMIT said(warning.empty() ? tr("Opened %1").arg(file) : tr("Opened %1; %2").arg(file, text_of(warning)));
  Q_EMIT opened(file);
  if (!bone->bone) Q_EMIT no_bone(text_of(bone->no_bone));
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
