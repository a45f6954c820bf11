#include "apps/spinaltap/finding_options.h"

#include <array>
#include <charconv>
#include <functional>
#include <string>

#include "core/files/strokes.h"

namespace spinaltap {
namespace {

/// "-9,222,-638". Throws CLI::ValidationError.
Vec3 point_in(const std::string& option, const std::string& text) {
  std::array<double, 3> numbers{};
  const char* at = text.data();
  const char* const end = text.data() + text.size();
  bool is_good = true;
  for (std::size_t n = 0; n < 3 && is_good; ++n) {
    const auto [stop, error] = std::from_chars(at, end, numbers[n]);
    is_good = error == std::errc{} && (n < 2 ? stop != end && *stop == ',' : stop == end);
    at = stop + (n < 2 ? 1 : 0);
  }
  if (!is_good) throw CLI::ValidationError(option, "expected a point as X,Y,Z in mm, found " + text);
  return {numbers[0], numbers[1], numbers[2]};
}

/// "T11=-9,222,-638". Throws CLI::ValidationError.
LevelPoint level_point_in(const std::string& option, const std::string& text) {
  const std::size_t sign = text.find('=');
  if (sign == std::string::npos) {
    throw CLI::ValidationError(option, "expected a vertebra and a point in it as T11=X,Y,Z, found " + text);
  }
  const std::optional<Level> level = level_from_name(text.substr(0, sign));
  if (!level) {
    throw CLI::ValidationError(option, "expected a vertebra such as T11 or L3, found " + text.substr(0, sign));
  }
  return {*level, point_in(option, text.substr(sign + 1))};
}

using Texts = std::vector<std::string>;

/// An option that may be given several times, with one value each.
void add_repeated(CLI::App& app, CLI::Option* labels, const char* name, const char* text, const char* type,
                  const std::function<void(const std::string&)>& take) {
  const auto take_all = [take](const Texts& values) {
    for (const std::string& value : values) take(value);
  };
  app.add_option_function<Texts>(name, take_all, text)->allow_extra_args(false)->excludes(labels)->type_name(type);
}

}  // namespace

void FindingOptions::add_to(CLI::App& app, CLI::Option* labels) {
  app.add_option("--seed-point", seed_mm,
                 "A point in the body of the wanted vertebra, patient LPS, mm; default: the largest whole one")
      ->excludes(labels)
      ->expected(3)
      ->delimiter(',')
      ->type_name("X,Y,Z");
  add_repeated(app, labels, "--level",
               "Name a vertebra by a point in its body, patient LPS, mm: the others are counted from it; repeatable",
               "LEVEL=X,Y,Z",
               [this](const std::string& value) { segment.names.push_back(level_point_in("--level", value)); });
  add_repeated(app, labels, "--include",
               "Correction: the bone around this point (patient LPS, mm) belongs to this vertebra; repeatable",
               "LEVEL=X,Y,Z", [this](const std::string& value) {
                 const LevelPoint point = level_point_in("--include", value);
                 segment.corrections.push_back({point.level, point.p_mm});
               });
  add_repeated(app, labels, "--exclude",
               "Correction: the bone around this point (patient LPS, mm) belongs to no vertebra; repeatable", "X,Y,Z",
               [this](const std::string& value) {
                 segment.corrections.push_back({Level::kNone, point_in("--exclude", value)});
               });
  app.add_option(
         "--strokes", strokes,
         "Corrections painted as a label map, NIfTI or NRRD: segments named by vertebrae belong to them, others, "
         "such as \"exclude\", to none")
      ->excludes(labels)
      ->type_name("FILE");
  app.add_option("--threshold", segment.threshold_hu,
                 "Bone is at least this dense, HU; default: 150, less in a noisy CT")
      ->excludes(labels)
      ->type_name("HU");
  app.add_flag("--accept-warnings", accepts_warnings,
               "Exit with 0 also where a vertebra is suspect; without it the exit code is then 1, with all written");
}

std::optional<Vec3> FindingOptions::given_seed() const {
  if (seed_mm.empty()) return std::nullopt;
  return Vec3(seed_mm[0], seed_mm[1], seed_mm[2]);
}

SegmentOptions FindingOptions::complete(const CtVolume& ct) const {
  SegmentOptions options = segment;
  options.seed_mm = given_seed();
  if (!strokes.empty()) {
    for (const Correction& correction : read_strokes(strokes, ct.geometry)) options.corrections.push_back(correction);
  }
  return options;
}

}  // namespace spinaltap
