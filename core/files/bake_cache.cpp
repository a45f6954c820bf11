#include "core/files/bake_cache.h"

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
    }
    stage.mask = read_label_map(file("mask", key, ".nrrd"), 1, geometry);
    return stage;
  });
}

void BakeCache::keep_mask(const std::string& key, const MaskStage& stage) const {
  if (folder_.empty()) return;
  StagedOutput output;
  const fs::path map = file("mask", key, ".nrrd");
  output.write(map, encode_label_map(stage.mask, 1, map));
  Json json{{"method", stage.method}, {"level", level_name(stage.level)}, {"warnings", nullptr}};
  if (stage.warnings)
    json["warnings"] = {{"warnings", stage.warnings->warnings}, {"severity", stage.warnings->severity}};
  output.write(file("mask", key, ".json"), json.dump(2) + "\n");
  output.commit();
}

std::optional<SurfaceFit> BakeCache::find_fit(const std::string& key) const {
  if (folder_.empty()) return std::nullopt;
  return if_whole([&] {
    const Json json = read_json(file("fit", key, ".json"));
    SurfaceFitReport report;
    for_each_figure(report, [&](const char* name, auto& figure) { json.at(name).get_to(figure); });
    return SurfaceFit{RbfField(read_rbf(file("fit", key, ".rbf"))), report};
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

void BakeCache::remove() const {
  if (folder_.empty()) return;
  std::error_code ignored;
  std::vector<fs::path> ours;
  for (const auto& entry : fs::directory_iterator(folder_, ignored)) {
    const std::string name = entry.path().filename().string();
    if (name.starts_with("mask-") || name.starts_with("fit-")) ours.push_back(entry.path());
  }
  for (const fs::path& path : ours) fs::remove(path, ignored);
  fs::remove(folder_, ignored);  // an empty one only
}

}  // namespace spinaltap
