// hand_cpp BONE PLAN POSES RECORD: the same hand as hand.c's, in C++. Prints the record's hash.
#include <cstdio>
#include <vector>

#include "core/base/error.h"
#include "core/session/record/session_record.h"
#include "tests/c/hand.h"
#include "vdb/sim/session.h"

int main(int count, char** arguments) {
  using namespace spinaltap;
  if (count != 5) return 2;
  try {
    SessionSetup setup;
    setup.has_clearances = false;
    setup.volume.spacing_mm = HAND_SPACING_MM;
    Session session(std::vector{Bone::load(arguments[1])}, setup);
    session.record(arguments[4]);
    std::FILE* const file = std::fopen(arguments[3], "r");
    std::vector<hand_pose> poses;
    for (hand_pose pose; file != nullptr && next_pose(file, &pose) != 0;) poses.push_back(pose);
    for (std::size_t n = 0; n < poses.size(); ++n) {
      if (n == poses.size() / 2) {
        session.set_tool({HAND_BURR_MM, HAND_BURR_LENGTH_MM, HAND_BURR_MM / 2.0, BitShape::round_burr});
      }
      const hand_pose& pose = poses[n];
      session.step_input(
          {{Vec3(pose.tip_mm[0], pose.tip_mm[1], pose.tip_mm[2]), Vec3(pose.axis[0], pose.axis[1], pose.axis[2])},
           pose.spindle_on != 0,
           pose.dt_s});
    }
    session.end_record();
    std::printf("%s\n", hash_of(read_record(arguments[4])).c_str());
    return poses.empty() ? 1 : 0;
  } catch (const Error& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
}
