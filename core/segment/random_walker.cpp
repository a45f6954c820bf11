#include "core/segment/random_walker.h"

#include <Eigen/IterativeLinearSolvers>
#include <Eigen/SparseCore>

#include <algorithm>
#include <array>
#include <limits>

#include "core/base/error.h"

namespace spinaltap {
namespace {

/// Calls `visit(neighbour, axis)` for the face neighbours of voxel (i, j, k).
template <class Visit>
void for_neighbours(const GridGeometry& geometry, int i, int j, int k, const Visit& visit) {
  const std::size_t here = geometry.offset(i, j, k);
  const std::array<int, 3> index{i, j, k};
  const std::array<std::size_t, 3> stride{1, geometry.offset(0, 1, 0), geometry.offset(0, 0, 1)};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (index[axis] > 0) visit(here - stride[axis], axis);
    if (index[axis] + 1 < geometry.size[axis]) visit(here + stride[axis], axis);
  }
}

std::array<int, 3> index_of(const GridGeometry& geometry, std::size_t offset) {
  const auto columns = static_cast<std::size_t>(geometry.size[0]);
  const auto rows = static_cast<std::size_t>(geometry.size[1]);
  return {static_cast<int>(offset % columns), static_cast<int>(offset / columns % rows),
          static_cast<int>(offset / columns / rows)};
}

constexpr int kUnreached = -1;

/// Numbers the free voxels that a marker can be reached from, in the order of memory; the others are kUnreached. Those
/// without a way to a marker have no answer.
std::vector<int> number_nodes(std::span<const WalkerVoxel> voxels, const GridGeometry& geometry, int& count) {
  std::vector<int> node(voxels.size(), kUnreached);
  std::vector<std::size_t> open;
  for (std::size_t v = 0; v < voxels.size(); ++v) {
    if (voxels[v] == WalkerVoxel::kWanted || voxels[v] == WalkerVoxel::kOther) open.push_back(v);
  }
  while (!open.empty()) {
    const auto [i, j, k] = index_of(geometry, open.back());
    open.pop_back();
    for_neighbours(geometry, i, j, k, [&](std::size_t neighbour, std::size_t) {
      if (voxels[neighbour] != WalkerVoxel::kFree || node[neighbour] != kUnreached) return;
      node[neighbour] = 0;
      open.push_back(neighbour);
    });
  }
  count = 0;
  for (int& number : node) {
    if (number != kUnreached) number = count++;
  }
  return node;
}

}  // namespace

std::vector<float> walk_randomly(std::span<const WalkerVoxel> voxels, std::span<const float> conductivity,
                                 const GridGeometry& geometry, const Progress& progress) {
  if (voxels.size() != geometry.voxel_count() || conductivity.size() != voxels.size()) {
    fail("random walker: expected ", geometry.voxel_count(), " voxels, found ", voxels.size(), " and ",
         conductivity.size(), " conductivities");
  }
  progress.report("parting bones", 0.0);
  int count = 0;
  const std::vector<int> node = number_nodes(voxels, geometry, count);
  std::vector<float> probability(voxels.size(), 0.0F);
  for (std::size_t v = 0; v < voxels.size(); ++v) probability[v] = voxels[v] == WalkerVoxel::kWanted ? 1.0F : 0.0F;
  if (count == 0) return probability;

  const Vec3& step = geometry.spacing_mm;
  const Vec3 area_over_length = (step.prod() / step.array().square()).matrix();
  Eigen::SparseMatrix<double> laplacian(count, count);
  laplacian.reserve(Eigen::VectorXi::Constant(count, 4));
  Eigen::VectorXd from_markers = Eigen::VectorXd::Zero(count);
  Eigen::VectorXd guess = Eigen::VectorXd::Zero(count);
  for (std::size_t v = 0; v < voxels.size(); ++v) {
    if (node[v] == kUnreached) continue;
    const auto [i, j, k] = index_of(geometry, v);
    double sum = 0.0;
    // The lower triangle, column by column, the diagonal first.
    laplacian.insert(node[v], node[v]) = 0.0;
    for_neighbours(geometry, i, j, k, [&](std::size_t neighbour, std::size_t axis) {
      if (voxels[neighbour] == WalkerVoxel::kOutside) return;
      const double weight = static_cast<double>(std::min(conductivity[v], conductivity[neighbour])) *
                            area_over_length[static_cast<Eigen::Index>(axis)];
      sum += weight;
      if (node[neighbour] > node[v]) laplacian.insert(node[neighbour], node[v]) = -weight;
      if (voxels[neighbour] == WalkerVoxel::kWanted) from_markers[node[v]] += weight;
    });
    laplacian.coeffRef(node[v], node[v]) = sum;
  }
  laplacian.makeCompressed();
  progress.report("parting bones", 0.2);

  Eigen::ConjugateGradient<Eigen::SparseMatrix<double>, Eigen::Lower,
                           Eigen::IncompleteCholesky<double, Eigen::Lower, Eigen::NaturalOrdering<int>>>
      solver;
  solver.setTolerance(1e-5);
  solver.setMaxIterations(2000);
  solver.compute(laplacian);
  if (solver.info() != Eigen::Success) fail("random walker: the system has no Cholesky factor");
  const Eigen::VectorXd solution = solver.solve(from_markers);
  if (solver.info() != Eigen::Success) {
    fail("random walker: no solution within 1e-5 after ", solver.iterations(), " steps, residual ", solver.error());
  }
  for (std::size_t v = 0; v < voxels.size(); ++v) {
    if (node[v] != kUnreached) probability[v] = static_cast<float>(solution[node[v]]);
  }
  progress.report("parting bones", 1.0);
  return probability;
}

}  // namespace spinaltap
