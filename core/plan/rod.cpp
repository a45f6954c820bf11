#include "core/plan/rod.h"

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <limits>

#include "core/base/error.h"
#include "core/base/text_fields.h"

namespace spinaltap {
namespace {

/// How far the middle of three heads is off the line through its neighbours.
double off_line_mm(const Vec3& above_mm, const Vec3& middle_mm, const Vec3& below_mm) {
  const Vec3 line = (below_mm - above_mm).normalized();
  const Vec3 from_mm = middle_mm - above_mm;
  return (from_mm - from_mm.dot(line) * line).norm();
}

}  // namespace

RodHead rod_head(const DrillPath& path, const std::string& level) {
  check_straight(path, "a rod");
  if (!head_of(path)) fail("rod: expected a screw with a head on path ", in_quotes(path.name));
  const double middle_mm = path.screw->length_mm + 0.5 * path.screw->head.length_mm;
  return {level, path.target_mm - middle_mm * path.direction(), -path.direction()};
}

double RodFit::max_offset_mm() const {
  return offset_mm.empty() ? 0.0 : *std::max_element(offset_mm.begin(), offset_mm.end());
}

RodFit fit_rod(std::span<const RodHead> heads) {
  constexpr double kApartMm = 1.0;
  if (heads.size() < 2) fail("rod: expected two heads or more, found ", heads.size());
  const Vec3& first_mm = heads.front().centre_mm;
  const Vec3 span_mm = heads.back().centre_mm - first_mm;
  if (!(span_mm.norm() > kApartMm)) fail("rod: expected heads that are apart, found ", span_mm.norm(), " mm");
  const Vec3 along = span_mm.normalized();
  const Vec3 u = any_perpendicular(along);
  const Vec3 v = along.cross(u);
  const auto count = static_cast<Eigen::Index>(heads.size());
  const Eigen::Index terms = std::min<Eigen::Index>(count, 3);
  Eigen::MatrixXd powers(count, terms);
  Eigen::MatrixXd aside(count, 2);
  for (Eigen::Index n = 0; n < count; ++n) {
    const Vec3 from_mm = heads[static_cast<std::size_t>(n)].centre_mm - first_mm;
    // In units of the span, so that the powers are alike.
    const double t = from_mm.dot(along) / span_mm.norm();
    for (Eigen::Index power = 0; power < terms; ++power) powers(n, power) = std::pow(t, static_cast<double>(power));
    aside.row(n) = Eigen::RowVector2d(from_mm.dot(u), from_mm.dot(v));
  }
  // Of three heads a curve of second order meets all: a rod is laid straight through those and bent by what they lack.
  const Eigen::MatrixXd curve = powers.colPivHouseholderQr().solve(aside);
  const Eigen::MatrixXd off = aside - powers * curve;
  RodFit fit;
  for (Eigen::Index n = 0; n < count; ++n) fit.offset_mm.push_back(off.row(n).norm());
  for (std::size_t n = 0; n + 1 < heads.size(); ++n) {
    fit.spacing_mm.push_back((heads[n + 1].centre_mm - heads[n].centre_mm).norm());
    fit.angle_deg.push_back(std::acos(std::clamp(heads[n].axis.dot(heads[n + 1].axis), -1.0, 1.0)) / kDegree);
  }
  fit.min_bend_radius_mm = std::numeric_limits<double>::infinity();
  if (terms < 3) return fit;
  // Of r(t) = (along * t, b t + c t^2): curvature |r' x r''| / |r'|^3, largest where the slope is least or at an end.
  const double length_mm = span_mm.norm();
  constexpr int kSteps = 100;
  for (int step = 0; step <= kSteps; ++step) {
    const double t = static_cast<double>(step) / kSteps;
    const Vec3 first(length_mm, curve(1, 0) + 2.0 * curve(2, 0) * t, curve(1, 1) + 2.0 * curve(2, 1) * t);
    const Vec3 second(0.0, 2.0 * curve(2, 0), 2.0 * curve(2, 1));
    const double bend = first.cross(second).norm();
    if (bend > 0.0) fit.min_bend_radius_mm = std::min(fit.min_bend_radius_mm, std::pow(first.norm(), 3.0) / bend);
  }
  return fit;
}

std::vector<std::size_t> choose_for_rod(std::span<const RodLevel> levels, double weight) {
  if (!(weight >= 0.0)) fail("rod: expected a weight from 0 on, found ", weight);
  std::vector<std::vector<Vec3>> heads_mm;
  for (const RodLevel& level : levels) {
    if (level.choices.empty()) fail("rod: expected a path for ", level.level, ", found none");
    heads_mm.emplace_back();
    for (const SuggestedPath* choice : level.choices) {
      heads_mm.back().push_back(rod_head(choice->path, level.level).centre_mm);
    }
  }
  const std::size_t count = levels.size();
  std::vector<std::size_t> chosen(count, 0);
  if (count < 3) return chosen;
  // best[n][a][b]: of levels 0 to n with choice a at n - 1 and b at n; from: the choice at n - 2.
  using Table = std::vector<std::vector<double>>;
  const auto score = [&](std::size_t level, std::size_t choice) { return levels[level].choices[choice]->score; };
  Table best(levels[0].choices.size(), std::vector<double>(levels[1].choices.size()));
  for (std::size_t a = 0; a < best.size(); ++a) {
    for (std::size_t b = 0; b < best[a].size(); ++b) best[a][b] = score(0, a) + score(1, b);
  }
  std::vector<std::vector<std::vector<std::size_t>>> from(count);
  for (std::size_t n = 2; n < count; ++n) {
    const std::size_t before = levels[n - 1].choices.size();
    const std::size_t here = levels[n].choices.size();
    Table next(before, std::vector<double>(here, -std::numeric_limits<double>::infinity()));
    from[n].assign(before, std::vector<std::size_t>(here, 0));
    for (std::size_t b = 0; b < before; ++b) {
      for (std::size_t c = 0; c < here; ++c) {
        for (std::size_t a = 0; a < best.size(); ++a) {
          const double off_mm = off_line_mm(heads_mm[n - 2][a], heads_mm[n - 1][b], heads_mm[n][c]);
          const double value = best[a][b] + score(n, c) - weight * off_mm;
          if (!(value > next[b][c])) continue;
          next[b][c] = value;
          from[n][b][c] = a;
        }
      }
    }
    best = std::move(next);
  }
  std::size_t b = 0, c = 0;
  for (std::size_t one = 0; one < best.size(); ++one) {
    for (std::size_t other = 0; other < best[one].size(); ++other) {
      if (best[one][other] > best[b][c]) {
        b = one;
        c = other;
      }
    }
  }
  for (std::size_t n = count - 1; n >= 2; --n) {
    chosen[n] = c;
    chosen[n - 1] = b;
    const std::size_t a = from[n][b][c];
    c = b;
    b = a;
    if (n == 2) chosen[0] = a;
  }
  return chosen;
}

}  // namespace spinaltap
