#include "apps/report/bone_outline.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>

#include "core/anatomy/bone_shape.h"

namespace spinaltap {
namespace {

using Point = Eigen::Vector2d;

constexpr double kStepMm = 0.25;
constexpr int kMaxNodes = 2048;  // a side: coarser steps beyond 0.5 m
constexpr double kThinnedMm = 0.02;

/// Distances at the nodes of a lattice over a picture, row by row.
struct DistanceSheet {
  int columns = 0;
  int rows = 0;
  double step_x = 1.0;  ///< pixels
  double step_y = 1.0;
  std::vector<float> mm;

  float at(int i, int j) const {
    return mm[static_cast<std::size_t>(j) * static_cast<std::size_t>(columns) + static_cast<std::size_t>(i)];
  }
  Point pixel(double i, double j) const { return {i * step_x - 0.5, j * step_y - 0.5}; }
};

DistanceSheet sample_sheet(const OutlinedBone& bone, const SliceFrame& frame) {
  const auto nodes = [&](int pixels) {
    return std::clamp(static_cast<int>(std::ceil(pixels * frame.pixel_mm / kStepMm)) + 1, 2, kMaxNodes);
  };
  DistanceSheet sheet;
  sheet.columns = nodes(frame.width);
  sheet.rows = nodes(frame.height);
  sheet.step_x = static_cast<double>(frame.width) / (sheet.columns - 1);
  sheet.step_y = static_cast<double>(frame.height) / (sheet.rows - 1);
  const auto width = static_cast<std::size_t>(sheet.columns);
  sheet.mm.resize(width * static_cast<std::size_t>(sheet.rows));
  tbb::parallel_for(0, sheet.rows, [&](int j) {
    std::vector<Vec3> places(width);
    for (int i = 0; i < sheet.columns; ++i) {
      const Point p = sheet.pixel(i, j);
      places[static_cast<std::size_t>(i)] = frame.to_patient(Vec3(p.x(), p.y(), 0.0));
    }
    bone.distance(places, std::span(sheet.mm).subspan(static_cast<std::size_t>(j) * width, width));
  });
  return sheet;
}

/// Marching squares (Lorensen & Cline 1987 in the plane): a saddle is parted by its mean.
class SquareMarch {
 public:
  explicit SquareMarch(const DistanceSheet& sheet) : sheet_(sheet) {
    const std::size_t edges = 2 * sheet.mm.size();
    links_.assign(edges, {kNone, kNone});
    for (int j = 0; j + 1 < sheet.rows; ++j) {
      for (int i = 0; i + 1 < sheet.columns; ++i) add_cell(i, j);
    }
  }

  std::vector<OutlineRun> take_runs() {
    std::vector<OutlineRun> runs;
    // Runs that end at the border first; what is left are rings.
    for (const bool open : {true, false}) {
      for (std::size_t edge = 0; edge < links_.size(); ++edge) {
        const bool is_end = links_[edge][0] != kNone && links_[edge][1] == kNone;
        if (links_[edge][0] == kNone || (open && !is_end)) continue;
        runs.push_back({follow(edge), !open, false});
      }
    }
    return runs;
  }

 private:
  static constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();

  /// Edge from node (i, j) to the next column, or to the next row.
  std::uint32_t edge(int i, int j, bool down) const {
    return 2 * static_cast<std::uint32_t>(j * sheet_.columns + i) + (down ? 1 : 0);
  }

  void add_cell(int i, int j) {
    const std::array<float, 4> d{sheet_.at(i, j), sheet_.at(i + 1, j), sheet_.at(i + 1, j + 1), sheet_.at(i, j + 1)};
    const std::array<std::uint32_t, 4> edges{edge(i, j, false), edge(i + 1, j, true), edge(i, j + 1, false),
                                             edge(i, j, true)};
    std::array<std::size_t, 4> crossed{};
    std::size_t count = 0;
    for (std::size_t n = 0; n < 4; ++n) {
      if ((d[n] < 0.0F) != (d[(n + 1) % 4] < 0.0F)) crossed[count++] = n;
    }
    if (count == 2) link(edges[crossed[0]], edges[crossed[1]]);
    if (count != 4) return;
    // All four sides are crossed: corners 0 and 2 are alike. Where the middle is as they are, the others are cut off.
    const bool joins_first = (d[0] + d[1] + d[2] + d[3] < 0.0F) == (d[0] < 0.0F);
    link(edges[0], edges[joins_first ? 1 : 3]);
    link(edges[2], edges[joins_first ? 3 : 1]);
  }

  void link(std::uint32_t a, std::uint32_t b) {
    links_[a][links_[a][0] == kNone ? 0 : 1] = b;
    links_[b][links_[b][0] == kNone ? 0 : 1] = a;
  }

  Point place(std::uint32_t edge) const {
    const auto node = static_cast<int>(edge / 2);
    const int i = node % sheet_.columns;
    const int j = node / sheet_.columns;
    const bool down = (edge & 1U) != 0;
    const double here = sheet_.at(i, j);
    const double there = down ? sheet_.at(i, j + 1) : sheet_.at(i + 1, j);
    const double share = here / (here - there);
    return down ? sheet_.pixel(i, j + share) : sheet_.pixel(i + share, j);
  }

