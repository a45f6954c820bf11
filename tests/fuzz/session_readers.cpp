// Records of drillings, folders of studies, and the cache of bakes.

#include <cmath>
#include <nlohmann/json.hpp>
#include <sstream>

#include "core/base/error.h"
#include "core/base/process_changes.h"
#include "core/base/staged_output.h"
#include "core/files/bake_cache.h"
#include "core/files/json_file.h"
#include "core/files/recorded_setup.h"
#include "core/files/study_folder.h"
#include "core/rbf/fit_surface.h"
#include "core/session/record/session_record.h"
#include "core/study/study_summary.h"
#include "tests/fuzz/readers.h"
#include "tests/support/analytic_bodies.h"
#include "tests/support/temporary_folder.h"

namespace spinaltap::test {
namespace {

namespace fs = std::filesystem;

SessionSetup full_setup() {
  SessionSetup setup;
  setup.bone_hash = "0123456789abcdef";
  setup.path = {"left", Vec3(0.1, 1.0 / 3.0, -2e-17), Vec3(10.0, 20.0, 30.0 / 7.0), DrillBit{3.1, 41.0, 4.0 / 3.0}};
  setup.path.screw = PedicleScrew{"a \"screw\"", 6.1, 44.0, 3.9};
  setup.fine_spacing_mm = 0.033;
  setup.holes = {{DrillBit{2.3, 39.0, 1.0 / 3.0},
                  {{{Vec3(0.1, 0.2, 1.0 / 7.0), Vec3::UnitZ()}, {Vec3(9.1, 1e-17, 3.0), Vec3::UnitZ()}}}}};
  return setup;
}

/// A record with a few cycles, events and, where asked, frames.
std::string record_of(const std::map<std::string, std::string>& setup, bool has_frames) {
  return bytes_written("a.h5", [&](const fs::path& file) {
    const FrameFormat format{7, 5};
    RecordWriter writer(file, setup, false, has_frames ? std::optional(format) : std::nullopt,
                        {.has_sides = has_frames, .has_heat = has_frames});
    std::vector<SessionEvent> events;
    for (std::uint64_t n = 0; n < 40; ++n) {
      Cycle cycle;
      cycle.index = n;
      cycle.time_s = 1e-3 * static_cast<double>(n);
      cycle.state = static_cast<DrillState>(n % 5);
      cycle.force.thrust_n = 0.1 * static_cast<double>(n);
      writer.add_waiting(cycle);
      if (n % 10 == 5) events.push_back({EventKind::outer_breach, n, cycle.time_s, 0.1, {1.0, -2.0, 3.5}, 0.25});
      writer.add_events(events);
    }
    if (has_frames) {
      RecordedFrame frame{5, 0.005, {}};
      frame.view.camera = look_at({50, 0, 7}, Vec3::Zero(), Vec3::UnitZ(), 0.6, format.width, format.height);
      frame.view.depth_mm.assign(35, 12.5F);
      frame.view.mask.assign(35, 1);
      frame.view.normals.assign(105, 0.5F);
      writer.add_frame(std::move(frame));
    }
    writer.close(events);
  });
}

std::vector<Seed> record_seeds() {
  allow_process_changes({.silences_hdf5_at_exit = true});
  std::map<std::string, std::string> setup = record_setup(full_setup());
  const std::string whole = record_of(setup, false);
  // Its texts alone are changed here: the rest of the file is as our writer makes it.
  const auto with_session = [setup](const std::string& text) {
    std::map<std::string, std::string> changed = setup;
    changed["session"] = text;
    return record_of(changed, false);
  };
  return {{"a record", {{"run.h5", whole}}},
          {"a record with frames", {{"run.h5", record_of(setup, true)}}},
          {"a record's setup", {{"run.h5", setup.at("session"), with_session, true}}}};
}

void read_whole_record(const fs::path& folder) {
  const fs::path file = only_file(folder);
  const SessionRecord record = read_record(file);
  static_cast<void>(hash_of(record));
  std::ostringstream csv;
  write_record_csv(record, csv);
  write_events_csv(record, csv);
  static_cast<void>(read_frames(file));
  static_cast<void>(recorded_setup(record.setup, file));
}

StudyRow row_of(std::size_t run) {
  StudyRow row;
  for (std::size_t n = 0; n < kStudyColumns; ++n) {
    row[static_cast<StudyColumn>(n)] = std::pow(10.0, static_cast<double>((run + n) % 9) - 4.0);
  }
  row[StudyColumn::run] = static_cast<double>(run);
  row[StudyColumn::seed] = 4294967295.0;
  for (const StudyColumn column : {StudyColumn::patient, StudyColumn::screw, StudyColumn::contact, StudyColumn::side,
                                   StudyColumn::screw_grade, StudyColumn::screw_breach_side}) {
    row[column] = 1.0;
  }
  row[StudyColumn::level] = 22.0;
  row[StudyColumn::breach] = 0.0;
  row[StudyColumn::grade] = static_cast<double>(run % 5);
  row[StudyColumn::removed_points] = 1e6;
  row[StudyColumn::events_lost] = 0.0;
  return row;
}

std::string hash_of_text(const std::string& text) { return StudyIdentity{text, 0}.hash(); }

/// study.json with the hash of the study that now stands in it.
std::string with_study_hash(const std::string& text) {
  try {
    Json json = parse_json(text, "study.json");
    if (!json.is_object() || !json.contains("study")) return text;
    json["hash"] = hash_of_text(json["study"].dump());
    return json.dump(2);
  } catch (const Error&) {
    return text;
  }
}

/// Each row with the check of what it now is.
std::string with_row_hashes(const std::string& text) {
  std::istringstream lines(text);
  std::string changed;
  for (std::string line; std::getline(lines, line); changed += "\n") {
    changed += line;
    if (const std::size_t comma = line.rfind(','); comma != std::string::npos) {
      changed.resize(changed.size() - (line.size() - comma));
      changed += "," + hash_of_text(line.substr(0, comma));
    }
  }
  return changed;
}

std::vector<Seed> study_folder_seeds() {
  const TemporaryFolder folder;
  const fs::path study = folder.path() / "study";
  StudySpec spec;
  spec.name = "a";
  spec.bones = {{.level = Level::kL5, .paths = {full_setup().path}, .hash = "0123456789abcdef"}};
  spec.volume.radius_mm = 3.0;
  spec.design.runs = 3;
  spec.design.distributions = {{StudyFactor::density_scale, FactorDistribution::Kind::levels, {0.6, 1.0}},
                               {StudyFactor::entry_left_mm, FactorDistribution::Kind::normal, {}, 0.0, 1.0}};
  const StudyIdentity identity = study_identity(spec, StudyRuns(spec.design));
  open_study_folder(study, identity);
  {
    StudyPart first(study, "part-1-of-2.csv", identity);
    StudyPart second(study, "part-2-of-2.csv", identity);
    for (std::size_t run = 0; run < identity.runs; ++run)
      (run % 2 == 0 ? first : second).append(study_csv(row_of(run)));
  }
  std::vector<SeedFile> files = files_in(study);
  for (SeedFile& file : files) {
    file.is_json = file.name == "study.json";
    file.pack = file.is_json ? with_study_hash : with_row_hashes;
  }
  return {{"two parts of a study", files}};
}

/// As `merge` does.
void read_study_folder(const fs::path& folder) {
  const StudyIdentity identity = read_study_identity(folder);
  StudyRows texts;
  read_study_parts(folder, identity, texts);
  const IdentifiedStudy study = study_of(identity, folder / "study.json");
  std::vector<StudyRow> rows;
  for (const auto& [run, text] : texts) rows.push_back(read_study_csv(text));
  if (!rows.empty()) static_cast<void>(summarise_study(rows, StudyRuns(study.design, study.ground())));
}

GridGeometry mask_grid() {
  GridGeometry geometry;
  geometry.size = {7, 6, 5};
  geometry.spacing_mm = Vec3(0.352, 0.352, 0.7);
  geometry.origin_mm = Vec3(-31.25, 17.1, -0.3);
  return geometry;
}

std::vector<Seed> cache_seeds() {
  const TemporaryFolder folder;
  const BakeCache cache(folder.path());
  BoneMask mask{mask_grid(), {}};
  for (std::size_t i = 0; i < mask.geometry.voxel_count(); ++i) mask.inside.push_back(i % 3 == 1 ? 1 : 0);
  cache.keep_mask("a", {mask, "found", Level::kT12, LevelWarnings{{"thin", "metal"}, 0.625}});
  const Ball ball{Vec3(1.0, 2.0, 3.0), 3.0};
  SurfacePoints surface;
  surface.positions_mm = ball.surface_points(2.0);
  for (const Vec3& p : surface.positions_mm) surface.normals.push_back((p - ball.centre_mm).normalized());
  cache.keep_fit("a", fit_surface(surface));
  std::vector<SeedFile> files = files_in(folder.path());
  for (SeedFile& file : files) file.is_json = fs::path(file.name).extension() == ".json";
  return {{"a mask and a fit", files}};
}

}  // namespace

void add_session_readers(std::vector<Reader>& readers) {
  readers.push_back({"record", record_seeds, read_whole_record});
  readers.push_back({"study-folder", study_folder_seeds, read_study_folder});
  readers.push_back({"bake-cache", cache_seeds, [](const fs::path& folder) {
                       const BakeCache cache(folder);
                       static_cast<void>(cache.find_mask("a", mask_grid()));
                       static_cast<void>(cache.find_fit("a"));
                     }});
}

}  // namespace spinaltap::test
