#include "apps/report/curve_names.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "apps/report/label_place.h"

namespace spinaltap {
namespace {

using Point = Eigen::Vector2d;
using Rectangle = Eigen::AlignedBox2d;

constexpr double kDense = 2.5;  ///< between points that stand for a curve, drawing units
constexpr double kAir = 2.0;    ///< around a name
constexpr double kBold = 1.15;  ///< bold text is so much wider

/// Points of the runs, no further from each other than kDense.
std::vector<Point> dense_points(const std::vector<PlotRun>& runs, const Rectangle& room) {
  std::vector<Point> points;
  for (const PlotRun& run : runs) {
    for (std::size_t n = 0; n < run.size(); ++n) {
      const Point from = n == 0 ? run[0] : run[n - 1];
      const int steps = std::max(1, static_cast<int>(std::ceil((run[n] - from).norm() / kDense)));
      for (int step = 1; step <= steps; ++step) {
        const Point p = from + (run[n] - from) * step / steps;
        if (room.contains(p)) points.push_back(p);
      }
    }
  }
  return points;
}

/// How far the nearest of the points is from the rectangle; infinite without any.
double distance_to(const std::vector<Point>& points, const Rectangle& rectangle) {
  double nearest = std::numeric_limits<double>::infinity();
  for (const Point& p : points) nearest = std::min(nearest, rectangle.squaredExteriorDistance(p));
  return std::sqrt(nearest);
}

/// Lines, which have no width, are overlapped too.
bool overlaps(const Rectangle& a, const Rectangle& b) {
  return (a.min().array() < b.max().array()).all() && (b.min().array() < a.max().array()).all();
}

class NamePlaces {
 public:
  NamePlaces(std::span<const NamedCurve> curves, const Rectangle& room, double font_size, std::vector<Rectangle> taken)
      : room_(room), font_size_(font_size), taken_(std::move(taken)) {
    for (const NamedCurve& curve : curves) points_.push_back(dense_points(curve.runs, room));
  }

  Rectangle place(const std::string& name, std::size_t curve) {
    Rectangle best;
    if (name.empty() || points_[curve].empty()) return best;
    const Point size(kBold * text_width(name, font_size_), 1.15 * font_size_);
    double best_cost = std::numeric_limits<double>::infinity();
    for (double y = room_.min().y() + kAir; y + size.y() + kAir <= room_.max().y(); y += 4.0) {
      for (double x = room_.min().x() + 2.0 * kAir; x + size.x() + 2.0 * kAir <= room_.max().x(); x += 9.0) {
        const Rectangle candidate(Point(x, y), Point(x, y) + size);
        const Rectangle airy(candidate.min() - Point(kAir, kAir), candidate.max() + Point(kAir, kAir));
        if (std::any_of(taken_.begin(), taken_.end(), [&](const Rectangle& one) { return overlaps(one, airy); })) {
          continue;
        }
        const double candidate_cost = cost(airy, curve, best_cost);
        if (candidate_cost < best_cost - 1e-9) {
          best_cost = candidate_cost;
          best = candidate;
        }
      }
    }
    if (!best.isEmpty()) taken_.push_back(best);
    return best;
  }

 private:
  double cost(const Rectangle& airy, std::size_t curve, double limit) const {
    constexpr double kOnACurve = 1000.0;
    const double own = distance_to(points_[curve], airy);
    double sum = own > 0.0 ? own : kOnACurve;
    for (std::size_t n = 0; n < points_.size() && sum < limit; ++n) {
      if (n == curve || points_[n].empty()) continue;
      const double other = distance_to(points_[n], airy);
      if (!(other > 0.0)) sum += kOnACurve;
      // A name that is as near to another curve could be that one's.
      sum += 3.0 * std::max(0.0, own + 8.0 - other);
    }
    return sum;
  }

