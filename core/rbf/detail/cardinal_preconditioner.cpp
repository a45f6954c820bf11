#include "core/rbf/detail/cardinal_preconditioner.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

namespace spinaltap::detail {

CardinalPreconditioner::CardinalPreconditioner(RadialKernel kernel, std::span<const Vec3> points_mm,
                                               std::span<const double> smoothing_mm, CoarseToFine order,
                                               const SimdKernels& simd)
    : terms_(polynomial_terms(kernel)),
      sign_(definite_sign(kernel)),
      order_(std::move(order)),
      function_(points_mm.size() * (order_.neighbours + 1), 0.0F) {
  const int power = power_of(kernel);
  const std::size_t width = order_.neighbours + 1;
  const std::size_t total = points_mm.size();
  // Points with fewer neighbours than all others come alone, the rest in eights.
  struct Batch {
    std::size_t begin;
    std::size_t size;
  };
  std::vector<Batch> batches;
  for (std::size_t k = terms_; k < total;) {
    const std::size_t size = k < order_.neighbours ? 1 : std::min(kLanes, total - k);
    batches.push_back({k, size});
    k += size;
  }
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, batches.size(), 16), [&](const auto& range) {
    std::vector<double> points(3 * width * kLanes);
    std::vector<double> diagonal(width * kLanes);
    std::vector<double> out(width * kLanes);
    std::vector<double> work((terms_ * width + width * (width + 1) / 2) * kLanes);
    for (std::size_t b = range.begin(); b < range.end(); ++b) {
      const std::size_t near = order_.count(batches[b].begin);
      const std::size_t count = near + 1;
      std::array<double, kLanes> to_weight{};
      for (std::size_t lane = 0; lane < kLanes; ++lane) {
        const std::size_t k = batches[b].begin + std::min(lane, batches[b].size - 1);
        const Vec3& own = points_mm[order_.order[k]];
        const std::uint32_t* neighbours = order_.near.data() + k * order_.neighbours;
        double reach2 = 0.0;
        for (std::size_t i = 0; i < near; ++i) {
          reach2 = std::max(reach2, (points_mm[order_.order[neighbours[i]]] - own).squaredNorm());
        }
        const double per_mm = 1.0 / std::sqrt(reach2);
        const double per_phi = power == 1 ? per_mm : per_mm * per_mm * per_mm;
        to_weight[lane] = std::sqrt(per_phi);
        for (std::size_t i = 0; i < count; ++i) {
          const std::uint32_t index = i < near ? order_.order[neighbours[i]] : order_.order[k];
          const Vec3 d = (points_mm[index] - own) * per_mm;
          for (std::size_t axis = 0; axis < 3; ++axis) {
            points[(3 * i + axis) * kLanes + lane] = d[static_cast<Eigen::Index>(axis)];
          }
          diagonal[i * kLanes + lane] = smoothing_mm.empty() ? 0.0 : smoothing_mm[index] * per_phi;
        }
      }
      simd.local_functions(power, count, terms_, points.data(), diagonal.data(), work.data(), out.data());
      for (std::size_t lane = 0; lane < batches[b].size; ++lane) {
        float* function = function_.data() + (batches[b].begin + lane) * width;
        for (std::size_t i = 0; i < count; ++i) {
          function[i] = static_cast<float>(out[i * kLanes + lane] * to_weight[lane]);
        }
      }
    }
  });
}

void CardinalPreconditioner::apply(std::span<const double> in, std::span<double> out) const {
  const std::size_t total = in.size();
  const std::size_t width = order_.neighbours + 1;
  std::vector<double> placed(total);
  for (std::size_t k = 0; k < total; ++k) placed[k] = in[order_.order[k]];
  std::vector<double> share(total, 0.0);
  tbb::parallel_for(tbb::blocked_range<std::size_t>(terms_, std::max(terms_, total), 512), [&](const auto& range) {
    for (std::size_t k = range.begin(); k < range.end(); ++k) {
      const std::size_t near = order_.count(k);
      const float* function = function_.data() + k * width;
      const std::uint32_t* neighbours = order_.near.data() + k * order_.neighbours;
      double sum = static_cast<double>(function[near]) * placed[k];
      for (std::size_t i = 0; i < near; ++i) sum += static_cast<double>(function[i]) * placed[neighbours[i]];
      share[k] = sign_ * sum;
    }
  });
  std::fill(placed.begin(), placed.end(), 0.0);
  for (std::size_t k = terms_; k < total; ++k) {
    const std::size_t near = order_.count(k);
    const float* function = function_.data() + k * width;
    const std::uint32_t* neighbours = order_.near.data() + k * order_.neighbours;
    placed[k] += share[k] * static_cast<double>(function[near]);
    for (std::size_t i = 0; i < near; ++i) placed[neighbours[i]] += share[k] * static_cast<double>(function[i]);
  }
  for (std::size_t k = 0; k < total; ++k) out[order_.order[k]] = placed[k];
}

}  // namespace spinaltap::detail