  PixelPolygon follow(std::size_t begin) {
    PixelPolygon points;
    auto at = static_cast<std::uint32_t>(begin);
    while (at != kNone) {
      points.push_back(place(at));
      const std::array<std::uint32_t, 2> next = links_[at];
      links_[at] = {kNone, kNone};
      at = kNone;
      for (const std::uint32_t one : next) {
        if (one != kNone && links_[one][0] != kNone) at = one;
      }
    }
    return points;
  }

  const DistanceSheet& sheet_;
  std::vector<std::array<std::uint32_t, 2>> links_;  ///< by edge: the edges that its crossing goes on to
};

/// Douglas & Peucker 1973: marks what is kept between two kept points.
void thin(const PixelPolygon& points, std::size_t first, std::size_t last, double tolerance,
          std::vector<std::uint8_t>& kept) {
  std::vector<std::pair<std::size_t, std::size_t>> left{{first, last}};
  while (!left.empty()) {
    const auto [a, b] = left.back();
    left.pop_back();
    const Point way = points[b] - points[a];
    const double length_squared = way.squaredNorm();
    double furthest = tolerance;
    std::size_t at = 0;
    for (std::size_t n = a + 1; n < b; ++n) {
      const Point offset = points[n] - points[a];
      const double share = length_squared > 0.0 ? std::clamp(offset.dot(way) / length_squared, 0.0, 1.0) : 0.0;
      const double off = (offset - share * way).norm();
      if (off > furthest) {
        furthest = off;
        at = n;
      }
    }
    if (at == 0) continue;
    kept[at] = 1;
    left.emplace_back(a, at);
    left.emplace_back(at, b);
  }
}

PixelPolygon thinned_outline(const PixelPolygon& points, double tolerance) {
  if (points.size() < 3) return points;
  std::vector<std::uint8_t> kept(points.size(), 0);
  const std::size_t middle = points.size() / 2;  // of a ring, whose ends are neighbours
  for (const std::size_t n : {std::size_t{0}, middle, points.size() - 1}) kept[n] = 1;
  thin(points, 0, middle, tolerance, kept);
  thin(points, middle, points.size() - 1, tolerance, kept);
  PixelPolygon left;
  for (std::size_t n = 0; n < points.size(); ++n) {
    if (kept[n] != 0) left.push_back(points[n]);
  }
  return left;
}

/// Parts a run where the canal's wall begins and ends; each part goes on to the first point of the next.
void append_parts(const OutlineRun& run, const OutlinedBone& bone, const SliceFrame& frame,
                  std::vector<OutlineRun>& parts) {
  const std::size_t count = run.points.size();
  std::vector<std::uint8_t> is_canal(count, 0);
  for (std::size_t n = 0; n < count; ++n) {
    const Point& p = run.points[n];
    is_canal[n] = bone.is_canal_wall(frame.to_patient(Vec3(p.x(), p.y(), 0.0))) ? 1 : 0;
  }
  std::size_t begin = 0;
  if (run.is_closed) {  // begins where one goes over into the other
    while (begin < count && is_canal[begin] == is_canal[(begin + count - 1) % count]) ++begin;
  }
  if (std::all_of(is_canal.begin(), is_canal.end(), [&](std::uint8_t one) { return one == is_canal[0]; })) {
    parts.push_back({run.points, run.is_closed, is_canal[0] != 0});
    return;
  }
  const std::size_t steps = run.is_closed ? count : count - 1;
  OutlineRun part{{run.points[begin]}, false, is_canal[begin] != 0};
  for (std::size_t n = 1; n <= steps; ++n) {
    const std::size_t at = (begin + n) % count;
    part.points.push_back(run.points[at]);
    if ((is_canal[at] != 0) == part.is_canal) continue;
    parts.push_back(part);
    part = {{run.points[at]}, false, is_canal[at] != 0};
  }
  if (part.points.size() > 1) parts.push_back(part);
}

}  // namespace

OutlinedBone outlined(const Bone& bone) {
  OutlinedBone drawn;
  drawn.distance = [bone](std::span<const Vec3> places_mm, std::span<float> distances_mm) {
    bone.model().sample(places_mm, distances_mm, {});
  };
  if (bone.no_landmarks().empty()) {
    drawn.is_canal_wall = [bone](const Vec3& p_mm) {
      return bone.landmarks().is_canal_wall[bone.shape().nearest(p_mm).index] != 0;
    };
  }
  return drawn;
}

std::vector<OutlineRun> bone_outline(const OutlinedBone& bone, const SliceFrame& frame) {
  const DistanceSheet sheet = sample_sheet(bone, frame);
  const double tolerance = kThinnedMm / frame.pixel_mm;
  std::vector<OutlineRun> parts;
  for (const OutlineRun& run : SquareMarch(sheet).take_runs()) {
    if (bone.is_canal_wall) {
      append_parts(run, bone, frame, parts);
    } else {
      parts.push_back(run);
    }
  }
  for (OutlineRun& part : parts) part.points = thinned_outline(part.points, tolerance);
  return parts;
}

}  // namespace spinaltap
