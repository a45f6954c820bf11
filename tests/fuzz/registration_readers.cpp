// Where the patient is: registrations, points that were marked or measured, poses of a tracked tool.

#include <Eigen/Geometry>

#include <sstream>

#include "core/files/measured_points_file.h"
#include "core/files/registration_file.h"
#include "core/registration/calibrate_pivot.h"
#include "core/registration/register_fiducials.h"
#include "tests/fuzz/readers.h"

namespace spinaltap::test {
namespace {

namespace fs = std::filesystem;

std::vector<Seed> registration_seeds() {
  const std::vector<Vec3> marks_mm{{0, 0, 0}, {60, 5, 0}, {10, 50, 8}, {-30, 20, 40}};
  const Registration found = register_fiducials(marks_mm, marks_mm, {.fle_mm = 0.3});
  const auto write = [&](const fs::path& file) { write_registration(found, file); };
  return {{"marks", {{"registration.json", bytes_written("registration.json", write), {}, true}}}};
}

void read_a_registration(const fs::path& folder) {
  const Registration found = read_registration(only_file(folder));
  static_cast<void>(found.ct_from_patient.inverse().apply(Vec3(1.0, 2.0, 3.0)));
  static_cast<void>(target_error_mm(found.covariance, Vec3(10.0, -200.0, 30.0)));
}

std::vector<Seed> measured_seeds() {
  return {{"csv", {{"points.csv", "1,2,3\n4.5,-6e1,7\n\n8,9,.1\r\n"}}},
          {"csv with a head", {{"points.csv", "label,x_mm,y_mm,z_mm\n\"a, b\",1,2,3\nc,4,5,6\n"}}},
          {"list of 3D Slicer",
           {{"points.fcsv",
             "# Markups fiducial file version = 4.11\n# CoordinateSystem = LPS\n# columns = "
             "id,x,y,z,ow,ox,oy,oz,vis,sel,lock,label,desc,associatedNodeID\n"
             "1,2.5,-3,4,0,0,0,1,1,1,0,F-1,,vtkMRMLScalarVolumeNode1\n2,5,6,7,0,0,0,1,1,1,0,F-2,,\n"}}},
          {"markups of 3D Slicer",
           {{"points.mrk.json",
             R"({"markups": [{"type": "Fiducial", "coordinateSystem": "RAS", "coordinateUnits": "mm", "controlPoints": [
               {"label": "F-1", "position": [1.5, -2, 3], "positionStatus": "defined"},
               {"label": "F-2", "position": [4, 5, 6], "positionStatus": "undefined"}]}]})",
             {},
             true}}}};
}

void read_measured(const fs::path& folder) {
  const std::vector<MeasuredPoint> points = read_measured_points(only_file(folder), MeasuredFrame::ras);
  static_cast<void>(pair_points(points, points));
}

/// Of a tool whose tip stands still, a line each: a quaternion, or a matrix of so many rows.
std::string turning_tool(int rows) {
  std::ostringstream text;
  text.precision(12);
  for (int n = 0; n < 8; ++n) {
    const Eigen::Quaterniond turned(Eigen::AngleAxisd(0.8 * n, Vec3::UnitZ()) * Eigen::AngleAxisd(0.5, Vec3::UnitX()) *
                                    Eigen::AngleAxisd(0.3 * n, Vec3::UnitZ()));
    const Vec3 at_mm = Vec3(-80.0, 40.0, -1200.0) - turned * Vec3(3.0, -2.0, 140.0);
    if (rows == 0) {
      text << at_mm.x() << ',' << at_mm.y() << ',' << at_mm.z() << ',' << turned.w() << ',' << turned.x() << ','
           << turned.y() << ',' << turned.z() << '\n';
      continue;
    }
    const Mat3 rotation = turned.toRotationMatrix();
    for (int row = 0; row < 3; ++row) {
      text << (row > 0 ? "," : "") << rotation(row, 0) << ',' << rotation(row, 1) << ',' << rotation(row, 2) << ','
           << at_mm[row];
    }
    text << (rows == 4 ? ",0,0,0,1\n" : "\n");
  }
  return text.str();
}

std::vector<Seed> tool_pose_seeds() {
  return {{"quaternions", {{"poses.csv", "x_mm,y_mm,z_mm,qw,qx,qy,qz\n" + turning_tool(0)}}},
          {"matrices", {{"poses.csv", turning_tool(3)}}},
          {"whole matrices", {{"poses.csv", turning_tool(4)}}}};
}

void read_a_calibration(const fs::path& folder) {
  static_cast<void>(calibrate_pivot(read_tool_poses(only_file(folder)), {}));
}

}  // namespace

void add_registration_readers(std::vector<Reader>& readers) {
  readers.push_back({"registration", registration_seeds, read_a_registration});
  readers.push_back({"measured-points", measured_seeds, read_measured});
  readers.push_back({"tool-poses", tool_pose_seeds, read_a_calibration});
}

}  // namespace spinaltap::test
