#include "core/segment/distance_transform.h"

#include <tbb/parallel_for.h>

#include <limits>

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

}  // namespace spinaltap
