#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace spinaltap {

// Published measurements, as the shipped measurements/*.csv have them: what laws are held against. What a source leaves
// out is empty here. docs/measurements.md tells how to read a row.

/// Between two figures; the same twice where a source gives one.
struct MeasuredRange {
  double low = 0.0;
  double high = 0.0;
};

/// Of what a figure is told.
enum class MeasuredAs : std::uint8_t {
  not_stated,
  mean,      ///< over the steady phase
  max,       ///< the largest of each run, or their mean
  mean_max,  ///< heat: the mean of the runs' largest
  rise,      ///< heat: above the bone's own temperature
  bit        ///< heat: of the bit, not of bone
};

enum class MeasuredTissue : std::uint8_t {
  bone,  ///< the source does not say which
  cortical,
  cancellous,
  vertebra,  ///< through its shell and what is within
  foam,
  artificial  ///< bone as made for tests
};

enum class MeasuredProcess : std::uint8_t { drill, ultrasonic, awl };

enum class MeasuredTorque : std::uint8_t { insertion, max_insertion, extraction };

enum class MeasuredIrrigation : std::uint8_t { not_stated, none, external, internal };

struct MeasurementSource {
  std::string key;
  bool is_cited = false;  ///< what was read tells of it; the source itself was not read
  std::string authors;
  std::string title;
  std::string journal;
  std::optional<int> year;
  std::string doi;
  std::string url;    ///< where it was read
  std::string read;   ///< what of it: "abstract", "table 6 of orelaja2020"
  std::string quote;  ///< the sentences or cells that its rows were copied from
};

/// What rows of every kind say.
struct MeasurementRow {
  std::string source;  ///< its key
  std::string species;
  MeasuredTissue tissue = MeasuredTissue::bone;
  std::string site;
  std::optional<int> n;
  std::string n_of;        ///< "femurs"
  bool is_fitted = false;  ///< numbers of the shipped cutting model were chosen by it
  std::string note;
};

struct DrillingMeasurement : MeasurementRow {
  std::optional<double> density_g_cm3;
  std::string density_known_by;
  MeasuredProcess process = MeasuredProcess::drill;
  std::string tool;
  std::optional<double> diameter_mm;
  std::optional<double> point_angle_deg;
  std::optional<double> web_mm;
  std::optional<double> helix_deg;
  std::optional<MeasuredRange> rpm;
  std::optional<MeasuredRange> feed_mm_min;
  std::optional<double> pilot_mm;
  std::optional<double> thrust_n;
  std::optional<double> thrust_sd_n;
  std::optional<MeasuredRange> thrust_range_n;
  MeasuredAs thrust_kind = MeasuredAs::not_stated;
  std::optional<double> torque_n_mm;
  std::optional<double> torque_sd_n_mm;
  std::optional<MeasuredRange> torque_range_n_mm;
  MeasuredAs torque_kind = MeasuredAs::not_stated;
  bool has_noted_conditions = false;  ///< tool, speed or feed come from notes, not from what was read
};

struct ScrewMeasurement : MeasurementRow {
  std::string group;  ///< "osteoporotic"
  std::optional<double> hu;
  std::optional<double> hu_sd;
  std::optional<double> t_score;
  std::optional<double> t_score_sd;
  std::optional<double> bmd_g_cm2;
  std::optional<double> density_g_cm3;
  std::string density_known_by;
  std::string screw;
  std::optional<double> outer_diameter_mm;
  std::optional<double> core_diameter_mm;
  std::optional<double> pitch_mm;
  std::optional<double> length_mm;
  std::optional<double> inserted_mm;
  std::optional<double> pilot_mm;
  std::optional<double> torque_n_mm;
  std::optional<double> torque_sd_n_mm;
  std::optional<MeasuredTorque> torque_kind;  ///< where there is a torque
  std::optional<double> pullout_n;
  std::optional<double> pullout_sd_n;
  std::optional<double> stiffness_n_mm;
};

struct HeatMeasurement : MeasurementRow {
  MeasuredProcess process = MeasuredProcess::drill;
  std::string tool;
  std::optional<MeasuredRange> diameter_mm;
  std::optional<MeasuredRange> rpm;
  std::optional<MeasuredRange> feed_mm_min;
  std::optional<double> feed_mm_rev;
  std::optional<double> axial_force_n;
  std::optional<double> pilot_mm;
  MeasuredIrrigation irrigation = MeasuredIrrigation::not_stated;
  std::optional<double> distance_mm;  ///< from the hole's wall
  std::optional<double> depth_mm;
  std::optional<double> temperature_c;
  std::optional<double> temperature_sd_c;
  std::optional<MeasuredRange> temperature_range_c;
  MeasuredAs temperature_kind = MeasuredAs::not_stated;
};

struct Measurements {
  std::vector<MeasurementSource> sources;
  std::vector<DrillingMeasurement> drilling;
  std::vector<ScrewMeasurement> screws;
  std::vector<HeatMeasurement> heat;
};

/// Reads sources.csv, drilling.csv, screws.csv and heat.csv of a folder. Their columns may stand in any order, but none
/// may be missing or unknown. Throws Error that names file, line and column: on a value without sense (lengths, speeds,
/// forces and torques are above 0, deviations at least 0, ranges rise), on a row without a figure or with a source that
/// sources.csv does not have, on a key that is there twice.
Measurements read_measurements(const std::filesystem::path& folder);

/// Those that ship.
Measurements shipped_measurements();

}  // namespace spinaltap
