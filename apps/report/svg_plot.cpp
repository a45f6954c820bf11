#include "apps/report/svg_plot.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>
#include <utility>

#include "apps/report/curve_names.h"
#include "apps/report/label_place.h"
#include "apps/report/plot_ticks.h"
#include "apps/report/svg_parts.h"
#include "apps/report/text.h"
#include "core/base/error.h"

namespace spinaltap {
namespace {

// Okabe & Ito's colours for all kinds of colour vision, those that are dark enough on white.
constexpr std::array<std::string_view, 6> kColours{"#0072B2", "#D55E00", "#009E73", "#CC79A7", "#56B4E9", "#B58900"};
constexpr double kFontSize = 13.0;
constexpr double kColumn = 0.5;  ///< of a thinned curve, drawing units
constexpr double kLeft = 76.0;
constexpr double kRight = 18.0;
constexpr double kTop = 34.0;
constexpr double kTopWithoutTitle = 8.0;
constexpr double kMarkerRow = 18.0;
constexpr double kMarkerGap = 4.0;  ///< between a marker's line and its label
constexpr double kTitleSize = 15.0;
constexpr double kLegendRow = 18.0;
constexpr double kLegendGap = 14.0;  ///< between two names
constexpr double kBottom = 50.0;

void check_lengths(const Plot& plot) {
  for (const PlotSeries& s : plot.series) {
    if (s.x.size() != s.y.size()) fail("plot: curve ", s.name, " has ", s.x.size(), " x and ", s.y.size(), " y values");
  }
  for (const PlotBand& b : plot.bands) {
    if (b.x.size() != b.low.size() || b.x.size() != b.high.size()) {
      fail("plot: band ", b.name, " has ", b.x.size(), " x, ", b.low.size(), " low and ", b.high.size(),
           " high values");
    }
  }
}

/// Lowest and highest value that can be drawn.
class Range {
 public:
  explicit Range(bool log = false) { scale_.log = log; }
  void add(double value) {
    if (!scale_.shows(value)) return;
    low_ = empty_ ? value : std::min(low_, value);
    high_ = empty_ ? value : std::max(high_, value);
    empty_ = false;
  }
  void add(const std::vector<double>& values) {
    for (const double value : values) add(value);
  }
  bool empty() const { return empty_; }
  double low() const { return low_; }
  double high() const { return high_; }

 private:
  AxisScale scale_;
  bool empty_ = true;
  double low_ = 0.0;
  double high_ = 1.0;
};

Range x_range(const Plot& plot) {
  Range range;
  for (const PlotSeries& s : plot.series) range.add(s.x);
  for (const PlotBand& b : plot.bands) range.add(b.x);
  for (const PlotMarker& m : plot.markers) range.add(m.x);
  range.add(plot.x_low);
  range.add(plot.x_high);
  return range;
}

Range y_range(const Plot& plot) {
  Range range(plot.log_y);
  for (const PlotSeries& s : plot.series) range.add(s.y);
  for (const PlotBand& b : plot.bands) {
    range.add(b.low);
    range.add(b.high);
  }
  if (plot.y_from_zero && !plot.log_y) range.add(0.0);
  return range;
}

std::string line(double x1, double y1, double x2, double y2, std::string_view style) {
  return "<path d=\"M" + svg_number(x1) + " " + svg_number(y1) + "L" + svg_number(x2) + " " + svg_number(y2) + "\" " +
         std::string(style) + "/>\n";
}

std::string with_unit(const std::string& name, const std::string& unit) {
  return unit.empty() ? name : name + " (" + unit + ")";
}

std::string_view colour(std::size_t index) { return kColours[index % kColours.size()]; }

class PlotDrawing {
 public:
  explicit PlotDrawing(const Plot& plot) : plot_(plot) {
    const Range xs = x_range(plot);
    const Range ys = y_range(plot);
    x_ticks_ = linear_ticks(xs.low(), xs.high(), plot.width < 480.0 ? 6 : 12);
    const double y_low = std::isfinite(plot.y_low) ? plot.y_low : ys.low();
    const double y_high = std::isfinite(plot.y_high) ? plot.y_high : ys.high();
    y_ticks_ = plot.log_y ? log_ticks(ys.empty() ? 1.0 : ys.low(), ys.empty() ? 10.0 : ys.high())
                          : linear_ticks(y_low, y_high, plot.height < 240.0 ? 4 : 6);
    // The curve fills the width, though it may not end on a tick.
    const bool fills = xs.high() > xs.low();
    x_ = {fills ? xs.low() : x_ticks_.low, fills ? xs.high() : x_ticks_.high, kLeft, plot.width - kRight, false};
    if (!plot.names_at_curves) lay_out_legend();
    const double top =
        (plot.title.empty() ? kTopWithoutTitle : kTop) + lay_out_markers() * kMarkerRow + legend_rows_ * kLegendRow;
    y_ = {y_ticks_.low, y_ticks_.high, plot.height - kBottom, top, plot.log_y};
    if (std::isfinite(plot.y_low)) y_.low = plot.y_low;
    if (std::isfinite(plot.y_high)) y_.high = plot.y_high;
  }

