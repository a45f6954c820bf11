#pragma once

#include <Eigen/IterativeLinearSolvers>
#include <Eigen/SparseCholesky>
#include <Eigen/SparseCore>
#include <utility>
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
  void compute(const Eigen::SparseMatrix<double>& matrix) {
    factor_.compute(matrix);
    // The sums over pairs of parts: the lower triangle, which is all that its factor looks at.
    std::vector<double> within(static_cast<std::size_t>(count_), 0.0);
    std::vector<Eigen::Triplet<double>> entries;
    for (Eigen::Index column = 0; column < matrix.cols(); ++column) {
      for (Eigen::SparseMatrix<double>::InnerIterator it(matrix, column); it; ++it) {
        const int row_part = part_of(it.row()), column_part = part_of(column);
        if (row_part == column_part) within[static_cast<std::size_t>(row_part)] += it.value();
        if (row_part > column_part) entries.emplace_back(row_part, column_part, it.value());
      }
    }
    for (int part = 0; part < count_; ++part) entries.emplace_back(part, part, within[static_cast<std::size_t>(part)]);
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
