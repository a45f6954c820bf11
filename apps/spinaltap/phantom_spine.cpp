#include <algorithm>

#include "apps/spinaltap/phantom_options.h"
#include "core/base/error.h"
#include "core/base/text_fields.h"
#include "vdb/grid/mesh_solid.h"

namespace spinaltap {
namespace {

Level level_named(const std::string& name) {
  const std::optional<Level> level = level_from_name(name);
  if (!level) fail("expected the name of a level, such as T11 or L3, found '", name, "'");
  return *level;
}

std::unique_ptr<Spine> spine_of_meshes(const std::vector<std::string>& meshes, const MeshCommandOptions& frame,
                                       std::optional<double> stack_mm) {
  std::vector<SpinePart> parts;
  for (const std::string& entry : meshes) {
    const std::size_t sign = entry.find('=');
    if (sign == std::string::npos) fail("expected LEVEL=FILE for each of several meshes, found '", entry, "'");
    SpinePart part;
    part.label = static_cast<std::uint8_t>(level_named(entry.substr(0, sign)));
    const auto twice = [&](const SpinePart& other) { return other.label == part.label; };
    if (std::any_of(parts.begin(), parts.end(), twice)) fail("level ", entry.substr(0, sign), " is given twice");
    part.solid = make_mesh_solid(frame.read(entry.substr(sign + 1), static_cast<Level>(part.label)));
    parts.push_back(std::move(part));
  }
  const auto higher = [](const SpinePart& a, const SpinePart& b) {
    return level_rank(static_cast<Level>(a.label)) < level_rank(static_cast<Level>(b.label));
  };
  std::sort(parts.begin(), parts.end(), higher);
  if (stack_mm) return std::make_unique<Spine>(stacked_spine(std::move(parts), *stack_mm));
  return std::make_unique<Spine>(std::move(parts));
}

constexpr const char* kSickness = "Diseases and implants";
constexpr const char* kTissue = "Around the spine";

/// "T8=0.5" or "T8=0.5/0.9".
CrushedLevel crushed_level(const std::string& text) {
  const std::size_t sign = text.find('='), slash = text.find('/', sign);
  const auto share = [&](const std::string& number) {
    const std::optional<double> value = parse_number(number);
    if (!value) fail("--crush: expected LEVEL=SHARE or LEVEL=SHARE/SHARE, found '", text, "'");
    return *value;
  };
  if (sign == std::string::npos) (void)share("");
  CrushedLevel crushed;
  crushed.level = level_named(text.substr(0, sign));
  crushed.front_share = share(text.substr(sign + 1, slash == std::string::npos ? slash : slash - sign - 1));
  if (slash != std::string::npos) crushed.back_share = share(text.substr(slash + 1));
  return crushed;
}

}  // namespace

void SpineCommandOptions::add_to(CLI::App& app) {
  const auto number = [&](const char* name, double& value, const char* text, const char* unit) {
    app.add_option(name, value, text)->capture_default_str()->type_name(unit)->group("Spine");
  };
  app.add_option("--spine", levels,
                 "Make these levels of a spine from C1 to L6, such as T6-L5 or L3, and not a single vertebra")
      ->type_name("LEVELS")
      ->group("Spine");
  app.add_option("--random-spine", random, "Make a random patient of this seed; options of the spine are then its own")
      ->type_name("SEED")
      ->group("Spine");
  app.add_option(
         "--random-trunk", trunk_seed,
         "Make a random patient in a random scanner of this seed; all other options but the folder are then its own")
      ->type_name("SEED")
      ->group("Spine");
  app.add_option("--thoracic-levels", spine.thoracic_levels, "11, 12 or 13: without T12, or with T13")
      ->capture_default_str()
      ->type_name("N")
      ->group("Spine");
  app.add_option("--lumbar-levels", spine.lumbar_levels, "4, 5 or 6: without L5, or with L6")
      ->capture_default_str()
      ->type_name("N")
      ->group("Spine");
  app.add_option("--disc", disc_mm, "Height of all discs in their middle, mm; default: each level's own")
      ->type_name("MM")
      ->group("Spine");
  number("--facet-gap", spine.facet_gap_mm, "Min distance between neighbours, mm", "MM");
  number("--cervical-lordosis", spine.cervical_lordosis_deg, "From C3 to C7, degrees", "DEG");
  number("--kyphosis", spine.kyphosis_deg, "From T1 to T12, degrees", "DEG");
  number("--lordosis", spine.lordosis_deg, "From L1 to the sacrum, degrees", "DEG");
  number("--scoliosis", spine.scoliosis_deg, "Cobb's angle, degrees; above 0: convex to the right", "DEG");
  number("--size-of-patient", spine.scale, "Scale of all bones and discs", "SCALE");
  app.add_flag("--ribs,!--no-ribs", spine.ribs, "With or without ribs")->group("Spine");
  number("--rib12", spine.rib12_mm, "Length of the twelfth ribs, mm", "MM");
  app.add_flag("--sacrum", spine.sacrum, "A sacrum below L5")->group("Spine");
  app.add_flag("--skull", spine.skull, "A skull over C1")->group("Spine");
  app.add_flag("--pelvis", spine.pelvis, "Hip bones and thighs beside a sacrum")->group("Spine");
  app.add_flag("--shoulders", spine.shoulders, "Scapulae, upper arms, collarbones and breastbone about T2")
      ->group("Spine");
  number("--osteophytes", spine.osteophyte_mm, "Radius of spurs at the rims, mm; 0: none", "MM");
  number("--osteophyte-gap", spine.osteophyte_gap_mm, "Between spurs across a disc, mm; 0: they bridge it", "MM");
  app.add_flag("--osteoporosis", spine.osteoporosis, "Thin cortex, empty cancellous bone")->group(kSickness);
  app.add_option("--density", spine.density, "Of cancellous bone: a factor of its CT numbers")
      ->capture_default_str()
      ->type_name("FACTOR")
      ->group(kSickness);
  app.add_option("--schmorl", pits, "Levels with a pit in the upper endplate")->type_name("LEVEL")->group(kSickness);
  app.add_option("--metal", metal, "Levels with screws in their pedicles")->type_name("LEVEL")->group(kSickness);
  app.add_option("--crush", crushed,
                 "Bodies crushed to this share of their height in front and, after a slash, behind; T8=0.5/0.9")
      ->type_name("LEVEL=SHARE")
      ->group(kSickness);
  app.add_option("--cement", cement, "Levels with bone cement in the body")->type_name("LEVEL")->group(kSickness);
  number("--variation", spine.variation, "How much levels differ by chance, 0 to 1.5", "SHARE");
  app.add_flag("--soft-tissue", soft_tissue, "Discs, muscle, fat, aorta and lungs around the spine")->group(kTissue);
  CLI::Option* whole =
      app.add_flag("--trunk", trunk, "A whole trunk around the spine: soft tissue, skin, organs, bowel and a table")
          ->group(kTissue);
  app.add_flag("--contrast", contrast, "Contrast in a trunk's aorta (220 HU) and kidneys (180 HU)")
      ->needs(whole)
      ->group(kTissue);
  app.add_flag("--table,!--no-table", tissue.table, "A trunk lies on a table, or not")->needs(whole)->group(kTissue);
  app.add_option("--bowel-gas", tissue.gas_share, "Share of a trunk's bowel that holds gas, 0 to 1")
      ->capture_default_str()
      ->type_name("SHARE")
      ->needs(whole)
      ->group(kTissue);
  app.add_flag("--stent", tissue.stent, "A wire stent in a trunk's aorta")->needs(whole)->group(kTissue);
  app.add_flag("--pacemaker", tissue.pacemaker, "A pacemaker in a trunk's chest")->needs(whole)->group(kTissue);
  app.add_option("--stack", stack_mm, "Put named meshes above each other with this gap, mm; default: as they stand")
      ->type_name("MM")
      ->group("Spine");
  app.add_option("--centre", centre_mm, "Middle of the field of view, mm, patient LPS; default: that of the bones")
      ->expected(3)
      ->delimiter(',')
      ->type_name("X,Y,Z")
      ->group("Spine");
}

std::unique_ptr<Spine> SpineCommandOptions::make() const {
  if (!meshes.empty()) return spine_of_meshes(meshes, mesh_frame, stack_mm);
  SpineOptions options = spine;
  if (!levels.empty()) {
    const std::size_t dash = levels.find('-');
    options.first = level_named(levels.substr(0, dash));
    options.last = dash == std::string::npos ? options.first : level_named(levels.substr(dash + 1));
  }
  if (random) return std::make_unique<Spine>(random_spine_options(*random, options));
  if (disc_mm) options.cervical_disc_mm = options.thoracic_disc_mm = options.lumbar_disc_mm = *disc_mm;
  for (const std::string& name : metal) options.screws.push_back(level_named(name));
  for (const std::string& name : cement) options.cement.push_back(level_named(name));
  for (const std::string& text : crushed) options.crushed.push_back(crushed_level(text));
  for (const std::string& name : pits) options.schmorl_nodes.push_back(level_named(name));
  return std::make_unique<Spine>(options);
}

std::unique_ptr<Surroundings> SpineCommandOptions::surroundings_of(const Spine& made) const {
  constexpr double kKidneyHu = 180.0;
  if (trunk) {
    TrunkTissueOptions around = tissue;
    if (contrast) around.kidney_hu = kKidneyHu;
    if (!contrast) around.soft.aorta_hu = kBloodHu;
    if (spine.shoulders) around.shoulder_mm = kShoulderMm;
    return std::make_unique<TrunkTissue>(made, around);
  }
  if (soft_tissue) return std::make_unique<SoftTissue>(made);
  return nullptr;
}

}  // namespace spinaltap
