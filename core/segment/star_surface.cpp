#include "core/segment/star_surface.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/base/error.h"

namespace spinaltap {
namespace {

/// Directions within this many times their mean spacing are neighbours: six for most.
constexpr double kNeighbourReach = 1.45;

/// Fibonacci's lattice: even, and in order of falling z.
std::vector<Vec3> even_directions(int count) {
  std::vector<Vec3> directions;
  for (int i = 0; i < count; ++i) {
    const double z = 1.0 - (2.0 * i + 1.0) / count;
    const double turn = 2.0 * std::numbers::pi * i / std::numbers::phi;
    const double r = std::sqrt(1.0 - z * z);
    directions.emplace_back(r * std::cos(turn), r * std::sin(turn), z);
  }
  return directions;
}

/// Indices of the directions whose z may be within `reach_rad` of z.
std::pair<int, int> band(double z, double reach_rad, int count) {
  const auto index = [&](double at) { return std::clamp(static_cast<int>(0.5 * count * (1.0 - at)), 0, count - 1); };
  return {index(z + reach_rad), index(z - reach_rad)};
}

Eigen::Array3i cell_at(const Vec3& p, int cells_a_side) {
  return (0.5 * cells_a_side * (p.array() + 1.0)).floor().cast<int>().max(0).min(cells_a_side - 1);
}

std::size_t cell_number(int x, int y, int z, int cells_a_side) {
  const auto side = static_cast<std::size_t>(cells_a_side);
  return (static_cast<std::size_t>(z) * side + static_cast<std::size_t>(y)) * side + static_cast<std::size_t>(x);
}

/// Calls `visit(cell)` for the cells that a point within `reach` of p may lie in, and a few more.
template <class Visit>
void for_cells_near(const Vec3& p, double reach, int cells_a_side, const Visit& visit) {
  const Eigen::Array3i low = cell_at(p - Vec3::Constant(reach), cells_a_side);
  const Eigen::Array3i high = cell_at(p + Vec3::Constant(reach), cells_a_side);
  for (int z = low.z(); z <= high.z(); ++z) {
    for (int y = low.y(); y <= high.y(); ++y) {
      for (int x = low.x(); x <= high.x(); ++x) visit(cell_number(x, y, z, cells_a_side));
    }
  }
}

}  // namespace

StarSurface::StarSurface(const Vec3& centre_mm, int direction_count) : centre_mm_(centre_mm) {
  if (direction_count < 100) fail("star surface: expected at least 100 directions, found ", direction_count);
  directions_ = even_directions(direction_count);
  spacing_rad_ = std::sqrt(4.0 * std::numbers::pi / direction_count);
  radii_mm_.assign(directions_.size(), 0.0);
  neighbours_.resize(directions_.size());
  const double reach_rad = kNeighbourReach * spacing_rad_;
  for (int i = 0; i < direction_count; ++i) {
    const Vec3& here = directions_[static_cast<std::size_t>(i)];
    const auto [first, last] = band(here.z(), reach_rad, direction_count);
    for (int j = first; j <= last; ++j) {
      if (j != i && (directions_[static_cast<std::size_t>(j)] - here).norm() < reach_rad) {
        neighbours_[static_cast<std::size_t>(i)].push_back(j);
      }
    }
  }
  cells_a_side_ = std::max(1, static_cast<int>(2.0 / reach_rad));
  const auto cells = static_cast<std::size_t>(cells_a_side_) * static_cast<std::size_t>(cells_a_side_) *
                     static_cast<std::size_t>(cells_a_side_);
  std::vector<std::vector<int>> near(cells);
  for (int i = 0; i < direction_count; ++i) {
    for_cells_near(directions_[static_cast<std::size_t>(i)], reach_rad, cells_a_side_,
                   [&](std::size_t cell) { near[cell].push_back(i); });
  }
  cell_begin_.push_back(0);
  for (const std::vector<int>& cell : near) {
    in_cells_.insert(in_cells_.end(), cell.begin(), cell.end());
    cell_begin_.push_back(static_cast<std::uint32_t>(in_cells_.size()));
  }
}

std::size_t StarSurface::cell_of(const Vec3& direction) const {
  const Eigen::Array3i cell = cell_at(direction, cells_a_side_);
  return cell_number(cell.x(), cell.y(), cell.z(), cells_a_side_);
}

double StarSurface::radius_towards_mm(const Vec3& direction) const {
  const double reach_rad = kNeighbourReach * spacing_rad_;
  const std::size_t cell = cell_of(direction);
  double sum = 0.0;
  double weights = 0.0;
  for (std::uint32_t n = cell_begin_[cell]; n < cell_begin_[cell + 1]; ++n) {
    const auto at = static_cast<std::size_t>(in_cells_[n]);
    const double share = 1.0 - (directions_[at] - direction).squaredNorm() / (reach_rad * reach_rad);
    if (share <= 0.0) continue;
    sum += share * share * radii_mm_[at];
    weights += share * share;
  }
  return weights > 0.0 ? sum / weights : 0.0;
}

double StarSurface::depth_mm(const Vec3& p_patient) const {
  const Vec3 way = p_patient - centre_mm_;
  const double length = way.norm();
  return radius_towards_mm(length > 0.0 ? Vec3(way / length) : Vec3(Vec3::UnitX())) - length;
}

double StarSurface::volume_mm3() const {
  double sum = 0.0;
  for (const double r : radii_mm_) sum += r * r * r;
  return sum * 4.0 * std::numbers::pi / (3.0 * static_cast<double>(radii_mm_.size()));
}

double StarSurface::largest_radius_mm() const { return *std::max_element(radii_mm_.begin(), radii_mm_.end()); }

std::vector<int> choose_steps(const StarSurface& surface, const StarCost& cost, int rounds) {
  const auto& neighbours = surface.neighbours();
  const std::size_t count = neighbours.size();
  const auto steps = static_cast<std::size_t>(cost.step_count);
  if (steps < 1) fail("star surface: expected at least one radius to choose from");
  std::vector<double> data(count * steps);
  tbb::parallel_for(std::size_t{0}, count, [&](std::size_t i) {
    for (std::size_t s = 0; s < steps; ++s) {
      data[i * steps + s] = cost.cost(static_cast<int>(i), static_cast<int>(s));
    }
  });
  // Messages lie with their receiver; `back[e]` is the edge that runs the other way.
  std::vector<std::size_t> start(count + 1, 0);
  for (std::size_t i = 0; i < count; ++i) start[i + 1] = start[i] + neighbours[i].size();
  std::vector<std::size_t> back(start[count]);
  for (std::size_t i = 0; i < count; ++i) {
    for (std::size_t n = 0; n < neighbours[i].size(); ++n) {
      const auto j = static_cast<std::size_t>(neighbours[i][n]);
      const auto place = std::find(neighbours[j].begin(), neighbours[j].end(), static_cast<int>(i));
      back[start[i] + n] = start[j] + static_cast<std::size_t>(place - neighbours[j].begin());
    }
  }
  std::vector<double> messages(start[count] * steps, 0.0);
  std::vector<double> sent(messages.size());
  const auto belief = [&](std::size_t i, std::vector<double>& sum) {
    sum.assign(data.begin() + static_cast<std::ptrdiff_t>(i * steps),
               data.begin() + static_cast<std::ptrdiff_t>((i + 1) * steps));
    for (std::size_t e = start[i]; e < start[i + 1]; ++e) {
      for (std::size_t s = 0; s < steps; ++s) sum[s] += messages[e * steps + s];
    }
  };
  for (int round = 0; round < rounds; ++round) {
    tbb::parallel_for(std::size_t{0}, count, [&](std::size_t i) {
      std::vector<double> sum;
      belief(i, sum);
      for (std::size_t e = start[i]; e < start[i + 1]; ++e) {
        double* out = sent.data() + back[e] * steps;
        for (std::size_t s = 0; s < steps; ++s) out[s] = sum[s] - messages[e * steps + s];
        const double min = *std::min_element(out, out + steps);
        for (std::size_t s = 1; s < steps; ++s) out[s] = std::min(out[s], out[s - 1] + cost.stiffness);
        for (std::size_t s = steps - 1; s > 0; --s) out[s - 1] = std::min(out[s - 1], out[s] + cost.stiffness);
        // Less its minimum, so that sums stay small.
        for (std::size_t s = 0; s < steps; ++s) {
          out[s] = std::min(out[s] - min, cost.stiffness * cost.max_difference);
        }
      }
    });
    messages.swap(sent);
  }
  std::vector<int> chosen(count);
  tbb::parallel_for(std::size_t{0}, count, [&](std::size_t i) {
    std::vector<double> sum;
    belief(i, sum);
    chosen[i] = static_cast<int>(std::min_element(sum.begin(), sum.end()) - sum.begin());
  });
  return chosen;
}

}  // namespace spinaltap
