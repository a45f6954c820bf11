#include "core/ct/hu_check.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>

#include "core/base/random.h"
#include "core/phantom/scanner.h"
#include "core/phantom/spine.h"
#include "core/phantom/surroundings.h"
#include "tests/support/test_kind.h"

namespace spinaltap {
namespace {

using testing::Contains;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

double noise(std::uint64_t n, double sd_hu) {
  return sd_hu * (random_uniform(1, n) + random_uniform(2, n) + random_uniform(3, n) + random_uniform(4, n) - 2.0) *
         std::sqrt(3.0);
}

enum class Scene { body, cropped };

/// A body of muscle with fat around it, a vertebra of cortex and cancellous bone, and air; or only what is near the
/// bone.
CtVolume made_ct(Scene scene = Scene::body, double sd_hu = 15.0) {
  GridGeometry geometry;
  geometry.size = {64, 64, 24};
  geometry.spacing_mm = Vec3(2.0, 2.0, 2.0);
  std::vector<std::int16_t> hu(geometry.voxel_count());
  std::uint64_t n = 0;
  const double scale = scene == Scene::body ? 1.0 : 0.4;
  for (int k = 0; k < 24; ++k) {
    for (int j = 0; j < 64; ++j) {
      for (int i = 0; i < 64; ++i) {
        const double r = scale * std::hypot(i - 31.5, j - 31.5);
        const double value = r < 7.0    ? 180.0 + 120.0 * random_uniform(7, n)
                             : r < 9.0  ? 700.0 + 500.0 * random_uniform(8, n)
                             : r < 24.0 ? 50.0
                             : r < 28.0 ? -100.0
                                        : -1000.0;
        hu[n] = static_cast<std::int16_t>(std::lround(value + noise(n, sd_hu)));
        ++n;
      }
    }
  }
  return make_ct_volume(geometry, std::move(hu));
}

CtVolume mapped(const CtVolume& ct, const std::function<double(double)>& change) {
  std::vector<std::int16_t> hu = ct.hu;
  for (std::int16_t& value : hu) {
    value = static_cast<std::int16_t>(std::lround(std::clamp(change(value), -32768.0, 32767.0)));
  }
  return make_ct_volume(ct.geometry, std::move(hu));
}

SLOW_TESTS("HuCheck.SaysNothingOfPhantomsOfManySeedsKernelsAndFields");

TEST(HuCheck, SaysNothingOfHounsfieldUnits) {
  for (const double sd_hu : {3.0, 15.0, 60.0}) {
    for (const Scene scene : {Scene::body, Scene::cropped}) {
      const CtVolume ct = made_ct(scene, sd_hu);
      EXPECT_THAT(check_hu(ct).warnings, IsEmpty()) << sd_hu;
      EXPECT_THAT(check_hu(mapped(ct, [](double v) { return std::clamp(v, -1024.0, 3071.0); })).warnings, IsEmpty());
    }
  }
  EXPECT_TRUE(check_hu(made_ct()).shows_tissue);
}

TEST(HuCheck, SaysNothingOfPhantomsOfManySeedsKernelsAndFields) {
  const std::array<double, 4> kBlurMm{0.0, 0.35, 0.8, 1.2}, kNoiseHu{3.0, 12.0, 30.0, 60.0};
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    SpineOptions body;
    body.first = level_from_name(seed % 2 == 0 ? "T8" : "L2").value();
    body.last = level_from_name(seed % 2 == 0 ? "T9" : "L3").value();
    const Spine spine(body);
    const SoftTissue tissue(spine, {.seed = seed});
    const ScanOptions options{.pixel_mm = 1.5,
                              .slice_step_mm = 3.0,
                              .blur_mm = kBlurMm[seed % 4],
                              .noise_hu = kNoiseHu[seed / 4 % 4],
                              .seed = seed,
                              .samples_per_pixel = 1,
                              .samples_per_step = 1};
    // A trunk with air behind it, and a field of view that shows the spine alone.
    for (const double half_mm : {120.0, 45.0}) {
      const Vec3 half(half_mm, half_mm, 25.0);
      const CtVolume ct = scan(spine, tissue, scan_of_box(Box3(-half, half), options));
      EXPECT_THAT(check_hu(ct).warnings, IsEmpty()) << "seed " << seed << ", " << half_mm << " mm";
    }
  }
}

TEST(HuCheck, SaysNothingOfMaskedCts) {
  for (const Scene scene : {Scene::body, Scene::cropped}) {
    for (const double outside : {0.0, -1024.0, -2048.0, -3024.0}) {
      for (const double least : {-200.0, 20.0, 150.0, 300.0}) {
        const CtVolume ct = mapped(made_ct(scene), [&](double v) { return v < least ? outside : v; });
        EXPECT_THAT(check_hu(ct).warnings, IsEmpty()) << outside << " outside of what is above " << least;
      }
    }
  }
}

TEST(HuCheck, SaysNothingOfMetal) {
  std::uint64_t n = 0;
  const CtVolume ct =
      mapped(made_ct(), [&](double v) { return ++n % 40 == 0 ? 8000.0 + 24000.0 * random_uniform(5, n) : v; });
  EXPECT_THAT(check_hu(ct).warnings, IsEmpty());
}

TEST(HuCheck, NamesTheLikelyCause) {
  struct Kind {
    const char* words;
    std::function<double(double)> change;
    bool needs_fat = false;  ///< what is cropped to muscle and bone does not show it
  };
  const std::vector<Kind> kinds{
      {"+ 1024", [](double v) { return v + 1024.0; }},
      {"+ 1024", [](double v) { return v + 1000.0; }},
      {"+ 1024", [](double v) { return std::max(v + 1024.0, 0.0); }},
      {"- 1024", [](double v) { return v - 1024.0; }},
      {"8 bits", [](double v) { return std::clamp((v + 1024.0) / 16.0, 0.0, 255.0); }},
      {"8 bits", [](double v) { return 255.0 * std::clamp((v + 200.0) / 800.0, 0.0, 1.0); }},
      {"scaled to 1", [](double v) { return std::clamp((v + 1024.0) / 4096.0, 0.0, 1.0); }},
      {"label map", [](double v) { return v > 150.0 ? 22.0 : 0.0; }},
      {"label map", [](double v) { return (v - 50.0) / 300.0; }},
      {"window", [](double v) { return std::clamp(v, -160.0, 240.0); }},
      {"window", [](double v) { return std::clamp(v, -100.0, 800.0); }, true},
      {"offset", [](double v) { return v + 8192.0; }},
      {"offset", [](double v) { return v < 0.0 ? 32767.0 : v; }, true},
      {"/ 10", [](double v) { return v / 10.0; }},
      {"scaled", [](double v) { return 4095.0 * std::clamp((v + 1000.0) / 3000.0, 0.0, 1.0); }},
      {"x 10", [](double v) { return 10.0 * v; }},
  };
  for (const Kind& kind : kinds) {
    EXPECT_THAT(check_hu(mapped(made_ct(), kind.change)).warnings, Contains(HasSubstr(kind.words))) << kind.words;
    if (kind.needs_fat) continue;
    EXPECT_THAT(check_hu(mapped(made_ct(Scene::cropped), kind.change)).warnings, SizeIs(1)) << kind.words;
  }
}

TEST(HuCheck, FindsSlicesThatDisagreeByAnOffset) {
  for (const double offset : {1000.0, 1024.0, -1024.0, 8192.0}) {
    CtVolume ct = made_ct();
    const std::size_t slice = ct.geometry.offset(0, 0, 1);
    for (std::size_t n = 10 * slice; n < 11 * slice; ++n) ct.hu[n] = static_cast<std::int16_t>(ct.hu[n] + offset);
    EXPECT_THAT(check_hu(ct).warnings, Contains(HasSubstr("between slices 10 and 11"))) << offset;
  }
}

}  // namespace
}  // namespace spinaltap
