#pragma once

#include <Eigen/IterativeLinearSolvers>
#include <Eigen/SparseCholesky>
#include <Eigen/SparseCore>
#include <vector>

namespace spinaltap {

/// Preconditioner of Eigen's conjugate gradients for a matrix that conducts well within parts and badly between them:
/// its incomplete Cholesky factor, and a correction that is constant on each part, solved exactly (Nicolaides 1987).
/// What flows slowly through the whole, for which the factor alone takes hundreds of steps, is the correction's.
class CoarseCorrection {
 public:
  /// The part of each unknown, 0 to `count` - 1; said before the matrix is.
  void set_parts(std::vector<int> part, int count) {
    part_ = std::move(part);
    count_ = count;
  }

  /// Of a symmetric matrix, stored whole.
  void compute(const Eigen::SparseMatrix<double, Eigen::RowMajor>& matrix) {
    factor_.compute(Eigen::SparseMatrix<double>(matrix));
    std::vector<Eigen::Triplet<double>> entries;
    entries.reserve(static_cast<std::size_t>(matrix.nonZeros()));
    for (Eigen::Index row = 0; row < matrix.outerSize(); ++row) {
      for (Eigen::SparseMatrix<double, Eigen::RowMajor>::InnerIterator it(matrix, row); it; ++it) {
        entries.emplace_back(part_of(it.row()), part_of(it.col()), it.value());
      }
    }
    Eigen::SparseMatrix<double> coarse(count_, count_);
    coarse.setFromTriplets(entries.begin(), entries.end());
    coarse_.compute(coarse);
  }

  Eigen::ComputationInfo info() const { return factor_.info() == Eigen::Success ? coarse_.info() : factor_.info(); }

  Eigen::VectorXd solve(const Eigen::VectorXd& residual) const {
    Eigen::VectorXd sums = Eigen::VectorXd::Zero(count_);
    for (Eigen::Index n = 0; n < residual.size(); ++n) sums[part_of(n)] += residual[n];
    const Eigen::VectorXd shift = coarse_.solve(sums);
    Eigen::VectorXd result = factor_.solve(residual);
    for (Eigen::Index n = 0; n < result.size(); ++n) result[n] += shift[part_of(n)];
    return result;
  }

 private:
  int part_of(Eigen::Index n) const { return part_[static_cast<std::size_t>(n)]; }

  std::vector<int> part_;
  int count_ = 0;
  Eigen::IncompleteCholesky<double, Eigen::Lower, Eigen::NaturalOrdering<int>> factor_;
  Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> coarse_;
};

}  // namespace spinaltap