  Rectangle room_;
  double font_size_;
  std::vector<Rectangle> taken_;
  std::vector<std::vector<Point>> points_;
};

struct Extent {
  double low, high;
};
Extent extent_of(const LineLabel& label, double gap) {
  return label.is_left ? Extent{label.x - label.width - 2.0 * gap, label.x}
                       : Extent{label.x, label.x + label.width + 2.0 * gap};
}

/// Whether one's text lies on the other's, or on the other's line below its label.
bool is_in_the_way(const LineLabel& a, const LineLabel& b, double gap) {
  const Extent ea = extent_of(a, gap), eb = extent_of(b, gap);
  if (a.row == b.row) return ea.low < eb.high && eb.low < ea.high;
  const LineLabel& low = a.row < b.row ? a : b;
  const LineLabel& high = a.row < b.row ? b : a;
  const Extent lower = extent_of(low, gap);
  return high.x > lower.low + 1e-9 && high.x < lower.high - 1e-9;
}

}  // namespace

std::vector<Rectangle> place_curve_names(std::span<const NamedCurve> curves, const Rectangle& room, double font_size,
                                         std::vector<Rectangle> taken) {
  NamePlaces places(curves, room, font_size, std::move(taken));
  std::vector<Rectangle> found;
  for (std::size_t n = 0; n < curves.size(); ++n) found.push_back(places.place(curves[n].name, n));
  return found;
}

std::vector<PlotRun> cut_to_heights(const std::vector<PlotRun>& runs, double y_min, double y_max) {
  std::vector<PlotRun> parts;
  for (const PlotRun& run : runs) {
    PlotRun part;
    const auto flush = [&] {
      if (!part.empty()) parts.push_back(std::move(part));
      part.clear();
    };
    for (std::size_t n = 0; n < run.size(); ++n) {
      const Point& to = run[n];
      const Point& from = n == 0 ? to : run[n - 1];
      // Where the segment goes in and out, as shares of its way.
      double in = 0.0;
      double out = 1.0;
      const double rise = to.y() - from.y();
      for (const double sign : {1.0, -1.0}) {
        const double limit = sign > 0.0 ? y_max : -y_min;
        const double begin = sign * from.y() - limit;
        const double slope = sign * rise;
        if (slope == 0.0) {
          if (begin > 0.0) out = -1.0;
        } else if (slope > 0.0) {
          out = std::min(out, -begin / slope);
        } else {
          in = std::max(in, -begin / slope);
        }
      }
      if (in > out) {
        flush();
        continue;
      }
      if (n == 0 || in > 0.0) {
        flush();
        part.push_back(in > 0.0 ? Point(from + in * (to - from)) : from);
      }
      if (n > 0) part.push_back(out < 1.0 ? Point(from + out * (to - from)) : to);
      if (out < 1.0) flush();
    }
    flush();
  }
  return parts;
}

void lay_out_line_labels(std::span<LineLabel> labels, double end, double gap) {
  for (LineLabel& label : labels) label.is_left = label.x + label.width + 2.0 * gap > end;
  std::vector<std::size_t> order(labels.size());
  std::iota(order.begin(), order.end(), 0U);
  // A label lies above those whose lines it would cover: of those to the right of their lines the leftmost is highest,
  // of the others the rightmost.
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    if (labels[a].is_left != labels[b].is_left) return labels[b].is_left;
    return labels[a].is_left ? labels[a].x < labels[b].x : labels[a].x > labels[b].x;
  });
  std::vector<const LineLabel*> placed;
  for (const std::size_t n : order) {
    LineLabel& label = labels[n];
    const auto is_free = [&] {
      return std::none_of(placed.begin(), placed.end(),
                          [&](const LineLabel* other) { return is_in_the_way(label, *other, gap); });
    };
    const int rows = static_cast<int>(labels.size());
    for (label.row = 0; label.row < rows && !is_free(); ++label.row) {
    }
    placed.push_back(&label);
  }
}

}  // namespace spinaltap
