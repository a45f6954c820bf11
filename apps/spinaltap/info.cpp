#include <algorithm>
#include <memory>
#include <sstream>

#include "apps/spinaltap/command.h"
#include "apps/spinaltap/ct_options.h"
#include "core/base/error.h"
#include "core/ct/dicom_read.h"
#include "core/segment/bone_levels.h"

namespace spinaltap {
namespace {

std::string triple(const Vec3& v, const char* unit) {
  std::ostringstream text;
  text << v.x() << ", " << v.y() << ", " << v.z() << ' ' << unit;
  return text.str();
}

Json info_of_bone(const std::filesystem::path& file) {
  const BoneModel bone = read_bone(file);
  const Box3 bounds_mm = bone.bounds_mm();
  print_figure("grid voxels", static_cast<double>(bone.active_voxels()), "", 0);
  print_figure("voxel", bone.voxel_mm(), "mm", 3);
  print_figure("from", triple(bounds_mm.min(), "mm"));
  print_figure("to", triple(bounds_mm.max(), "mm"));
  Json facts = Json::object();
  for (const auto& [key, value] : bone.facts()) {
    print_figure(key, value);
    facts[key] = value;
  }
  return {{"active_voxels", bone.active_voxels()},
          {"voxel_mm", bone.voxel_mm()},
          {"low_mm", to_json(bounds_mm.min())},
          {"high_mm", to_json(bounds_mm.max())},
          {"facts", facts}};
}

Json info_of_series(const CtVolume& ct) {
  const GridGeometry& geometry = ct.geometry;
  const auto [lowest, highest] = std::minmax_element(ct.hu.begin(), ct.hu.end());
  std::ostringstream size;
  size << geometry.size[0] << " x " << geometry.size[1] << " x " << geometry.size[2];
  const Vec3 far_corner(geometry.size[0] - 1, geometry.size[1] - 1, geometry.size[2] - 1);
  print_figure("voxels", size.str());
  print_figure("voxel step", triple(geometry.spacing_mm, "mm"));
  print_figure("first voxel", triple(geometry.origin_mm, "mm"));
  print_figure("last voxel", triple(geometry.to_patient(far_corner), "mm"));
  for (int axis = 0; axis < 3; ++axis) {
    print_figure(std::string("direction of ") + "ijk"[axis], triple(geometry.directions.col(axis), ""));
  }
  const double noise_hu = estimate_noise_hu(ct);
  print_figure("lowest CT number", *lowest, "HU", 0);
  print_figure("highest CT number", *highest, "HU", 0);
  print_figure("noise in soft tissue, about", noise_hu, "HU", 0);
  print_figure("hash", ct.source_hash);
  return {{"size", geometry.size},
          {"spacing_mm", to_json(geometry.spacing_mm)},
          {"origin_mm", to_json(geometry.origin_mm)},
          {"direction_i", to_json(geometry.directions.col(0))},
          {"direction_j", to_json(geometry.directions.col(1))},
          {"direction_k", to_json(geometry.directions.col(2))},
          {"lowest_hu", *lowest},
          {"highest_hu", *highest},
          {"noise_hu", noise_hu},
          {"hash", ct.source_hash}};
}

}  // namespace

void add_info(CLI::App& program, Command& command) {
  const auto options = std::make_shared<CtOptions>();
  CLI::App* app = add_command(program, command, "info", "Show what a CT folder or a bone.vdb holds",
                              "Example: spinaltap info ct/ --json ct.json");
  app->add_option("path", options->folder, "Folder with DICOM files, or a bone.vdb")->required()->type_name("PATH");
  options->add_reading(*app);

  command.run = [options](const Progress& progress) -> Json {
    if (options->folder.extension() == ".vdb") return info_of_bone(options->folder);
    const std::vector<SeriesInfo> series = list_dicom_series(options->folder, progress);
    Json list = Json::array();
    for (const SeriesInfo& one : series) {
      std::ostringstream text;
      text << one.modality << ", " << one.files.size() << " files of " << one.columns << " x " << one.rows << ", UID "
           << (one.uid.empty() ? "none" : one.uid);
      print_figure("series " + std::to_string(one.number), text.str());
      list.push_back({{"number", one.number},
                      {"uid", one.uid},
                      {"modality", one.modality},
                      {"files", one.files.size()},
                      {"columns", one.columns},
                      {"rows", one.rows}});
    }
    Json figures{{"series", list}};
    if (series.size() == 1 || !options->series.empty()) figures["ct"] = info_of_series(options->read(progress));
    return figures;
  };
}

}  // namespace spinaltap
