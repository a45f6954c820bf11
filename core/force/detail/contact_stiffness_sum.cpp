#include "core/force/detail/contact_stiffness_sum.h"

#include <Eigen/Geometry>

namespace spinaltap {

void ContactStiffnessSum::add(const Vec3& from_tip_mm, const Vec3& direction, double stiff_n_mm,
                              double push_n) noexcept {
  const Vec3 lever = from_tip_mm.cross(direction);
  moment_n_mm_ += push_n * lever;
  const Vec3 stiff = stiff_n_mm * direction;
  ways_ += stiff * direction.transpose();
  mixed_ += stiff * lever.transpose();
  turns_ += stiff_n_mm * lever * lever.transpose();
}

ContactStiffness ContactStiffnessSum::in_patient(const PathFrame& frame, double factor) const noexcept {
  Mat3 turn;
  for (Eigen::Index n = 0; n < 3; ++n) turn.col(n) = frame.to_patient(Pose{Vec3::Zero(), Vec3::Unit(n)}).axis;
  ContactStiffness contact;
  contact.moment_n_mm = factor * (turn * moment_n_mm_);
  Eigen::Map<Eigen::Matrix<double, 6, 6, Eigen::RowMajor>> all(contact.stiffness.data());
  all.topLeftCorner<3, 3>() = turn * ways_ * turn.transpose();
  all.topRightCorner<3, 3>() = turn * mixed_ * turn.transpose();
  all.bottomLeftCorner<3, 3>() = all.topRightCorner<3, 3>().transpose();
  all.bottomRightCorner<3, 3>() = turn * turns_ * turn.transpose();
  return contact;
}

}  // namespace spinaltap
