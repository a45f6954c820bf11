#pragma once

#include <fstream>
#include <string>

namespace spinaltap::test {

/// How much of the processor time that this machine asked for its host gave to others, since this was made. Linux tells
/// of it on virtual machines; elsewhere there is none.
class StolenTime {
 public:
  StolenTime() : then_(now()) {}

  /// 0 to 1.
  double share() const {
    const Ticks ticks = now();
    const double asked = ticks.used - then_.used + ticks.stolen - then_.stolen;
    return asked > 0.0 ? (ticks.stolen - then_.stolen) / asked : 0.0;
  }

 private:
  struct Ticks {
    double used = 0.0, stolen = 0.0;
  };

  static Ticks now() {
    std::ifstream file("/proc/stat");
    std::string cpu;
    double user = 0.0, nice = 0.0, system = 0.0, idle = 0.0, waiting = 0.0, irq = 0.0, soft_irq = 0.0, stolen = 0.0;
    file >> cpu >> user >> nice >> system >> idle >> waiting >> irq >> soft_irq >> stolen;
    return {user + nice + system + irq + soft_irq, stolen};
  }

  Ticks then_;
};

}  // namespace spinaltap::test
