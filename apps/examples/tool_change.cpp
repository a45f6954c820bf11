// tool_change BONE: a thousand cycles a second of a burr in a hand, without a planned path; a pedal changes the burr,
// and a renderer takes the surface. The "hand" here goes straight down from above the bone. tool_change.c, .cs and .py
// are the same in C, C# and Python's ctypes, to the last bit.
#include <spinaltap/spinaltap.h>

#include <algorithm>
#include <cstdio>
#include <vector>

int main(int count, char** arguments) {
  using namespace spinaltap;
  if (count != 2) return 2;
  try {
    const Bone bone = Bone::load(arguments[1]);
    const Box3 bounds_mm = bone.model().bounds_mm();
    SessionSetup setup;
    setup.volume.spacing_mm = 0.2;
    setup.has_clearances = false;  // with them: depths, and how near the canal is
    Session session(std::vector{bone}, setup);
    std::printf("%s\n", session.chosen().c_str());

    DrillBit burr{.diameter_mm = 4.0, .shape = BitShape::round_burr, .shank_diameter_mm = 2.5};
    session.set_tool(burr);
    std::size_t blocks = session.surface_changes().size();
    double max_n = 0.0;
    for (int n = 0; n < 5000; ++n) {
      if (n == 2500) {  // the pedal
        burr.diameter_mm = 3.0;
        session.set_tool(burr);
      }
      const Vec3 tip_mm(0.5 * (bounds_mm.min().x() + bounds_mm.max().x()),
                        0.75 * bounds_mm.min().y() + 0.25 * bounds_mm.max().y(),  // above the vertebra's body
                        bounds_mm.max().z() + 2.0 - 0.004 * n);
      const Cycle& cycle = session.step({tip_mm, -Vec3::UnitZ()}, 0.001);
      max_n = std::max(max_n, cycle.force.thrust_n);                // cycle.force.force_n is what the device gives
      if (n % 33 == 0) blocks += session.surface_changes().size();  // thirty times a second
    }
    std::printf("%.1f s, %.2f N at most, %zu blocks of surface drawn, %zu events\n", session.last().time_s, max_n,
                blocks, session.events().size());
  } catch (const Error& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 2;
  }
}
