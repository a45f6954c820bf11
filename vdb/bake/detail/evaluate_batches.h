#pragma once

#include <tbb/parallel_for.h>

#include <algorithm>
#include <string_view>
#include <vector>

#include "core/base/progress.h"
#include "core/base/scalar_field.h"

namespace spinaltap::detail {

/// Evaluates a field with its gradient at `count` points, place_mm(i), and calls visit(i, value_mm, gradient) for each,
/// from many threads at once. Fields sort their points: the more of them at once, the better.
template <class Place, class Visit>
void evaluate_batches(const ScalarField& field, std::size_t count, std::string_view stage, const Progress& progress,
                      const Place& place_mm, const Visit& visit) {
  constexpr std::size_t kBatch = 1 << 14;
  const std::size_t batches = (count + kBatch - 1) / kBatch;
  ProgressCounter counter(progress, stage, batches);
  tbb::parallel_for(std::size_t{0}, batches, [&](std::size_t batch) {
    const std::size_t begin = batch * kBatch;
    const std::size_t size = std::min(kBatch, count - begin);
    std::vector<Vec3> points_mm(size);
    std::vector<double> values_mm(size);
    std::vector<Vec3> gradients(size);
    for (std::size_t i = 0; i < size; ++i) points_mm[i] = place_mm(begin + i);
    field.evaluate(points_mm, values_mm, gradients);
    for (std::size_t i = 0; i < size; ++i) visit(begin + i, values_mm[i], gradients[i]);
    counter.add();
  });
}

}  // namespace spinaltap::detail
