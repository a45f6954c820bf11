#include "apps/report/label_place.h"

#include <gtest/gtest.h>

namespace spinaltap {
namespace {

using Rectangle = LabelPlacer::Rectangle;

bool overlap(const Rectangle& a, const Rectangle& b) {
  const Rectangle common = a.intersection(b);
  return !common.isEmpty() && common.volume() > 1e-9;
}

TEST(LabelPlacer, KeepsLabelsApartAndInThePicture) {
  const Rectangle picture(Eigen::Vector2d(0, 0), Eigen::Vector2d(400, 300));
  LabelPlacer placer(picture);
  const Rectangle bar(Eigen::Vector2d(10, 280), Eigen::Vector2d(100, 300));
  placer.avoid(bar);
  const Eigen::Vector2d size(60, 18);
  const Rectangle first = placer.place({30, 290}, size);
  const Rectangle second = placer.place({34, 288}, size);
  const Rectangle third = placer.place({395, 5}, size);
  for (const Rectangle& label : {first, second, third}) {
    const Eigen::Vector2d rounding(1e-9, 1e-9);
    EXPECT_TRUE(Rectangle(picture.min() - rounding, picture.max() + rounding).contains(label));
    EXPECT_FALSE(overlap(label, bar));
  }
  EXPECT_FALSE(overlap(first, second));
}

TEST(LabelPlacer, KeepsOffTheBit) {
  LabelPlacer placer({Eigen::Vector2d(0, 0), Eigen::Vector2d(400, 300)});
  placer.avoid_shape({{200, 140}, {400, 140}, {400, 160}, {200, 160}});
  const Rectangle label = placer.place({200, 150}, {60, 18});
  EXPECT_FALSE(overlap(label, {Eigen::Vector2d(200, 140), Eigen::Vector2d(400, 160)}));
}

TEST(LabelPlacer, CountsCharactersAndNotBytes) { EXPECT_EQ(text_width("µm³", 10.0), text_width("mmm", 10.0)); }

}  // namespace
}  // namespace spinaltap
