#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "tests/unit/core/engine/any_motion.h"
#include "tests/unit/core/engine/every_engine.h"
#include "tests/unit/core/engine/tools.h"

namespace spinaltap {
namespace {

using test::Draw;

/// Every point of another CT number; in some volumes only the points of a ball live.
void fill_some(PointVolume& volume, std::uint64_t seed, bool only_a_ball) {
  Draw draw(seed);
  const double depth_mm = volume.disc_depth_mm(volume.disc_count());
  const Vec3 centre(0.4, -0.3, 0.5 * depth_mm);
  for (int disc = 0; disc < volume.disc_count(); ++disc) {
    for (std::size_t i = 0; i < volume.pattern().point_count(); ++i) {
      volume.set_hu(disc, i, draw(-300.0, 2500.0));
      if (only_a_ball)
        volume.set_occupied(disc, i, (volume.point_in_path_mm(disc, i) - centre).norm() < 0.45 * depth_mm);
    }
  }
}

/// The same volume for every engine, and its engine.
struct Bench {
  Bench(const PointVolume& volume, const DrillBit& bit, std::vector<test::NamedEngine> some)
      : kinds(std::move(some)), volumes(kinds.size(), volume) {
    for (std::size_t n = 0; n < kinds.size(); ++n) engines.push_back(kinds[n].make(volumes[n], bit, {}));
  }
  std::vector<test::NamedEngine> kinds;
  std::vector<PointVolume> volumes;
  std::vector<std::unique_ptr<DrillEngine>> engines;
};

void expect_same(const StepResult& a, const StepResult& b) {
  ASSERT_EQ(a.removed, b.removed);
  ASSERT_EQ(a.removed_hu, b.removed_hu);
  // Whole numbers make it up, so that not even the last bit differs.
  ASSERT_EQ(a.work_n_mm, b.work_n_mm);
  ASSERT_EQ(a.removed_mm3, b.removed_mm3);
  ASSERT_EQ(a.moment_n_mm2, b.moment_n_mm2);
}

class EnginesInMotion : public ::testing::TestWithParam<std::uint64_t> {};

TEST_P(EnginesInMotion, RemoveEqualSetsAtEveryStep) {
  const std::uint64_t seed = GetParam();
  SCOPED_TRACE(::testing::Message() << "seed " << seed);
  Draw draw(seed + 1'000'000);
  const std::vector<test::Tool> tools = test::every_tool();
  // Some are of any size, and mostly wider than the volume or longer.
  const std::size_t kind = seed % (tools.size() + 2);
  const DrillBit bit = kind < tools.size()    ? tools[kind].bit
                       : kind == tools.size() ? test::random_bit(draw)
                                              : test::random_profile(draw);
  constexpr double kLengthMm = 3.0;
  constexpr double kRadiusMm = 1.5;
  PointVolumeOptions options{.radius_mm = kRadiusMm, .spacing_mm = 0.15};
  options.hu_bits = seed % 4 < 2 ? HuBits::sixteen : HuBits::eight;
  options.subdivision = seed % 5 == 3 ? DiscSubdivision::hexagons : DiscSubdivision::rings;
  options.jitter = seed % 7 < 2 ? draw(0.05, 0.5) : 0.0;
  options.jitter_seed = seed;
  const Vec3 entry_mm = draw.within(Vec3(-100, -100, -900), Vec3(100, 100, 900));
  PointVolume volume({"any", entry_mm, entry_mm + kLengthMm * draw.direction(), bit}, options);
  fill_some(volume, seed, seed % 8 == 5);
  Bench bench(volume, bit, seed % 4 == 0 ? test::every_engine() : test::three_engines());
  test::AnyMotion motion(seed, kLengthMm, kRadiusMm);
  std::size_t removed = 0;
  const std::size_t occupied_at_first = volume.occupied_count();
  for (int step = 0; step < 60; ++step) {
    SCOPED_TRACE(::testing::Message() << "step " << step);
    const Pose pose = volume.frame().to_patient(motion.next());
    const PointVolume before = bench.volumes[0];
    // Now and then the bit is taken out and put elsewhere.
    if (draw(0.0, 1.0) < 0.1) {
      for (const auto& engine : bench.engines) engine->reset_motion();
    }
    const StepResult reference = bench.engines[0]->step(pose);
    removed += reference.removed;
    ASSERT_TRUE(test::lives_within(bench.volumes[0], before));  // removed points never return
    for (std::size_t n = 1; n < bench.engines.size(); ++n) {
      SCOPED_TRACE(bench.kinds[n].name);
      ASSERT_NO_FATAL_FAILURE(expect_same(bench.engines[n]->step(pose), reference));
      ASSERT_EQ(test::hash_of_occupied(bench.volumes[n]), test::hash_of_occupied(bench.volumes[0]));
    }
  }
  EXPECT_EQ(bench.volumes[0].occupied_count() + removed, occupied_at_first);
  EXPECT_GT(removed, occupied_at_first / 200);
}

TEST(Engines, RemoveByAProfileWhatTheyRemoveByTheShapeThatItRepeats) {
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    SCOPED_TRACE(::testing::Message() << "seed " << seed);
    Draw draw(seed);
    const std::vector<test::Tool> tools = test::every_tool();
    const DrillBit bit = seed % 2 == 0 ? tools[seed / 2 % tools.size()].bit : test::random_bit(draw);
    PointVolume of_shape(test::askew_path(3.0), {.radius_mm = 1.5, .spacing_mm = 0.15});
    fill_some(of_shape, seed, false);
    PointVolume of_profile = of_shape;
    const auto shape = make_ring_engine(of_shape, bit, {});
    const auto profile = make_ring_engine(of_profile, test::profile_like(bit), {});
    test::AnyMotion motion(seed, 3.0, 1.5);
    for (int step = 0; step < 60; ++step) {
      const Pose pose = of_shape.frame().to_patient(motion.next());
      ASSERT_NO_FATAL_FAILURE(expect_same(profile->step(pose), shape->step(pose))) << "step " << step;
    }
    EXPECT_EQ(test::hash_of_occupied(of_profile), test::hash_of_occupied(of_shape));
  }
}

#if defined(SPINALTAP_ADDRESS_SANITIZER)
constexpr std::uint64_t kSeeds = 60;  // each takes ten times as long
#else
constexpr std::uint64_t kSeeds = 240;
#endif
INSTANTIATE_TEST_SUITE_P(Seeds, EnginesInMotion, ::testing::Range<std::uint64_t>(1, kSeeds + 1));

/// The workloads that all figures use, coarser and faster: 4 um a step.
struct Workload {
  std::string name;
  double diameter_mm;
  double offset_mm;
  double tilt_deg;
  double tremor_mm;
  double lean = 1.0;  ///< how far the axis trembles
  double tip_mm = 5.0;

