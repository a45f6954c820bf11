// What people write by hand and programs keep: files of JSON, and scripts of the planner.

#include <fstream>
#include <nlohmann/json.hpp>

#include "apps/spinaltap-planner/script/planner_script.h"
#include "core/base/staged_output.h"
#include "core/files/bit_file.h"
#include "core/files/data_files.h"
#include "core/files/ground_truth_file.h"
#include "core/files/json_file.h"
#include "core/files/material_file.h"
#include "core/files/milling_file.h"
#include "core/files/phantom_file.h"
#include "core/files/placement_errors_file.h"
#include "core/files/plan_file.h"
#include "core/files/planning_rules_file.h"
#include "core/files/screw_file.h"
#include "core/files/study_spec_file.h"
#include "core/phantom/spine_ground_truth.h"
#include "core/phantom/vertebra.h"
#include "core/phantom/vertebra_ground_truth.h"
#include "core/study/study_task.h"
#include "core/tool/bit_profile.h"
#include "tests/fuzz/readers.h"

namespace spinaltap::test {
namespace {

namespace fs = std::filesystem;

SeedFile json_file(const std::string& name, const std::string& text) { return {name, text, {}, true}; }

/// The shipped ones of a folder.
std::vector<Seed> shipped(const std::string& folder, const std::vector<std::string>& names) {
  std::vector<Seed> seeds;
  for (const std::string& name : names) {
    seeds.push_back({name, {json_file(name, read_whole_file(data_file(folder + "/" + name)))}});
  }
  return seeds;
}

DrillPath a_path(const char* name) {
  DrillPath path{name, Vec3(1.0 / 3.0, -2e-7, 812.3), Vec3(10.0, -30.1, 800.0), {2.7, 60.0, 4.0}};
  path.screw = PedicleScrew{"6.5 x 45 mm", 6.5, 45.0, 4.5};
  return path;
}

std::string written_plan(const std::string& name) {
  DrillPath cut = a_path("saw");
  cut.screw.reset();
  cut.bit = plate_bit(12.0, 0.8, 40.0, 4.0);
  return bytes_written(name, [&](const fs::path& file) {
    write_plan({a_path("left \"L3\""), a_path("right"), cut}, file);
  });
}

std::vector<Seed> plan_seeds() {
  const char* by_slicer = R"({"markups": [{"type": "Line", "coordinateSystem": "RAS", "coordinateUnits": ["um", "u"],
    "controlPoints": [
      {"label": "Target", "position": [-19500, -36250, 2500], "positionStatus": "defined"},
      {"label": "entry", "position": [-10500, 5000, 2000], "positionStatus": "defined"}]}]})";
  return {{"plan", {json_file("plan.json", written_plan("plan.json"))}},
          {"markups", {json_file("plan.mrk.json", written_plan("plan.mrk.json"))}},
          {"markups of 3D Slicer", {json_file("plan.mrk.json", by_slicer)}}};
}

std::vector<Seed> study_seeds() {
  const SeedFile plan = json_file("plan.json", written_plan("plan.json"));
  const SeedFile density = json_file("density.json", read_whole_file(data_file("densities/vertebra.json")));
  const SeedFile material = json_file("material.json", read_whole_file(data_file("materials/vertebra.json")));
  Json shipped_spec = read_json(data_file("studies/pedicle.json"));
  shipped_spec.erase("path");
  const char* full = R"({"format": "spinaltap-study", "version": 2, "name": "a", "bone": "bone.vdb", "level": "L3",
    "path": {"name": "own", "entry_mm": [0, 0, 0], "target_mm": [3, 0, 40],
             "bit": {"diameter_mm": 3, "length_mm": 60, "tip_length_mm": 1}},
    "density": "density.json", "material": "material.json", "volume": {"radius_mm": 3, "spacing_mm": 0.2,
    "lead_in_mm": 2, "lead_out_mm": 3}, "spindle_rpm": 1000,
    "stop": {"thrust_n": 50, "clearance_mm": 1, "on_breach": true},
    "operator": {"kind": "push", "push_n": 20, "rate_hz": 1000, "reaction_s": 0.2, "noticed_share": 0.2,
                 "tremor_mm": 0.1},
    "design": {"runs": 3, "sampling": "random", "seed": 7, "factors": {
      "bit_diameter_mm": {"levels": [2.5, 3.5]}, "push_n": {"uniform": {"low": 10, "high": 30}},
      "tremor_mm": {"normal": {"mean": 0.2, "deviation": 0.01}}}}})";
  return {{"shipped", {json_file("study.json", shipped_spec.dump(2)), plan}},
          {"full", {json_file("study.json", full), density, material}}};
}

void read_study(const fs::path& folder) {
  const StudySpec spec = read_study_spec(folder / "study.json");
  const StudyRuns runs(spec.design, ground_of(spec));
  for (const std::size_t n : {std::size_t{0}, runs.count() / 2, runs.count() - 1}) {
    static_cast<void>(study_task(spec, runs, n));
  }
}

