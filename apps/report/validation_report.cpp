#include "apps/report/validation_report.h"

#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <utility>

#include "apps/report/text.h"
#include "apps/report/text_table.h"
#include "core/base/text_fields.h"
#include "core/base/text_writer.h"

namespace spinaltap {
namespace {

const char* quantity_of(const PredictedFigure& figure) { return figure.is_torque ? "torque" : "thrust"; }
const char* unit_of(const PredictedFigure& figure) { return figure.is_torque ? "N mm" : "N"; }

std::string name_of_tissue(MeasuredTissue tissue) {
  switch (tissue) {
    case MeasuredTissue::bone:
      return "bone";
    case MeasuredTissue::cortical:
      return "cortical";
    case MeasuredTissue::cancellous:
      return "cancellous";
    case MeasuredTissue::vertebra:
      return "vertebra";
    case MeasuredTissue::foam:
      return "foam";
    case MeasuredTissue::artificial:
      return "artificial";
  }
  return {};
}

std::string bone_of(const DrillingMeasurement& row) {
  return row.species.empty() ? name_of_tissue(row.tissue) : row.species + " " + name_of_tissue(row.tissue);
}

/// The shortest digits, or "open" where the source says none.
std::string condition(const std::optional<MeasuredRange>& range) {
  if (!range) return "open";
  TextWriter text;
  text << range->low;
  if (range->high != range->low) text << " to " << range->high;
  return text.str();
}

std::string condition(const std::optional<double>& value) {
  return condition(value ? std::optional<MeasuredRange>({*value, *value}) : std::nullopt);
}

std::string measured_text(const PredictedFigure& figure) {
  return figure.measured_range ? condition(figure.measured_range) : condition(std::optional(figure.measured));
}

void add_table(const Measurements& measurements, const std::string& title, const std::vector<PredictedFigure>& figures,
               std::string& text) {
  TextTable table({{"source", "", false},
                   {"bone", "", false},
                   {"bit", "mm"},
                   {"speed", "rpm"},
                   {"feed", "mm/min"},
                   {"of", "", false},
                   {"measured", "N, N mm"},
                   {"law", "N, N mm"},
                   {"5 to 95 %", "N, N mm"},
                   {"inside", "", false},
                   {"factor", ""}});
  for (const PredictedFigure& figure : figures) {
    const DrillingMeasurement& row = measurements.drilling[figure.row];
    table.add_row({row.source, bone_of(row), condition(row.diameter_mm), condition(row.rpm), condition(row.feed_mm_min),
                   quantity_of(figure), measured_text(figure), readable_number(figure.predicted, 1),
                   interval_text({figure.p05, figure.p95}, 1), figure.is_inside() ? "yes" : "no",
                   readable_number(figure.error_factor(), 2)});
  }
  const FigureSummary summary = summary_of(figures);
  text += title + "\n" + table.aligned() + "  " + std::to_string(summary.figures) + " figures; inside the band " +
          readable_number(100.0 * summary.inside_share, 0) + " %; median factor of error " +
          readable_number(summary.median_error_factor, 2) + "; median of 95 % over 5 % " +
          readable_number(summary.median_width, 0) + "\n\n";
}

std::string title_of(const LawValidation& law) {
  return std::string(name_of(law.law)) + " law, each source left out of the fit that predicts it";
}

constexpr const char* kGivenTitle = "the material as it is, with its own band";

Json json_of(const ForceSpread& spread) {
  return {{"median", spread.median}, {"log_scale", spread.log_scale}, {"degrees_of_freedom", spread.degrees}};
}

Json json_of(const Measurements& measurements, const std::vector<PredictedFigure>& figures) {
  Json list = Json::array();
  for (const PredictedFigure& figure : figures) {
    Json one{{"source", measurements.drilling[figure.row].source},
             {"row", figure.row},
             {"quantity", quantity_of(figure)},
             {"unit", unit_of(figure)},
             {"measured", figure.measured}};
    if (figure.measured_range) one["measured_range"] = {figure.measured_range->low, figure.measured_range->high};
    one.update(Json{{"predicted", figure.predicted},
                    {"p05", figure.p05},
                    {"p95", figure.p95},
                    {"inside", figure.is_inside()},
                    {"error_factor", figure.error_factor()}});
    list.push_back(std::move(one));
  }
  const FigureSummary summary = summary_of(figures);
  return {{"inside_share", summary.inside_share},
          {"median_error_factor", summary.median_error_factor},
          {"median_width", summary.median_width},
          {"figures", std::move(list)}};
}

void add_lines(const Measurements& measurements, std::string_view law, const std::vector<PredictedFigure>& figures,
               TextWriter& csv) {
  const auto field = [&](double value) {
    csv << ',';
    if (std::isfinite(value)) csv << value;  // empty where it is none, as append_csv_number() has it
  };
  for (const PredictedFigure& figure : figures) {
    const DrillingMeasurement& row = measurements.drilling[figure.row];
    csv << law << ',' << row.source << ',' << bone_of(row) << ',' << quantity_of(figure) << ',' << unit_of(figure)
        << ',' << figure.measured << ',';
    if (figure.measured_range) csv << figure.measured_range->low;
    csv << ',';
    if (figure.measured_range) csv << figure.measured_range->high;
    for (const double value : {figure.predicted, figure.p05, figure.p95}) field(value);
    csv << ',' << (figure.is_inside() ? 1 : 0);
    field(figure.error_factor());
    csv << '\n';
  }
}

}  // namespace

std::string validation_text(const Measurements& measurements, const ForceValidation& validation) {
  std::string text;
  for (const LawValidation& law : validation.laws) add_table(measurements, title_of(law), law.left_out, text);
  add_table(measurements, kGivenTitle, validation.given, text);
  TextTable rest({{"source", "", false}, {"bone", "", false}, {"why no law speaks of it", "", false}});
  for (const UnpredictedRow& one : validation.unpredicted) {
    const DrillingMeasurement& row = measurements.drilling[one.row];
    rest.add_row({row.source, bone_of(row), one.why});
  }
  return text + "not predicted\n" + rest.aligned();
}

std::string validation_csv(const Measurements& measurements, const ForceValidation& validation) {
  TextWriter csv(7);
  csv << "law,source,bone,quantity,unit,measured,measured_low,measured_high,predicted,p05,p95,inside,error_factor\n";
  for (const LawValidation& law : validation.laws) add_lines(measurements, name_of(law.law), law.left_out, csv);
  add_lines(measurements, "given", validation.given, csv);
  return csv.str();
}

Json validation_json(const Measurements& measurements, const ForceValidation& validation) {
  Json json;
  for (const LawValidation& law : validation.laws) {
    Json one = json_of(measurements, law.left_out);
    const Material& fitted = law.fitted;
    one["fitted"] = {{"specific_cutting_energy_mpa", fitted.specific_cutting_energy_mpa},
                     {"cutting_exponent", fitted.cutting_exponent},
                     {"feed_exponent", fitted.feed_exponent},
                     {"lip_thrust_share", fitted.lip_thrust_share},
                     {"friction_deg", fitted.lips.friction_deg},
                     {"chisel_mpa", fitted.chisel_mpa},
                     {"chisel_exponent", fitted.chisel_exponent},
                     {"thrust_spread", json_of(fitted.thrust_spread)},
                     {"torque_spread", json_of(fitted.torque_spread)}};
    json["laws"][std::string(name_of(law.law))] = std::move(one);
  }
  json["given"] = json_of(measurements, validation.given);
  json["given"]["thrust_spread"] = json_of(validation.given_spreads.thrust);
  json["given"]["torque_spread"] = json_of(validation.given_spreads.torque);
  json["not_predicted"] = Json::array();
  for (const UnpredictedRow& one : validation.unpredicted) {
    json["not_predicted"].push_back(
        {{"source", measurements.drilling[one.row].source}, {"row", one.row}, {"why", one.why}});
  }
  return json;
}

Plot validation_plot(const LawValidation& law) {
  constexpr double kGap = std::numeric_limits<double>::quiet_NaN(), kHalf = 0.35;
  Plot plot;
  plot.title = std::string(name_of(law.law)) + " law, each source left out in turn";
  plot.x_label = "figure, in the order of the table";
  plot.y_label = "thrust (N), torque (N mm)";
  plot.log_y = true;
  PlotSeries measured{"measured", {}, {}}, predicted{"predicted", {}, {}};
  measured.points = predicted.points = true;
  measured.colour = "#c62828";
  PlotBand band{"5 to 95 %", {}, {}, {}};
  for (std::size_t n = 0; n < law.left_out.size(); ++n) {
    const PredictedFigure& figure = law.left_out[n];
    const auto x = static_cast<double>(n + 1);
    measured.x.push_back(x);
    measured.y.push_back(figure.measured);
    predicted.x.push_back(x);
    predicted.y.push_back(figure.predicted);
    for (const double at : {x - kHalf, x + kHalf}) {
      band.x.push_back(at);
      band.low.push_back(figure.p05);
      band.high.push_back(figure.p95);
    }
    band.x.push_back(kGap);
    band.low.push_back(kGap);
    band.high.push_back(kGap);
  }
  plot.series = {std::move(predicted), std::move(measured)};
  plot.bands = {std::move(band)};
  return plot;
}

}  // namespace spinaltap