  friend void PrintTo(const Workload& workload, std::ostream* out) { *out << workload.name; }
};

class EnginesAtWork : public ::testing::TestWithParam<Workload> {
 protected:
  static constexpr double kLengthMm = 9.0;
  static constexpr int kCycles = 2'300;

  static Pose pose(int cycle) {
    const Workload& work = GetParam();
    const double along_mm = -0.1 + 0.004 * cycle;
    const double tilt = work.tilt_deg * std::numbers::pi / 180.0;
    const Vec3 axis(std::sin(tilt), 0.0, std::cos(tilt));
    const Vec3 start(work.offset_mm - 0.5 * kLengthMm * std::tan(tilt), 0.0, 0.0);
    // An operator trembles at 8 to 12 Hz: at 1 kHz that is 0.05 to 0.075 rad a cycle.
    const Vec3 tremor(std::sin(0.0503 * cycle) + std::sin(0.0628 * cycle), std::sin(0.0571 * cycle), 0.0);
    const Vec3 lean = work.lean * Vec3(0.001 * std::sin(0.07 * cycle), 0.0007 * std::cos(0.055 * cycle), 0.0);
    const bool trembles = work.tremor_mm > 0.0;
    return {start + along_mm * axis + work.tremor_mm * tremor, trembles ? (axis + lean).normalized() : axis};
  }
};

TEST_P(EnginesAtWork, RemoveEqualSetsAtEveryHundredthCycle) {
  const DrillBit bit{GetParam().diameter_mm, 50.0, GetParam().tip_mm};
  PointVolume volume(test::askew_path(kLengthMm), {.radius_mm = 3.0, .spacing_mm = 0.2});
  fill_some(volume, 5, false);
  Bench bench(volume, bit, test::every_engine());
  for (int cycle = 0; cycle <= kCycles; ++cycle) {
    SCOPED_TRACE(::testing::Message() << "cycle " << cycle);
    const Pose patient = volume.frame().to_patient(pose(cycle));
    const StepResult reference = bench.engines[0]->step(patient);
    for (std::size_t n = 1; n < bench.engines.size(); ++n) {
      SCOPED_TRACE(bench.kinds[n].name);
      ASSERT_NO_FATAL_FAILURE(expect_same(bench.engines[n]->step(patient), reference));
      if (cycle % 100 != 0) continue;
      ASSERT_EQ(test::hash_of_occupied(bench.volumes[n]), test::hash_of_occupied(bench.volumes[0]));
    }
  }
  // The bit's section over the volume's, where the cone is past: some 17 of 100.
  EXPECT_LT(bench.volumes[0].occupied_count(), volume.point_count() * 88 / 100);
}

INSTANTIATE_TEST_SUITE_P(Motions, EnginesAtWork,
                         ::testing::Values(Workload{"on path", 3.06, 0.0, 0.0, 0.0},
                                           Workload{"on path with the wall on a ring", 2.8, 0.0, 0.0, 0.0},
                                           Workload{"off path", 3.0, 1.2, 0.0, 0.0},
                                           Workload{"tilted", 3.0, 0.0, 3.0, 0.0},
                                           Workload{"tremor", 3.0, 0.0, 0.0, 0.1},
                                           Workload{"tremor off path", 3.0, 1.2, 0.0, 0.1},
                                           Workload{"tremor of a steady axis, tilted", 3.0, 1.2, 4.0, 0.1, 0.0},
                                           Workload{"tremor of a blunt drill, tilted", 3.2, 0.5, 9.0, 0.1, 0.0, 0.9}));

TEST(Engines, RemoveEqualSetsOfJitteredPointsByBluntBits) {
  // Points out of their disc's plane meet a blunt cone where it is far wider, or narrower, than at the plane.
  for (const double tip_mm : {0.1, 0.3, 0.9}) {
    for (const double tilt : {0.0, 0.2}) {
      SCOPED_TRACE(::testing::Message() << "tip " << tip_mm << " mm, tilt " << tilt);
      const DrillBit bit{3.0, 50.0, tip_mm};
      PointVolume volume(test::askew_path(3.0), {.radius_mm = 2.5, .spacing_mm = 0.15, .jitter = 0.4});
      fill_some(volume, 8, false);
      Bench bench(volume, bit, test::three_engines());
      for (int cycle = 0; cycle < 150; ++cycle) {
        SCOPED_TRACE(::testing::Message() << "cycle " << cycle);
        const Vec3 tremor(std::sin(0.3 * cycle) + 0.5 * std::sin(0.7 * cycle), std::sin(0.5 * cycle), 0.0);
        const Vec3 axis(std::sin(tilt), 0.0, std::cos(tilt));
        const Pose pose = volume.frame().to_patient(Pose{(0.02 * cycle - 0.2) * axis + 0.2 * tremor, axis});
        const StepResult reference = bench.engines[0]->step(pose);
        for (std::size_t n = 1; n < bench.engines.size(); ++n) {
          SCOPED_TRACE(bench.kinds[n].name);
          ASSERT_NO_FATAL_FAILURE(expect_same(bench.engines[n]->step(pose), reference));
        }
      }
      EXPECT_LT(bench.volumes[0].occupied_count(), volume.point_count() * 3 / 4);
    }
  }
}

TEST(Engines, RemoveWhatTheSkinOfABluntConeReaches) {
  // 1 nm across the wall of such a cone is 14 nm across its axis.
  constexpr double kSlope = 14.0, kSkinNm = 14.0;
  const DrillBit bit{4.0, 50.0, 2.0 / kSlope};
  for (const double beside_nm : {0.0, 5.0, 12.0, 16.0}) {
    SCOPED_TRACE(::testing::Message() << beside_nm << " nm beside a ring");
    const PointVolume volume(test::askew_path(3.0), {.radius_mm = 2.5, .spacing_mm = 0.15});
    Bench bench(volume, bit, test::three_engines());
    const int ring = 5;
    const double cone_mm = ring * volume.pattern().spacing_mm() - 1e-6 * beside_nm;
    const double tip_mm = volume.disc_depth_mm(10) + cone_mm / kSlope;
    for (const double depth_mm : {-0.5, tip_mm - 0.04, tip_mm}) {
      const Pose pose = volume.frame().to_patient(Pose{Vec3(0.0, 0.0, depth_mm), Vec3::UnitZ()});
      const StepResult reference = bench.engines[0]->step(pose);
      for (std::size_t n = 1; n < bench.engines.size(); ++n) {
        SCOPED_TRACE(bench.kinds[n].name);
        ASSERT_NO_FATAL_FAILURE(expect_same(bench.engines[n]->step(pose), reference));
      }
    }
    EXPECT_EQ(bench.volumes[0].is_occupied(10, DiscPattern::ring_start(ring)), beside_nm > kSkinNm);
  }
}

/// All that a run with long steps of a burr, which are worth sharing, makes known.
std::vector<StepResult> run(const test::NamedEngine& kind, std::size_t threads, std::vector<std::uint64_t>& hashes) {
  const tbb::global_control control(tbb::global_control::max_allowed_parallelism, threads);
  const DrillBit burr{4.0, 30.0, 1.0, BitShape::round_burr, 0.0, 3.0};
  PointVolume volume(test::askew_path(12.0), {.radius_mm = 4.0, .spacing_mm = 0.1});
  fill_some(volume, 6, false);
  const auto engine = kind.make(volume, burr, {});
  std::vector<StepResult> results;
  Draw draw(7);
  Vec3 tip_mm(-1.5, 0.0, 1.0);
  for (int step = 0; step < 14; ++step) {
    tip_mm += draw.within(Vec3(-1.0, -1.0, 0.2), Vec3(1.0, 1.0, 1.2));
    results.push_back(engine->step(test::pose_at(volume, tip_mm, Vec3(0.1, -0.2, 1.0))));
    hashes.push_back(test::hash_of_occupied(volume));
  }
  return results;
}

TEST(Engines, DoTheSameAgainAndOnAnyNumberOfThreads) {
  for (const test::NamedEngine& kind : test::three_engines()) {
    SCOPED_TRACE(kind.name);
    std::vector<std::uint64_t> first_hashes;
    const std::vector<StepResult> first = run(kind, 1, first_hashes);
    EXPECT_GT(std::ranges::max(first, {}, &StepResult::removed).removed, 2'000U);
    for (const std::size_t threads : {1U, 2U, 2U}) {
      std::vector<std::uint64_t> hashes;
      const std::vector<StepResult> again = run(kind, threads, hashes);
      EXPECT_EQ(hashes, first_hashes);
      for (std::size_t n = 0; n < first.size(); ++n) {
        ASSERT_NO_FATAL_FAILURE(expect_same(again[n], first[n])) << n;
        ASSERT_EQ(again[n].tested, first[n].tested);
      }
    }
  }
}

}  // namespace
}  // namespace spinaltap
