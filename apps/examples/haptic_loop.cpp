// haptic_loop BONE PLAN: a thousand cycles a second against the clock, as a haptic device asks for them, and the
// surface that a display would draw. The "device" here is an operator that pushes with 40 N, and more where it stands.
#include <spinaltap/spinaltap.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <thread>

int main(int count, char** arguments) {
  using namespace spinaltap;
  if (count != 3) return 2;
  try {
    const Bone bone = Bone::load(arguments[1]);
    const DrillPath path = read_plan(arguments[2]).front();
    SessionSetup setup;
    setup.options.stop.on_breach = true;
    Session session(bone, path, setup);
    std::size_t blocks = session.surface_changes().size();

    ForceControlled device(path, {.push_n = 40.0});
    constexpr std::chrono::milliseconds kCycle{1};
    auto next = std::chrono::steady_clock::now();
    double most_n = 0.0;
    for (int cycle = 0; cycle < 5000; ++cycle) {
      const std::optional<ToolInput> input = device.next(session.feedback());
      if (!input) break;
      most_n = std::max(most_n, session.step_input(*input).force.thrust_n);
      if (cycle % 33 == 0) blocks += session.surface_changes().size();  // thirty pictures a second
      next += kCycle;
      std::this_thread::sleep_until(next);
    }
    const Cycle& last = session.last();
    std::printf("%.2f mm deep after %.1f s, %.2f N at most; %zu blocks of surface drawn; %zu events\n", last.depth_mm,
                last.time_s, most_n, blocks, session.events().size());
    session.end_hole();  // the next begins at time 0; surface and undo() know both
    session.undo();      // the last hole
    std::printf("the bone is whole again: %zu blocks go back\n", session.surface_changes().size());
  } catch (const Error& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 2;
  }
}
