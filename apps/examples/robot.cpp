// robot BONE PLAN POSES.csv RECORD.h5: the poses that a robot's drill takes, against the bone. Stops where the bit
// comes within 0.5 mm of a wall, as the robot must, and tells what happened; the record is run again to the last bit.
#include <spinaltap/core/session/operator/recorded_motion.h>
#include <spinaltap/spinaltap.h>

#include <algorithm>
#include <cstdio>

int main(int count, char** arguments) {
  using namespace spinaltap;
  if (count != 5) return 2;
  try {
    const Bone bone = Bone::load(arguments[1]);
    const DrillPath path = read_plan(arguments[2]).front();
    SessionSetup setup;
    setup.volume.radius_mm = 6.0;  // as far from the planned path as the robot may err, and the bit's radius
    setup.volume.spacing_mm = 0.2;
    setup.options.stop = {.clearance_mm = 0.5, .on_breach = true};
    Session session(bone, path, setup);
    session.record(arguments[4]);

    std::size_t poses = 0;
    double max_thrust_n = 0.0;
    for (const ToolInput& input : read_pose_csv(arguments[3])) {
      const Cycle& cycle = session.step_input(input);
      ++poses;
      max_thrust_n = std::max(max_thrust_n, cycle.force.thrust_n);
      if (session.is_stopped()) break;  // here the robot halts
    }
    session.end_record();

    const Cycle& last = session.last();
    std::printf(
        "%s after %zu poses, %.2f mm deep, %.1f N at most; %.3f mm from the outer surface, %.3f mm from the canal\n",
        session.is_stopped() ? "stopped" : "done", poses, last.depth_mm, max_thrust_n, last.clearance.outer_mm,
        last.clearance.canal_mm);
    for (const SessionEvent& event : session.events()) {
      std::printf("%8.3f s  %6.2f mm  %s  %g\n", event.time_s, event.depth_mm, std::string(name_of(event.kind)).c_str(),
                  event.value);
    }
    const Replay again = replay(arguments[4], bone);
    std::printf("%zu cycles again: %s\n", again.cycles, again.is_same() ? "the same" : again.difference.c_str());
    return again.is_same() ? 0 : 1;
  } catch (const Error& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
}