  PlotAxes axes() const { return {x_, y_}; }

  std::string draw() {
    add_zones();
    add_grid();
    for (std::size_t i = 0; i < plot_.bands.size(); ++i) add_band(plot_.bands[i], colour(i));
    add_markers();
    for (std::size_t i = 0; i < plot_.series.size(); ++i) add_series(plot_.series[i], colour_of(i));
    add_frame_and_titles();
    add_zone_names();
    if (plot_.names_at_curves) add_names();
    add_legend();
    return std::move(svg_);
  }

 private:
  void add_grid() {
    const auto step = [](const AxisTicks& ticks) { return ticks.major[1] - ticks.major[0]; };
    for (const double value : y_ticks_.minor) {
      if (!is_in_height(value)) continue;
      svg_ += line(x_.from, y_(value), x_.to, y_(value), "stroke=\"#eef1f3\"");
    }
    for (const double value : y_ticks_.major) {
      if (!is_in_height(value)) continue;
      svg_ += line(x_.from, y_(value), x_.to, y_(value), "stroke=\"#d9dee2\"");
      svg_ += svg_text(x_.from - 8.0, y_(value) + 4.5, "end", tick_label(value, plot_.log_y ? 0.0 : step(y_ticks_)));
    }
    const double slack = 1e-9 * (x_.high - x_.low);
    for (const double value : x_ticks_.major) {
      if (value < x_.low - slack || value > x_.high + slack) continue;
      svg_ += line(x_(value), y_.from, x_(value), y_.to, "stroke=\"#d9dee2\"");
      svg_ += svg_text(x_(value), y_.from + 18.0, "middle", tick_label(value, step(x_ticks_)));
    }
  }

  /// One area for every stretch where x and both edges are known.
  void add_band(const PlotBand& band, std::string_view fill) {
    PlotRun low, high;
    const auto flush = [&] {
      PlotRun edge = thinned(high, kColumn);
      const PlotRun back = thinned(low, kColumn);
      edge.insert(edge.end(), back.rbegin(), back.rend());
      if (high.size() > 1) {
        drew_ = true;
        svg_ += "<path d=\"" + path_data(edge) + "Z\" fill=\"" + std::string(fill) + "\" fill-opacity=\"0.18\"/>\n";
      }
      low.clear();
      high.clear();
    };
    for (std::size_t i = 0; i < band.x.size(); ++i) {
      if (x_.shows(band.x[i]) && y_.shows(band.low[i]) && y_.shows(band.high[i])) {
        low.emplace_back(x_(band.x[i]), y_(band.low[i]));
        high.emplace_back(x_(band.x[i]), y_(band.high[i]));
      } else {
        flush();
      }
    }
    flush();
  }

  /// How many rows their labels take.
  int lay_out_markers() {
    for (const PlotMarker& marker : plot_.markers) {
      if (!x_.shows(marker.x)) continue;
      marker_labels_.push_back({x_(marker.x), text_width(marker.label, kFontSize)});
      marker_texts_.push_back(marker.label);
    }
    lay_out_line_labels(marker_labels_, plot_.width, kMarkerGap);
    int rows = 0;
    for (const LineLabel& label : marker_labels_) rows = std::max(rows, label.row + 1);
    return rows;
  }

  void add_markers() {
    for (std::size_t n = 0; n < marker_labels_.size(); ++n) {
      const LineLabel& at = marker_labels_[n];
      const double base = y_.to - 6.0 - at.row * kMarkerRow;
      svg_ += line(at.x, y_.from, at.x, base - 9.0, "stroke=\"#333b42\" stroke-width=\"1.2\" stroke-dasharray=\"5 4\"");
      svg_ += svg_text(at.x + (at.is_left ? -kMarkerGap : kMarkerGap), base, at.is_left ? "end" : "start",
                       marker_texts_[n], "fill=\"#333b42\"");
      taken_.emplace_back(Eigen::Vector2d(at.x, y_.to), Eigen::Vector2d(at.x, y_.from));
    }
  }

