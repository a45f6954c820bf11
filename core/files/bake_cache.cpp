#include "core/files/bake_cache.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <map>
#include <nlohmann/json.hpp>
#include <vector>

#include "core/base/error.h"
#include "core/base/staged_output.h"
#include "core/ct/label_map.h"
#include "core/files/json_file.h"
#include "core/rbf/rbf_file.h"

namespace spinaltap {
namespace {

namespace fs = std::filesystem;

/// The figures of a fit and their names in its JSON file.
template <class Report, class Visit>
void for_each_figure(Report& report, const Visit& visit) {
  visit("points", report.points);
  visit("off_surface_points", report.off_surface_points);
  visit("centres", report.centres);
  visit("iterations", report.iterations);
  visit("mean_residual_mm", report.mean_residual_mm);
  visit("p99_residual_mm", report.p99_residual_mm);
  visit("max_residual_mm", report.max_residual_mm);
}

/// What `read` gives, or nothing where the file is missing or invalid.
template <class Read>
auto if_whole(const Read& read) -> std::optional<decltype(read())> {
  try {
    return read();
  } catch (const Error&) {
    return std::nullopt;
  } catch (const Json::exception&) {
    return std::nullopt;
  }
}

bool is_stage(const fs::path& path) {
  const std::string name = path.filename().string();
  return name.starts_with("mask-") || name.starts_with("fit-");
}

/// A stage's files have one age: when it was last found, or kept. A cache that cannot be written to has no ages.
void note_found(const fs::path& file) {
  std::error_code ignored;
  fs::last_write_time(file, fs::file_time_type::clock::now(), ignored);
}

}  // namespace

fs::path BakeCache::file(const char* stage, const std::string& key, const char* ending) const {
  return folder_ / (std::string(stage) + "-" + key + ending);
}

// The JSON file is named last, so where it is the other one is whole.

std::optional<MaskStage> BakeCache::find_mask(const std::string& key, const GridGeometry& geometry) const {
  if (folder_.empty()) return std::nullopt;
  return if_whole([&] {
    const Json json = read_json(file("mask", key, ".json"));
    MaskStage stage;
    stage.method = json.at("method").get<std::string>();
    stage.level = level_from_name(json.at("level").get<std::string>()).value_or(Level::kNone);
    if (const Json& warnings = json.at("warnings"); !warnings.is_null()) {
      stage.warnings =
          LevelWarnings{warnings.at("warnings").get<std::vector<std::string>>(), warnings.at("severity").get<double>()};
      const auto unsure_mm = warnings.at("unsure_mm").get<std::vector<std::array<double, 3>>>();
      for (const auto& [x, y, z] : unsure_mm) stage.warnings->unsure_mm.emplace_back(x, y, z);
    }
    stage.mask = read_label_map(file("mask", key, ".nrrd"), 1, geometry);
    note_found(file("mask", key, ".json"));
    return stage;
  });
}

void BakeCache::keep_mask(const std::string& key, const MaskStage& stage) const {
  if (folder_.empty()) return;
  StagedOutput output;
  const fs::path map = file("mask", key, ".nrrd");
  output.write(map, encode_label_map(stage.mask, 1, map));
  Json json{{"method", stage.method}, {"level", level_name(stage.level)}, {"warnings", nullptr}};
  if (stage.warnings) {
    json["warnings"] = {{"warnings", stage.warnings->warnings}, {"severity", stage.warnings->severity}};
    Json& unsure_mm = json["warnings"]["unsure_mm"] = Json::array();
    for (const Vec3& p_mm : stage.warnings->unsure_mm) unsure_mm.push_back(to_json(p_mm));
  }
  output.write(file("mask", key, ".json"), json.dump(2) + "\n");
  output.commit();
}

std::optional<SurfaceFit> BakeCache::find_fit(const std::string& key) const {
  if (folder_.empty()) return std::nullopt;
  return if_whole([&] {
    const Json json = read_json(file("fit", key, ".json"));
    SurfaceFitReport report;
    for_each_figure(report, [&](const char* name, auto& figure) { json.at(name).get_to(figure); });
    SurfaceFit fit{RbfField(read_rbf(file("fit", key, ".rbf"))), report};
    note_found(file("fit", key, ".json"));
    return fit;
  });
}

void BakeCache::keep_fit(const std::string& key, const SurfaceFit& fit) const {
  if (folder_.empty()) return;
  StagedOutput output;
  write_rbf(fit.field.model(), output.stage(file("fit", key, ".rbf")));
  Json json;
  for_each_figure(fit.report, [&](const char* name, const auto& figure) { json[name] = figure; });
  output.write(file("fit", key, ".json"), json.dump(2) + "\n");
  output.commit();
}

void BakeCache::prune(std::uint64_t max_bytes, int max_days) const {
  if (folder_.empty()) return;
  struct Stage {
    fs::file_time_type found{fs::file_time_type::min()};
    std::uint64_t bytes = 0;
    std::vector<fs::path> files;
  };
  std::map<std::string, Stage> stages;  // by name without ending
  std::error_code ignored;
  for (const auto& entry : fs::directory_iterator(folder_, ignored)) {
    if (!is_stage(entry.path()) || !entry.is_regular_file(ignored)) continue;
    Stage& stage = stages[entry.path().stem().string()];
    const fs::file_time_type time = entry.last_write_time(ignored);
    if (!ignored) stage.found = std::max(stage.found, time);
    if (const std::uint64_t bytes = entry.file_size(ignored); !ignored) stage.bytes += bytes;
    stage.files.push_back(entry.path());
  }
  std::vector<const Stage*> newest_first;
  newest_first.reserve(stages.size());
  for (const auto& [name, stage] : stages) newest_first.push_back(&stage);
  std::stable_sort(newest_first.begin(), newest_first.end(),
                   [](const Stage* a, const Stage* b) { return a->found > b->found; });
  const fs::file_time_type oldest = fs::file_time_type::clock::now() - std::chrono::hours(24) * max_days;
  std::uint64_t kept = 0;
  for (const Stage* stage : newest_first) {
    kept += stage->bytes;
    if (kept <= max_bytes && stage->found >= oldest) continue;
    for (const fs::path& path : stage->files) fs::remove(path, ignored);
  }
}

void BakeCache::remove() const {
  if (folder_.empty()) return;
  std::error_code ignored;
  std::vector<fs::path> ours;
  for (const auto& entry : fs::directory_iterator(folder_, ignored)) {
    if (is_stage(entry.path())) ours.push_back(entry.path());
  }
  for (const fs::path& path : ours) fs::remove(path, ignored);
  // A run that was killed just after it kept its fit leaves an empty one, and no later run writes here.
  StagedOutput::remove_leftovers(folder_);
  fs::remove(folder_, ignored);  // an empty one only
}

}  // namespace spinaltap
