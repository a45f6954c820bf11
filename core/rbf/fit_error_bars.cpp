#include "core/rbf/fit_error_bars.h"

#include <algorithm>
#include <cmath>

#include "core/rbf/detail/choose_centres.h"
#include "core/rbf/detail/rbf_solver.h"
#include "core/rbf/rbf_field.h"

namespace spinaltap::detail {
namespace {

/// Where a point's value is held.
enum class Hold : std::uint8_t { free, low, middle, high };

/// The points that are held, and what they are held at.
class ActiveSet {
 public:
  ActiveSet(std::span<const double> values_mm, std::span<const double> error_bars_mm, std::size_t determining)
      : values_mm_(values_mm),
        error_bars_mm_(error_bars_mm),
        determining_(determining),
        hold_(values_mm.size(), Hold::free),
        freed_(values_mm.size(), 0) {}

  const std::vector<std::uint32_t>& members() const { return members_; }
  bool has(std::uint32_t i) const { return hold_[i] != Hold::free; }

  void add(std::uint32_t i, Hold hold) {
    members_.push_back(i);
    hold_[i] = hold;
  }

  std::vector<double> targets_mm() const {
    std::vector<double> targets_mm;
    targets_mm.reserve(members_.size());
    for (const std::uint32_t i : members_) {
      const double side = hold_[i] == Hold::high ? 1.0 : hold_[i] == Hold::low ? -1.0 : 0.0;
      targets_mm.push_back(values_mm_[i] + side * error_bars_mm_[i]);
    }
    return targets_mm;
  }

  /// Moves or frees the members whose weight pulls the wrong way; `rise` is the norm's derivative by each member's
  /// value. Frees none when `may_free` is not set. Returns how many changed; `weights` loses those of freed ones.
  std::size_t revise(const std::vector<double>& rise, bool may_free, std::vector<double>& weights) {
    // A point that comes and goes is kept in the end, so that the rounds end.
    constexpr int kMaxFreed = 3;
    std::size_t changed = 0;
    std::size_t kept = 0;
    for (std::size_t k = 0; k < members_.size(); ++k) {
      const std::uint32_t i = members_[k];
      if (k >= determining_ && error_bars_mm_[i] > 0.0) {
        const Hold wanted = rise[k] < 0.0 ? Hold::high : Hold::low;  // the norm would fall further that way
        if (hold_[i] == Hold::middle) {
          hold_[i] = wanted;
          ++changed;
        } else if (hold_[i] != wanted && may_free && freed_[i] < kMaxFreed) {
          hold_[i] = Hold::free;
          ++freed_[i];
          ++changed;
          continue;
        }
      }
      members_[kept] = i;
      weights[kept] = weights[k];
      ++kept;
    }
    members_.resize(kept);
    weights.resize(kept);
    return changed;
  }

 private:
  std::span<const double> values_mm_;
  std::span<const double> error_bars_mm_;
  std::size_t determining_;
  std::vector<Hold> hold_;
  std::vector<int> freed_;
  std::vector<std::uint32_t> members_;
};

}  // namespace

ReducedFit fit_error_bars(RadialKernel kernel, std::span<const Vec3> points_mm, std::span<const double> values_mm,
                          std::span<const double> error_bars_mm, double accuracy_mm, const Progress& progress) {
  constexpr int kFreeingRounds = 60;
  constexpr double kFieldShare = 0.1;
  const std::size_t count = points_mm.size();
  // d(norm)/d(value) is twice the weight where the kernel is positive definite, minus that where it is negative.
  const double sign = definite_sign(kernel);
  ActiveSet active(values_mm, error_bars_mm, polynomial_terms(kernel));
  for (const std::uint32_t i : first_centres(kernel, points_mm)) active.add(i, Hold::middle);

  ReducedFit fit;
  std::vector<double> found_mm(count);
  for (std::vector<double> weights;;) {
    ++fit.rounds;
    weights.resize(active.members().size(), 0.0);
    RbfSolver solver(kernel, pick(points_mm, active.members()));
    RbfSolution solution = solver.solve(active.targets_mm(), accuracy_mm, weights);
    fit.iterations += solution.iterations;
    fit.model = std::move(solution.model);
    fit.centres = active.members();
    weights = fit.model.weights;

    RbfField::for_values(fit.model, kFieldShare * accuracy_mm).evaluate(points_mm, found_mm, {});
    std::vector<double> beyond_mm(count);
    std::vector<std::uint32_t> out;
    for (std::uint32_t i = 0; i < count; ++i) {
      beyond_mm[i] = std::abs(found_mm[i] - values_mm[i]) - error_bars_mm[i];
      if (!active.has(i) && beyond_mm[i] > (1.0 - kFieldShare) * accuracy_mm) out.push_back(i);
    }
    std::stable_sort(out.begin(), out.end(),
                     [&](std::uint32_t a, std::uint32_t b) { return beyond_mm[a] > beyond_mm[b]; });
    std::vector<double> rise(weights.size());
    for (std::size_t k = 0; k < weights.size(); ++k) rise[k] = sign * weights[k];
    const std::size_t changed = active.revise(rise, fit.rounds <= kFreeingRounds, weights);
    progress.report("fitting within error bars",
                    1.0 - static_cast<double>(out.size() + changed) / static_cast<double>(count + 1));
    if (out.empty() && changed == 0) return fit;
    for (const std::uint32_t i : spread_worst(points_mm, out, fit.centres.size())) {
      active.add(i, found_mm[i] > values_mm[i] ? Hold::high : Hold::low);
    }
  }
}

}  // namespace spinaltap::detail
