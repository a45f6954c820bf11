#include "apps/spinaltap/report_options.h"

#include <array>
#include <ctime>
#include <map>
#include <vector>

#include "core/base/error.h"
#include "vdb/grid/bone_model.h"

namespace spinaltap {
namespace {

/// What stands for an option's value: nothing where the value itself may be shown, as numbers and words of a list may.
std::string placeholder(const CLI::Option& option) {
  static const std::map<std::string, std::string> kByOption{
      {"bone", "bone.vdb"}, {"plan", "plan.json"}, {"ct", "CT"},           {"--ct", "CT"},
      {"--series", "UID"},  {"--title", "TITLE"},  {"--output", "OUTPUT"}, {"--report", "report.html"},
      {"--path", "PATH"},   {"--name", "NAME"}};
  if (const auto found = kByOption.find(option.get_name(false)); found != kByOption.end()) return found->second;
  std::string type = option.get_type_name();
  for (const char* hidden : {"FILE", "FOLDER", "PATH", "TEXT", "NAME", "LABEL"}) {
    if (type == hidden) return type;
  }
  return {};
}

/// The name that was given for an option's value where one_of() made that of a name; else the value.
std::string given_name(CLI::Option& option, const std::string& value) {
  for (int n = 0;; ++n) {
    const CLI::Validator* known = nullptr;
    try {
      known = option.get_validator(n);
    } catch (const CLI::OptionNotFound&) {
      return value;
    }
    const std::string& names = known->get_name();
    const std::size_t found = names.find(";" + value + "=");
    if (found == std::string::npos) continue;
    const std::size_t begin = found + value.size() + 2;
    return names.substr(begin, names.find(';', begin) - begin);
  }
}

}  // namespace

void PageOptions::add_to(CLI::App& app) {
  app.add_option("--ct", ct.folder, "The CT, for the report's slices; default: the CT numbers that the bone keeps")
      ->type_name("PATH");
  ct.add_reading(app);
  app.add_option("--title", title, "Title of the report; default: the vertebra's name")->type_name("TEXT");
  app.parse_complete_callback([this, &app] { command = shown_command(app); });
}

std::optional<CtVolume> PageOptions::read(std::span<const Bone> bones, const Progress& progress) const {
  if (ct.folder.empty()) return std::nullopt;
  CtVolume volume = ct.read(progress);
  for (const Bone& bone : bones) {
    const Vec3 centre_mm = bone.model().bounds_mm().center();
    const Vec3 index = volume.geometry.to_index(centre_mm);
    for (int axis = 0; axis < 3; ++axis) {
      if (index[axis] < 0.0 || index[axis] > volume.geometry.size[static_cast<std::size_t>(axis)] - 1) {
        fail("--ct: expected the CT that the bone was made of, found one that does not hold the bone's middle, ",
             centre_mm.x(), ", ", centre_mm.y(), ", ", centre_mm.z(), " mm");
      }
    }
  }
  return volume;
}

std::string PageOptions::title_of(const Bone& bone, const std::string& otherwise) const {
  if (!title.empty()) return title;
  const auto found = bone.model().metadata().find("level");
  return found == bone.model().metadata().end() || found->second.empty() ? otherwise : found->second;
}

std::string shown_command(CLI::App& app) {
  std::string text = "spinaltap " + app.get_name();
  std::string options;
  for (CLI::Option* option : app.get_options()) {
    if (option->count() == 0 || option->get_name(false) == "--json" || option->get_name(false) == "--threads") continue;
    std::string words;
    const std::string hidden = placeholder(*option);
    if (!hidden.empty()) {
      words = " " + hidden;
    } else if (option->get_items_expected_max() > 0) {
      for (const std::string& value : option->results()) {
        words += (words.empty() ? " " : ",") + given_name(*option, value);
      }
    }
    if (option->get_positional()) {
      text += words;
    } else {
      options += " " + option->get_name(false) + words;
    }
  }
  return text + options;
}

std::string today() {
  const std::time_t now = std::time(nullptr);
  std::tm parts{};
  localtime_r(&now, &parts);
  std::array<char, 16> text{};
  std::strftime(text.data(), text.size(), "%Y-%m-%d", &parts);
  return text.data();
}

GradeReportData report_head(const std::string& title, const std::string& command, const Bone& bone,
                            const std::optional<CtVolume>& ct, CtVolume& kept) {
  if (!ct) kept = ct_of_bone(bone.model());
  GradeReportData data;
  data.title = title;
  data.landmarks = &bone.landmarks();
  data.ct = ct ? &*ct : &kept;
  data.bone_bounds_mm = bone.model().bounds_mm();
  data.bone = &bone;
  data.has_own_ct = ct.has_value();
  data.command = command;
  data.date = today();
  return data;
}

}  // namespace spinaltap
