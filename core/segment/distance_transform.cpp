#include "core/segment/distance_transform.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/base/error.h"

namespace spinaltap {
namespace {

constexpr float kEndless = std::numeric_limits<float>::infinity();

/// Work space for one line: the lower envelope of parabolas.
struct Envelope {
  std::vector<double> value;   // of the line
  std::vector<double> border;  // parabola p is lowest from border[p] to border[p + 1]
  std::vector<int> apex;

  explicit Envelope(int length)
      : value(static_cast<std::size_t>(length)),
        border(static_cast<std::size_t>(length) + 1),
        apex(static_cast<std::size_t>(length)) {}
};

/// min over q of (step * (p - q))^2 + line[q], for each p.
void transform_line(float* line, std::size_t stride, int length, double step_mm, Envelope& envelope) {
  const double step_squared = step_mm * step_mm;
  std::size_t count = 0;
  for (int q = 0; q < length; ++q) {
    const auto at = static_cast<std::size_t>(q);
    envelope.value[at] = static_cast<double>(line[at * stride]);
    if (line[at * stride] == kEndless) continue;
    double meet = -std::numeric_limits<double>::infinity();
    while (count > 0) {
      const int r = envelope.apex[count - 1];
      meet = (envelope.value[at] - envelope.value[static_cast<std::size_t>(r)]) / (2.0 * step_squared * (q - r)) +
             0.5 * (q + r);
      if (meet > envelope.border[count - 1]) break;
      --count;
    }
    envelope.apex[count] = q;
    envelope.border[count] = count == 0 ? -std::numeric_limits<double>::infinity() : meet;
    ++count;
  }
  if (count == 0) return;
  envelope.border[count] = std::numeric_limits<double>::infinity();
  std::size_t lowest = 0;
  for (int p = 0; p < length; ++p) {
    while (envelope.border[lowest + 1] < p) ++lowest;
    const double way = p - envelope.apex[lowest];
    line[static_cast<std::size_t>(p) * stride] =
        static_cast<float>(step_squared * way * way + envelope.value[static_cast<std::size_t>(envelope.apex[lowest])]);
  }
}

/// Squares of 0, 1, ... steps of a row of `length`, up to `most`.
std::vector<float> squared_ways(int length, double step_mm, float most) {
  std::vector<float> squares;
  for (int n = 0; n < length; ++n) {
    const auto square = static_cast<float>(step_mm * step_mm * n * n);
    if (square > most) break;
    squares.push_back(square);
  }
  return squares;
}

/// Distances along i, from both ends.
void sweep_row(std::span<const std::uint8_t> target, std::span<float> distance, const std::vector<float>& squares) {
  const auto none = squares.size();
  std::vector<std::size_t> way(target.size(), none);
  std::size_t since = none;
  const auto step = [&](std::size_t i) {
    since = target[i] != 0 ? 0 : std::min(since + 1, none);
    way[i] = std::min(way[i], since);
  };
  for (std::size_t i = 0; i < target.size(); ++i) step(i);
  since = none;
  for (std::size_t i = target.size(); i-- > 0;) step(i);
  for (std::size_t i = 0; i < target.size(); ++i) distance[i] = way[i] < none ? squares[way[i]] : kEndless;
}

/// Rows of values, and whether any of each is finite.
struct Rows {
  std::vector<float> values;
  std::vector<std::uint8_t> has_any;
  std::size_t length;

  std::span<float> row(std::size_t n) { return std::span(values).subspan(n * length, length); }
  void look_at(std::size_t n) {
    has_any[n] = std::any_of(row(n).begin(), row(n).end(), [](float value) { return value < kEndless; }) ? 1 : 0;
  }
};

}  // namespace

std::vector<float> squared_distance_to(std::span<const std::uint8_t> target, const GridGeometry& geometry) {
  std::vector<float> distance(target.size());
  for (std::size_t i = 0; i < target.size(); ++i) distance[i] = target[i] != 0 ? 0.0F : kEndless;
  const auto& size = geometry.size;
  const auto transform_axis = [&](int axis, int outer_axis, int inner_axis) {
    const auto length = size[static_cast<std::size_t>(axis)];
    tbb::parallel_for(0, size[static_cast<std::size_t>(outer_axis)], [&](int outer) {
      Envelope envelope(length);
      for (int inner = 0; inner < size[static_cast<std::size_t>(inner_axis)]; ++inner) {
        std::array<int, 3> first{0, 0, 0};
        first[static_cast<std::size_t>(outer_axis)] = outer;
        first[static_cast<std::size_t>(inner_axis)] = inner;
        std::array<int, 3> second = first;
        second[static_cast<std::size_t>(axis)] = 1;
        const std::size_t start = geometry.offset(first[0], first[1], first[2]);
        const std::size_t stride = geometry.offset(second[0], second[1], second[2]) - start;
        transform_line(distance.data() + start, stride, length, geometry.spacing_mm[axis], envelope);
      }
    });
  };
  transform_axis(0, 2, 1);
  transform_axis(1, 2, 0);
  transform_axis(2, 1, 0);
  return distance;
}

std::vector<float> squared_distance_within(std::span<const std::uint8_t> target, const GridGeometry& geometry,
                                           double reach_mm) {
  if (!(reach_mm >= 0.0)) fail("distances: expected a reach of 0 mm or more, found ", reach_mm, " mm");
  const std::array<std::size_t, 3> size{static_cast<std::size_t>(geometry.size[0]),
                                        static_cast<std::size_t>(geometry.size[1]),
                                        static_cast<std::size_t>(geometry.size[2])};
  const std::size_t rows = size[1] * size[2];
  const auto most = static_cast<float>(reach_mm * reach_mm);
  Rows from{std::vector<float>(target.size()), std::vector<std::uint8_t>(rows), size[0]};
  const std::vector<float> along_i = squared_ways(geometry.size[0], geometry.spacing_mm.x(), most);
  tbb::parallel_for(std::size_t{0}, rows, [&](std::size_t row) {
    sweep_row(target.subspan(row * size[0], size[0]), from.row(row), along_i);
    from.look_at(row);
  });
  // Along j, then along k: each row is the least of the rows within reach, each with its square added.
  Rows to = from;
  for (const std::size_t axis : {std::size_t{1}, std::size_t{2}}) {
    const std::vector<float> squares =
        squared_ways(geometry.size[axis], geometry.spacing_mm[static_cast<Eigen::Index>(axis)], most);
    const std::size_t stride = axis == 1 ? 1 : size[1];
    tbb::parallel_for(std::size_t{0}, rows, [&](std::size_t row) {
      const std::size_t at = axis == 1 ? row % size[1] : row / size[1];
      const std::span<float> least = to.row(row);
      const auto take = [&](std::size_t other, float square) {
        if (from.has_any[other] == 0) return;
        const std::span<const float> values = from.row(other);
        for (std::size_t i = 0; i < values.size(); ++i) least[i] = std::min(least[i], values[i] + square);
      };
      std::copy(from.row(row).begin(), from.row(row).end(), least.begin());
      for (std::size_t n = 1; n < squares.size(); ++n) {
        if (n <= at) take(row - n * stride, squares[n]);
        if (at + n < size[axis]) take(row + n * stride, squares[n]);
      }
      to.look_at(row);
    });
    std::swap(from, to);
  }
  for (float& value : from.values) value = value <= most ? value : kEndless;
  return std::move(from.values);
}

}  // namespace spinaltap
