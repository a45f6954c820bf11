#include "apps/spinaltap/hand_options.h"

namespace spinaltap {

void add_straight_hand(CLI::App& app, HandChoice& hand) {
  app.add_option("--step", hand.step_mm, "Advance a cycle, mm; default: 0.001")->type_name("MM");
  app.add_option("--offset", hand.offset_mm, "Sideways shift of the bit from the path, mm; default: 0")
      ->type_name("MM");
  app.add_option("--tilt", hand.tilt_deg, "Angle between bit and path, degrees; default: 0")->type_name("DEG");
}

void add_hand(CLI::App& app, HandChoice& hand) {
  app.add_option(
         "--hand", hand.name,
         "Who moves the bit: on-path (default), off-path (by 1.2 mm), tilted (by 3 degrees), tremor (of 0.1 mm, "
         "8 to 12 Hz), push (with a force: feed follows from the bone), or a file of poses, FILE.csv")
      ->type_name("NAME");
  app.add_option("--feed", hand.feed, "Feed, mm/s; default: 1. Or by depth: 1,5:0.5 is 1, and 0.5 from 5 mm on")
      ->type_name("MM_S");
  app.add_option("--rate", hand.rate_hz, "Poses a second, Hz; in real time also collision cycles; default: 1000")
      ->type_name("HZ");
  app.add_option("--tremor", hand.tremor_mm, "Amplitude of the hand's tremor, mm; default: 0, of the hand tremor 0.1")
      ->type_name("MM");
  app.add_option("--peck", hand.peck_mm, "Draw back by 2 mm each so many mm of depth; default: never")->type_name("MM");
  app.add_option("--withdraw", hand.withdraw_mm_s, "Draw back to the start at the end, mm/s; default: stay")
      ->type_name("MM_S");
  app.add_option("--push", hand.push_n, "With --hand push: force along the path, N; default: 40")->type_name("N");
  app.add_option("--seed", hand.seed, "Seed of the tremor; default: 1")->type_name("N");
}

}  // namespace spinaltap
