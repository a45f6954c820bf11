#include "core/plan/detail/landmark_doubts.h"

#include <cmath>
#include <numbers>
#include <sstream>

#include "core/base/error.h"

namespace spinaltap {
namespace {

template <class... Parts>
std::string line(const Parts&... parts) {
  std::ostringstream text;
  text.precision(3);
  (text << ... << parts);
  return text.str();
}

class Doubts {
 public:
  void expect(const std::string& what, double value, double low, double high, const char* unit) {
    if (value >= low && value <= high) return;
    lines_.push_back(line(what, " is ", value, " ", unit, ", expected ", low, " to ", high, " ", unit));
  }
  void add(std::string text) { lines_.push_back(std::move(text)); }
  const std::vector<std::string>& lines() const { return lines_; }

 private:
  std::vector<std::string> lines_;
};

double degrees_between(const Vec3& a, const Vec3& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b)) * 180.0 / std::numbers::pi;
}

void doubt_pedicle(Doubts& doubts, const Landmarks& found, const PedicleLandmarks& pedicle, double side) {
  const std::string name = side > 0.0 ? "the left pedicle's " : "the right pedicle's ";
  const Vec3 isthmus = found.to_own(pedicle.isthmus_mm), axis = found.axes.transpose() * pedicle.axis;
  doubts.expect(name + "width", pedicle.width_mm, 2.0, 20.0, "mm");
  doubts.expect(name + "height", pedicle.height_mm, 5.0, 22.0, "mm");
  doubts.expect(name + "distance from the midsagittal plane", side * isthmus.x(), 5.0, 30.0, "mm");
  const double convergence = std::atan2(-side * axis.x(), -axis.y()) * 180.0 / std::numbers::pi;
  doubts.expect(name + "convergence", convergence, -15.0, 45.0, "degrees");
  doubts.expect(name + "tilt", std::asin(axis.z()) * 180.0 / std::numbers::pi, -30.0, 30.0, "degrees");
}

}  // namespace

std::vector<std::string> doubts_about(const Landmarks& found, double asymmetry_mm, const CutFace& cut_face) {
  constexpr double kCutMm2 = 25.0;
  Doubts doubts;
  if (cut_face.area_mm2 >= kCutMm2) {
    doubts.add(line("the bone ends at the patient's ", side_of_patient(cut_face.normal), " in a flat face of ",
                    cut_face.area_mm2, " mm²: something is cut off there"));
  }
  doubt_pedicle(doubts, found, found.left_pedicle, 1.0);
  doubt_pedicle(doubts, found, found.right_pedicle, -1.0);
  doubts.expect("the left pedicle's width over the right one's",
                found.left_pedicle.width_mm / found.right_pedicle.width_mm, 0.6, 1.7, "");
  const Landmarks::Body& body = found.body;
  doubts.expect("the body's width", body.width_mm, 18.0, 70.0, "mm");
  doubts.expect("the body's depth", body.depth_mm, 12.0, 50.0, "mm");
  doubts.expect("the body's height", body.height_mm, 10.0, 42.0, "mm");
  doubts.expect("the body's height over its depth", body.height_mm / body.depth_mm, 0.45, 1.4, "");
  doubts.expect("the angle between the endplates", degrees_between(body.upper.normal, -body.lower.normal), 0.0, 25.0,
                "degrees");
  doubts.expect("the angle between the canal and the endplates' normals",
                degrees_between(found.canal.axis, found.superior()), 0.0, 25.0, "degrees");
  doubts.expect("the canal's width", found.canal.width_mm, 10.0, 35.0, "mm");
  doubts.expect("the canal's depth", found.canal.depth_mm, 8.0, 30.0, "mm");
  doubts.expect("the distance between the surface and its mirror image", asymmetry_mm, 0.0, 1.5, "mm");
  return doubts.lines();
}

}  // namespace spinaltap