std::vector<Seed> material_seeds() {
  const SeedFile measured =
      json_file("density.json", R"({"format": "spinaltap-density-calibration", "version": 2, "name": "phantom",
                          "calibration": [[-5, 0.0], [102.5, 0.1], [207, 0.2], [410, 0.4]]})");
  const SeedFile model = json_file("material.json", read_whole_file(data_file("materials/vertebra.json")));
  return {{"shipped", {json_file("density.json", read_whole_file(data_file("densities/vertebra.json"))), model}},
          {"measured", {measured, model}}};
}

std::vector<Seed> error_seeds() {
  std::vector<std::string> names = placement_error_models();
  for (std::string& name : names) name += ".json";
  return shipped("errors", names);
}

/// What programs write for others to read, and no reader of ours takes apart.
std::vector<Seed> other_seeds() {
  const auto write_vertebra = [](const fs::path& file) {
    write_ground_truth(vertebra_ground_truth(Vertebra()), {}, "0", file);
  };
  return {{"ground truth", {json_file("a.json", bytes_written("a.json", write_vertebra))}},
          {"nothing", {json_file("a.json", R"([null, true, 0, -1.5e-3, "\u00e4\n", {"a": {}, "b": []}])")}}};
}

template <class Read>
std::function<void(const fs::path&)> only_file_by(const Read& read) {
  return [read](const fs::path& folder) { static_cast<void>(read(only_file(folder))); };
}

std::vector<Seed> script_seeds() {
  return {
      {"script", {{"a.txt", "# a comment\nopen \"bone 1.vdb\"\n\nchoose left  # the path\nentry 1 -2.5e0 3\nquit\n"}}}};
}

std::vector<Seed> milling_seeds() {
  Milling milling;
  milling.name = "trough";
  milling.outline_mm = {{1.0 / 3.0, -2e-7, 812.3}, {10.0, -30.1, 800.0}, {12.0, 0.0, 799.0}};
  milling.into = Vec3::UnitY();
  const std::string text = bytes_written("milling.json", [&](const fs::path& file) { write_milling(milling, file); });
  return {{"milling", {json_file("milling.json", text)}}};
}

/// And the way of it over a plain.
void read_a_milling(const fs::path& file) {
  class Plain final : public ScalarField {
    void evaluate(std::span<const Vec3> points_mm, std::span<double> values_mm,
                  std::span<Vec3> /*gradients*/) const override {
      for (std::size_t n = 0; n < points_mm.size(); ++n) values_mm[n] = points_mm[n].y();
    }
  };
  const MillingMotion motion(read_milling(file), {4.0, 60.0, 1.0, BitShape::round_burr, 0.0, 2.0}, Plain());
  static_cast<void>(motion.pose(motion.count() / 2));
}

void read_planner_script(const fs::path& folder) {
  const fs::path file = only_file(folder);
  std::ifstream text(file);
  static_cast<void>(read_script(text, file.string()));
}

}  // namespace

void add_settings_readers(std::vector<Reader>& readers) {
  readers.push_back({"plan", plan_seeds, only_file_by(read_plan)});
  readers.push_back({"milling", milling_seeds, only_file_by(read_a_milling)});
  readers.push_back({"study-spec", study_seeds, read_study});
  readers.push_back({"material", material_seeds, [](const fs::path& folder) {
                       const DensityCalibration density = read_density_calibration(folder / "density.json");
                       static_cast<void>(read_material(folder / "material.json", density.line));
                     }});
  readers.push_back({"bits", [] { return shipped("bits", {"pedicle.json"}); }, only_file_by(read_bits)});
  const auto read_profile = [](const fs::path& file) { return BitProfile(read_bit_profile(file.string()).bit); };
  readers.push_back({"bit-profile",
                     [] {
                       return shipped("profiles", {"match-head.json", "probe.json", "reamer.json", "tap.json"});
                     },
                     only_file_by(read_profile)});
  readers.push_back({"screws", [] { return shipped("screws", {"pedicle.json"}); }, only_file_by(read_screws)});
  readers.push_back({"rules", [] { return shipped("planning", {"pedicle.json"}); }, only_file_by(read_planning_rules)});
  readers.push_back({"placement-errors", error_seeds, only_file_by(read_placement_errors)});
  readers.push_back({"anatomy", [] { return shipped("phantom", {"l3.json"}); },
                     only_file_by([](const fs::path& file) { return Vertebra(read_anatomy(file)).bounds_mm(); })});
  readers.push_back({"planner-script", script_seeds, read_planner_script});
  readers.push_back({"json", other_seeds, only_file_by([](const fs::path& file) { return read_json(file).dump(2); })});
}

}  // namespace spinaltap::test
