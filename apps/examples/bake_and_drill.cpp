// bake_and_drill CT: from a CT to the forces of every cycle, along the path that is suggested for the first pedicle.
#include <spinaltap/spinaltap.h>

#include <cstdio>

int main(int, char** arguments) {
  using namespace spinaltap;
  const Bone bone = Bone::from_ct(arguments[1]);
  const DrillPath path = paths_of(bone.suggest()).front();
  Session session(bone, path);
  for (double depth_mm = -3.0; depth_mm < path.length_mm(); depth_mm += 0.001) {
    const Cycle& cycle = session.step({path.entry_mm + depth_mm * path.direction(), path.direction()});
    std::printf("%.3f mm: %.2f N, %.2f N mm\n", depth_mm, cycle.force.thrust_n, cycle.force.torque_n_mm);
  }
}
