#pragma once

#include <cmath>
#include <cstdio>
#include <filesystem>
#include <string>
#include <vector>

#include "core/base/staged_output.h"
#include "core/session/operator/recorded_motion.h"
#include "core/session/record/session_record.h"
#include "core/tool/drill_path.h"
#include "tests/support/temporary_folder.h"
#include "vdb/sim/session.h"

namespace spinaltap::test {

/// A hand that was recorded, as a CSV file of poses at 1 kHz, and what a session gets of it: from before the entry to
/// 6 mm beyond, aside and leaning as well, with the spindle off for a while.
inline std::vector<ToolInput> recorded_hand(const DrillPath& path, const std::filesystem::path& file) {
  constexpr int kCycles = 1500;
  const Vec3 along = path.direction(), aside = along.cross(Vec3::UnitZ()).normalized();
  std::string text = "time_s,x_mm,y_mm,z_mm,axis_x,axis_y,axis_z,spindle_on\n";
  for (int n = 0; n < kCycles; ++n) {
    const double time_s = 0.001 * n;
    const Vec3 tip_mm = path.entry_mm + (6.0 * time_s - 3.0) * along + 0.3 * std::sin(60.0 * time_s) * aside;
    const Vec3 axis = along + 0.02 * std::sin(7.0 * time_s) * aside;
    char line[240];
    std::snprintf(line, sizeof line, "%.17g,%.17g,%.17g,%.17g,%.17g,%.17g,%.17g,%d\n", time_s, tip_mm.x(), tip_mm.y(),
                  tip_mm.z(), axis.x(), axis.y(), axis.z(), time_s > 0.7 && time_s < 0.75 ? 0 : 1);
    text += line;
  }
  write_whole_file(file, text);
  return read_pose_csv(file);
}

/// The hash of the record that a Session writes of inputs: what every other way in has to give.
inline std::string session_hash(Session session, const std::vector<ToolInput>& inputs) {
  const TemporaryFolder folder;
  session.record(folder.path() / "session.h5");
  session.run(inputs);
  session.end_record();
  return hash_of(read_record(folder.path() / "session.h5"));
}

}  // namespace spinaltap::test