  bool is_in_height(double value) const {
    const double slack = 1e-9 * (y_.high - y_.low);
    return value >= y_.low - slack && value <= y_.high + slack;
  }

  void add_zones() {
    for (const PlotZone& zone : plot_.zones) {
      const double low = std::max(zone.low, y_.low), high = std::min(zone.high, y_.high);
      if (!(high > low)) continue;
      svg_ += "<rect x=\"" + svg_number(x_.from) + "\" y=\"" + svg_number(y_(high)) + "\" width=\"" +
              svg_number(x_.to - x_.from) + "\" height=\"" + svg_number(y_(low) - y_(high)) + "\" fill=\"" +
              escape_html(zone.colour) + "\" fill-opacity=\"0.16\"/>\n";
    }
  }

  /// In the zone's lower right corner.
  void add_zone_names() {
    for (const PlotZone& zone : plot_.zones) {
      const double low = std::max(zone.low, y_.low), high = std::min(zone.high, y_.high);
      if (!(high > low) || zone.name.empty()) continue;
      const Eigen::Vector2d corner(x_.to - 6.0, y_(low) - 3.0);
      const Eigen::Vector2d size(text_width(zone.name, kFontSize), kFontSize);
      svg_ += svg_text(corner.x(), corner.y() - 1.0, "end", zone.name,
                       "font-weight=\"600\" fill=\"" + escape_html(zone.colour) + "\"");
      taken_.emplace_back(Eigen::Vector2d(corner - size), corner);
    }
  }

  void add_names() {
    std::vector<NamedCurve> curves;
    for (const PlotSeries& series : plot_.series) curves.push_back({series.name, runs_of(series)});
    const Eigen::AlignedBox2d room(Eigen::Vector2d(x_.from, y_.to), Eigen::Vector2d(x_.to, y_.from));
    const std::vector<Eigen::AlignedBox2d> places = place_curve_names(curves, room, kFontSize, taken_);
    for (std::size_t n = 0; n < places.size(); ++n) {
      if (places[n].isEmpty()) continue;
      svg_ += svg_text(places[n].min().x(), places[n].max().y() - 0.25 * kFontSize, "start", curves[n].name,
                       "font-weight=\"600\" fill=\"" + escape_html(colour_of(n)) + "\"");
    }
  }

  std::vector<PlotRun> runs_of(const PlotSeries& series) const {
    std::vector<PlotRun> runs = curve_runs(series.x, series.y, x_, y_);
    if (series.step) {
      for (PlotRun& run : runs) run = stepped(run);
    }
    return std::isfinite(plot_.y_low) || std::isfinite(plot_.y_high) ? cut_to_heights(runs, y_.to, y_.from) : runs;
  }

  std::string_view colour_of(std::size_t series) const {
    const std::string& own = plot_.series[series].colour;
    return own.empty() ? colour(series) : std::string_view(own);
  }

  void add_series(const PlotSeries& series, std::string_view stroke) {
    std::string data;
    for (const PlotRun& run : runs_of(series)) {
      if (series.points) {
        for (const Eigen::Vector2d& p : run) data += path_data({p});
      } else {
        data += path_data(thinned(run, kColumn));
      }
    }
    if (data.empty()) return;
    drew_ = true;
    svg_ += "<path d=\"" + data + "\" fill=\"none\" stroke=\"" + escape_html(stroke) + "\" stroke-width=\"" +
            (series.points ? "5\" stroke-opacity=\"0.6" : "1.6") + (series.dashed ? "\" stroke-dasharray=\"4 4" : "") +
            "\" stroke-linejoin=\"round\" stroke-linecap=\"round\"/>\n";
  }

