// Tables of numbers: poses, points and values, radial basis functions.

#include <zlib.h>

#include <cstring>

#include "core/files/measurements_file.h"
#include "core/rbf/evaluated_file.h"
#include "core/rbf/rbf_file.h"
#include "core/rbf/value_file.h"
#include "core/session/operator/recorded_motion.h"
#include "tests/fuzz/readers.h"
#include "tests/support/made_nifti.h"

namespace spinaltap::test {
namespace {

namespace fs = std::filesystem;

std::vector<Seed> pose_seeds() {
  return {{"plain",
           {{"poses.csv",
             "time_s,x_mm,y_mm,z_mm,axis_x,axis_y,axis_z,spindle_on\n0,1,2,3,0,0,1,1\n0.001,1,2,3.5e0,0,0.1,1,0\n"
             "0.002,1,2,4,0,-0,2,1\n"}}},
          {"sides of a plate",
           {{"poses.csv",
             "time_s,x_mm,y_mm,z_mm,axis_x,axis_y,axis_z,side_x,side_y,side_z\n0,1,2,3,0,0,1,1,0,0\n0.001,1,2,3,0,0,1,,"
             ",\n"}}},
          {"other columns",
           {{"poses.csv",
             "note,z_mm,y_mm,x_mm,time_s,axis_z,axis_y,axis_x\r\n\"a,b\",3,2,1,0,1,0,0\r\n,4,2,1,.5,1,0,0\r\n"}}}};
}

void read_poses(const fs::path& folder) {
  const fs::path file = only_file(folder);
  static_cast<void>(read_pose_csv(file, {.lets_bad_poses_pass = true}));
  static_cast<void>(read_pose_csv(file));
}

std::string big_endian_ply() {
  std::string bytes =
      "ply\nformat binary_big_endian 1.0\ncomment c\nelement camera 1\nproperty list uchar int views\n"
      "element vertex 3\nproperty float x\nproperty float y\nproperty float z\nproperty list uint ushort near\n"
      "property double value\nproperty char error_bar\nend_header\n";
  bytes += std::string("\1\0\0\0\7", 5);
  for (int n = 0; n < 3; ++n) {
    bytes += std::string("\x40\x40\0\0\x3f\x80\0\0\xc0\0\0\0", 12);
    bytes += std::string("\0\0\0\1\0\5", 6) + std::string("\xbf\xf0\0\0\0\0\0\0\1", 9);
  }
  return bytes;
}

std::vector<Seed> value_seeds() {
  std::vector<Seed> seeds;
  const std::vector<Vec3> points_mm{{1, 2, 3}, {4.5, -5e-3, 6}, {7, 8, 9}};
  const std::vector<double> values_mm{0.5, -1.0, 0.25};
  for (const char* name : {"a.csv", "a.ply"}) {
    const auto write = [&](const fs::path& path) { write_evaluated({points_mm, values_mm, points_mm}, path); };
    seeds.push_back({"ours", {{name, bytes_written(name, write)}}});
  }
  const std::string bars = "1,2,3,4,0.1\n4,5,6,-7,0\n1e1,2,3,4,.5\r\n";
  seeds.push_back({"without a head", {{"a.csv", bars}}});
  seeds.push_back({"gzipped, with a head",
                   {{"a.csv.gz", "note,\"x\",error_bar,y,z,value\n\"a,b\",1,0.1,2,3,4\n,4,0,5,6,-7\n", gzipped}}});
  seeds.push_back({"gzipped", {{"a.csv.gz", bars, gzipped}}});
  seeds.push_back({"big endian", {{"a.ply", big_endian_ply()}}});
  seeds.push_back({"text",
                   {{"a.ply",
                     "ply\nformat ascii 1.0\nelement face 1\nproperty list uchar int i\nelement vertex 2\n"
                     "property float x\nproperty float y\nproperty float z\nproperty list uint ushort near\n"
                     "property double value\nend_header\n3 0 1 2\n1 2 3 0 4\n4 5 6 2 8 9 -7\n"}}});
  return seeds;
}

/// Puts the checksum at the end right.
std::string with_checksum(const std::string& content) {
  std::string bytes = content;
  if (bytes.size() < 4) return bytes;
  const std::size_t end = bytes.size() - 4;
  const auto crc = static_cast<std::uint32_t>(crc32_z(0, reinterpret_cast<const Bytef*>(bytes.data()), end));
  std::memcpy(bytes.data() + end, &crc, sizeof crc);
  return bytes;
}

std::vector<Seed> rbf_seeds() {
  std::vector<Seed> seeds;
  for (const RadialKernel kernel : {RadialKernel::biharmonic, RadialKernel::triharmonic}) {
    RbfModel model;
    model.kernel = kernel;
    model.centres_mm = {{1, 2, 3}, {4, 5, 6}, {7, 8, 9}};
    model.weights = {0.5, -1.0, 0.5};
    model.polynomial.assign(polynomial_terms(kernel), 0.25);
    const auto write = [&](const fs::path& path) { write_rbf(model, path); };
    seeds.push_back({"rbf", {{"a.rbf", bytes_written("a.rbf", write), with_checksum}}});
  }
  return seeds;
}

std::vector<Seed> measurement_seeds() {
  return {
      {"one row each",
       {{"sources.csv",
         "key,report,authors,title,journal,year,doi,url,read,quote\na,own,b,c,d,2012,10.1/e,http://f,abstract,"
         "\"1 N, 2 \xC2\xB1 3\"\nb,cited,,,,,,u,v,w\n"},
        {"drilling.csv",
         "source,species,tissue,site,density_g_cm3,density_known_by,process,tool,diameter_mm,point_angle_deg,web_mm,"
         "helix_deg,rpm,feed_mm_min,pilot_mm,thrust_n,thrust_sd_n,thrust_range_n,thrust_kind,torque_n_mm,"
         "torque_sd_n_mm,torque_range_n_mm,torque_kind,n,n_of,conditions,fitted,note\n"
         "a,human,cortical,femur,1.9,CT,drill,bit,3.2,118,0.5,30,1000,30 to 70,1,198.4,14.2,1 to 300,max,186,16,,"
         "mean,16,femurs,read,yes,\"x, y\"\nb,,foam,,,,awl,,,,,,,,,,,0 to 5,not_stated,,,,,,,noted,no,\n"},
        {"screws.csv",
         "source,species,tissue,site,group,hu,hu_sd,t_score,t_score_sd,bmd_g_cm2,density_g_cm3,density_known_by,"
         "screw,outer_diameter_mm,core_diameter_mm,pitch_mm,length_mm,inserted_mm,pilot_mm,torque_n_mm,"
         "torque_sd_n_mm,torque_kind,pullout_n,pullout_sd_n,stiffness_n_mm,n,n_of,fitted,note\r\n"
         "a,human,vertebra,L3,normal,136,57,-1.1,0.2,1,0.3,CT,s,6.5,4,2,45,40,3,1055,580,insertion,970,400,1e3,284,"
         "screws,no,\r\n"},
        {"heat.csv",
         "source,species,tissue,site,process,tool,diameter_mm,rpm,feed_mm_min,feed_mm_rev,axial_force_n,pilot_mm,"
         "irrigation,distance_mm,depth_mm,temperature_c,temperature_sd_c,temperature_range_c,temperature_kind,n,"
         "n_of,fitted,note\na,dog,bone,rib,ultrasonic,t,2 to 4,500,48,0.1,25,1,internal,0.5,3,54,2,19 to 100,rise,10,"
         "holes,no,z\n"}}}};
}

}  // namespace

void add_table_readers(std::vector<Reader>& readers) {
  readers.push_back({"poses", pose_seeds, read_poses});
  readers.push_back({"measurements", measurement_seeds,
                     [](const fs::path& folder) { static_cast<void>(read_measurements(folder)); }});
  readers.push_back({"values", value_seeds, [](const fs::path& folder) {
                       const fs::path file = only_file(folder);
                       static_cast<void>(read_positions(file));  // wants less than values do
                       static_cast<void>(read_values(file));
                     }});
  readers.push_back({"rbf", rbf_seeds, [](const fs::path& folder) { check_model(read_rbf(only_file(folder))); }});
}

}  // namespace spinaltap::test