  void add_frame_and_titles() {
    const double x_middle = 0.5 * (x_.from + x_.to);
    const double y_middle = 0.5 * (y_.from + y_.to);
    svg_ += "<rect x=\"" + svg_number(x_.from) + "\" y=\"" + svg_number(y_.to) + "\" width=\"" +
            svg_number(x_.to - x_.from) + "\" height=\"" + svg_number(y_.from - y_.to) +
            "\" fill=\"none\" stroke=\"#5b6670\"/>\n";
    if (!plot_.title.empty())
      svg_ += svg_text(x_.from, 18.0, "start", plot_.title, "font-weight=\"600\" font-size=\"15\" fill=\"#1a2026\"");
    svg_ += svg_text(x_middle, y_.from + 40.0, "middle", with_unit(plot_.x_label, plot_.x_unit));
    svg_ += svg_text(0.0, 0.0, "middle", with_unit(plot_.y_label, plot_.y_unit),
                     "transform=\"translate(18 " + svg_number(y_middle) + ") rotate(-90)\"");
    if (!drew_) svg_ += svg_text(x_middle, y_middle, "middle", "no data", "fill=\"#5b6670\" font-style=\"italic\"");
  }

  /// On the title's line, ending on the right; where that is too short, on lines of its own below it.
  void lay_out_legend() {
    for (std::size_t i = 0; i < plot_.series.size(); ++i)
      legend_.push_back({plot_.series[i].name, colour_of(i), false});
    for (std::size_t i = 0; i < plot_.bands.size(); ++i) legend_.push_back({plot_.bands[i].name, colour(i), true});
    std::erase_if(legend_, [](const LegendEntry& entry) { return entry.name.empty(); });
    if (legend_.size() < 2) legend_.clear();
    double length = -kLegendGap;
    for (const LegendEntry& entry : legend_) length += entry.width() + kLegendGap;
    const double begin = x_.to - length;
    const double title_end = plot_.title.empty() ? x_.from : x_.from + text_width(plot_.title, kTitleSize) + kLegendGap;
    const bool fits = begin >= title_end;
    double x = fits ? begin : x_.to;  // full: the first begins a line
    for (LegendEntry& entry : legend_) {
      if (!fits && x + entry.width() > x_.to) {
        x = x_.from;
        ++legend_rows_;
      }
      entry.x = x;
      entry.y = 18.0 + legend_rows_ * kLegendRow;
      x += entry.width() + kLegendGap;
    }
  }

  void add_legend() {
    for (const LegendEntry& entry : legend_) {
      const std::string paint(entry.colour);
      const double y = entry.y - 4.5;
      svg_ += entry.area
                  ? line(entry.x, y, entry.x + 22.0, y, "stroke=\"" + paint + "\" stroke-width=\"10\" opacity=\"0.3\"")
                  : line(entry.x, y, entry.x + 22.0, y, "stroke=\"" + paint + "\" stroke-width=\"2.5\"");
      svg_ += svg_text(entry.x + 28.0, entry.y, "start", entry.name);
    }
  }

  struct LegendEntry {
    std::string_view name;
    std::string_view colour;
    bool area = false;
    double x = 0.0;
    double y = 0.0;
    double width() const { return text_width(name, kFontSize) + 30.0; }
  };

  const Plot& plot_;
  bool drew_ = false;  ///< any curve or band
  std::vector<LegendEntry> legend_;
  std::vector<LineLabel> marker_labels_;
  std::vector<std::string_view> marker_texts_;
  std::vector<Eigen::AlignedBox2d> taken_;  ///< by text within the frame
  int legend_rows_ = 0;                     ///< of its own
  AxisTicks x_ticks_;
  AxisTicks y_ticks_;
  AxisScale x_;
  AxisScale y_;
  std::string svg_;
};

}  // namespace

PlotAxes plot_axes(const Plot& plot) {
  check_lengths(plot);
  return PlotDrawing(plot).axes();
}

std::string svg_plot(const Plot& plot) {
  check_lengths(plot);
  const std::string name = plot.title.empty() ? plot.y_label + " over " + plot.x_label : plot.title;
  return "<svg class=\"plot\" role=\"img\" aria-label=\"" + escape_html(name) + "\" viewBox=\"0 0 " +
         svg_number(plot.width) + " " + svg_number(plot.height) + "\" font-size=\"" + svg_number(kFontSize) +
         "\" fill=\"#3d464e\">\n" + PlotDrawing(plot).draw() + "</svg>\n";
}

std::string svg_plot_file(const Plot& plot) {
  constexpr std::string_view kBegin = "<svg ";
  std::string svg = svg_plot(plot);
  if (svg.starts_with(kBegin)) svg.insert(kBegin.size(), "xmlns=\"http://www.w3.org/2000/svg\" ");
  return svg;
}

}  // namespace spinaltap
