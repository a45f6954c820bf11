#include "apps/report/drill_report.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cctype>
#include <limits>

#include "apps/report/slice_figure.h"
#include "core/base/error.h"
#include "core/base/version.h"
#include "tests/unit/apps/report/balanced_html.h"
#include "tests/unit/apps/report/times_in.h"

namespace spinaltap {
namespace {

using test::expect_balanced;
using test::times_in;
using test::without_pictures;
using ::testing::HasSubstr;
using ::testing::Not;

CtVolume small_ct() {
  GridGeometry grid;
  grid.size = {40, 40, 20};
  grid.origin_mm = {-20, -20, -10};
  return make_ct_volume(grid, std::vector<std::int16_t>(grid.voxel_count(), 300));
}

DrillReportData full_data(const CtVolume& ct) {
  DrillReportData data;
  data.title = "L3";
  data.ct = &ct;
  data.path.name = "left pedicle";
  data.path.entry_mm = {8, 15, 2};
  data.path.target_mm = {2, -12, -1};
  data.bone_bounds_mm = Box3(Vec3(-18, -18, -9), Vec3(18, 18, 9));
  data.renders.resize(2);
  data.renders[0].image = Image{2, 1, {1, 2, 3, 4, 5, 6}};
  data.renders[0].caption = "before";
  data.renders[1].image = Image{1, 1, {7, 8, 9}};
  data.renders[1].caption = "after";
  for (int i = 0; i < 3000; ++i) {
    data.depth_mm.push_back(0.01 * i);
    data.hu.push_back(i < 10 ? std::numeric_limits<double>::quiet_NaN() : 300.0 + i % 7);
    data.density_g_cm3.push_back(0.3);
    data.thrust_n.push_back(5.0);
    data.cycles_per_s.push_back(1e6 / (1 + i));
    data.removed.push_back(i % 30);
  }
  data.figures = {{"Points", "986,958", ""}};
  data.notes = {"a note"};
  return data;
}

/// Whether a number was printed that is none.
bool shows_no_number(const std::string& html) {
  const auto is_letter = [&](std::size_t at) {
    return at < html.size() && std::islower(static_cast<unsigned char>(html[at])) != 0;
  };
  for (const char* word : {"nan", "inf"}) {
    for (std::size_t at = html.find(word); at != std::string::npos; at = html.find(word, at + 1)) {
      if (!(at > 0 && is_letter(at - 1)) && !is_letter(at + 3)) return true;
    }
  }
  return false;
}

TEST(DrillReport, ShowsEveryPart) {
  const CtVolume ct = small_ct();
  const std::string html = drill_report(full_data(ct));
  for (const char* part : {"Summary", "CT with the planned hole", "Axial, z = 0.5 mm", "Coronal, y = 1.5 mm",
                           "Sagittal, x = 5.0 mm", "Along the path", "before and after", "Thrust", "cycles per second",
                           "986,958", "a note", "not a medical device", version()}) {
    EXPECT_THAT(html, HasSubstr(part));
  }
  EXPECT_EQ(times_in(html, "<svg class=\"slice\""), 4U);
  EXPECT_EQ(times_in(html, "<svg class=\"plot\""), 5U);
  EXPECT_EQ(times_in(html, "<img "), 2U);
  expect_balanced(without_pictures(html));
}

TEST(DrillReport, IsTheSameForTheSameData) {
  const CtVolume ct = small_ct();
  EXPECT_EQ(drill_report(full_data(ct)), drill_report(full_data(ct)));
}

TEST(DrillReport, RefersToNothingOutsideAndRunsNoScript) {
  const CtVolume ct = small_ct();
  std::string html = without_pictures(drill_report(full_data(ct)));
  std::transform(html.begin(), html.end(), html.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  for (const char* part : {"http", "//", "<script", "<link", "@import", "url(", "javascript:", "onload"}) {
    EXPECT_THAT(html, Not(HasSubstr(part)));
  }
  for (const char* attribute : {" src=\"", " href=\""}) {
    EXPECT_EQ(times_in(html, attribute), times_in(html, std::string(attribute) + "data:image/png;")) << attribute;
  }
  EXPECT_FALSE(shows_no_number(html));
}

TEST(DrillReport, EscapesNamesFromFiles) {
  const std::string attack = "\"><script>alert('x')</script>";
  const CtVolume ct = small_ct();
  DrillReportData data = full_data(ct);
  data.title = attack;
  data.path.name = attack;
  data.renders[0].caption = attack;
  data.figures = {{attack, attack, attack}};
  data.notes = {attack};
  const std::string html = drill_report(data);
  EXPECT_THAT(html, Not(HasSubstr("<script")));
  EXPECT_THAT(html, Not(HasSubstr("\">&lt;")));
  EXPECT_GE(times_in(html, "&lt;script&gt;alert(&#39;x&#39;)"), 8U);
  expect_balanced(without_pictures(html));
}

TEST(DrillReport, LeavesOutPartsWithoutData) {
  DrillReportData data;
  data.path.target_mm = {0, -30, 0};
  const std::string html = drill_report(data);
  EXPECT_THAT(html, Not(HasSubstr("<svg")));
  EXPECT_THAT(html, Not(HasSubstr("<img")));
  EXPECT_THAT(html, HasSubstr("Summary"));
  expect_balanced(html);
}

TEST(DrillReport, ShowsLargeBoundsWithCoarserPixels) {
  const CtVolume ct = small_ct();
  DrillReportData data = full_data(ct);
  data.bone_bounds_mm = Box3(Vec3(-900, -900, -900), Vec3(900, 900, 900));
  EXPECT_EQ(times_in(drill_report(data), "<svg class=\"slice\""), 4U);
}

TEST(DrillReport, DrawsCurvesThatHoldNoFiniteValue) {
  DrillReportData data;
  data.path.target_mm = {0, -30, 0};
  const double nan = std::numeric_limits<double>::quiet_NaN();
  data.depth_mm = {0, 1, 2};
  data.hu = {nan, nan, nan};
  data.cycles_per_s = {nan, nan, nan};
  EXPECT_EQ(times_in(drill_report(data), "no data"), 2U);
}

TEST(DrillReport, PlotsHowWarmTheBoneBesideTheHoleGot) {
  DrillReportData data;
  data.path.target_mm = {0, -30, 0};
  data.depth_mm = {0, 1, 2};
  data.thrust_n = {1, 1, 1};
  data.temperature_c = {37.0, 48.3, 44.0};
  data.heat_distance_mm = 0.5;
  const std::string html = drill_report(data);
  EXPECT_THAT(html, HasSubstr("Hottest bone 0.50 mm from the wall"));
  EXPECT_THAT(html, HasSubstr("48.3"));
  data.temperature_c.assign(3, std::numeric_limits<double>::quiet_NaN());
  EXPECT_THAT(drill_report(data), Not(HasSubstr("from the wall")));
  data.temperature_c = {37.0};
  EXPECT_THROW(drill_report(data), Error);
}

TEST(DrillReport, RejectsCurvesOfAnotherLengthAndAPathWithoutLength) {
  DrillReportData data;
  EXPECT_THROW(drill_report(data), Error);
  data.path.target_mm = {0, -30, 0};
  data.depth_mm = {0, 1, 2};
  data.thrust_n = {1, 2};
  EXPECT_THROW(drill_report(data), Error);
}

TEST(SliceFigure, DrawsTheProjectionOnlyWhereThePlaneDoesNotHoldThePath) {
  const CtVolume ct = small_ct();
  const DrillReportData data = full_data(ct);
  const std::string along =
      slice_svg(ct_slice(ct, path_frame(data.path, data.bone_bounds_mm)), {.path = data.path}, "along");
  const Vec3 middle = 0.5 * (data.path.entry_mm + data.path.target_mm);
  const std::string coronal = slice_svg(ct_slice(ct, plane_frame(Plane::kCoronal, middle, data.bone_bounds_mm)),
                                        {.path = data.path}, "coronal");
  // Each outline is a dark polygon under a bright one.
  EXPECT_EQ(times_in(along, "<polygon"), 2U);
  EXPECT_EQ(times_in(coronal, "<polygon"), 4U);
  for (const char* text : {">Entry<", ">Target<", ">10 mm<", ">R<", ">L<", ">S<", ">I<"}) {
    EXPECT_THAT(coronal, HasSubstr(text));
  }
}

TEST(SliceFigure, DrawsTheHeadBehindTheThread) {
  const CtVolume ct = small_ct();
  DrillPath path = full_data(ct).path;
  path.screw = PedicleScrew{"", 5.0, 28.0, 4.0};
  const Box3 box(Vec3(-40, -40, -20), Vec3(40, 60, 20));
  const SliceFrame frame = path_frame(path, box);
  // Round below, then the tulip: two parts more, a dark and a bright polygon each.
  EXPECT_EQ(times_in(slice_svg(ct_slice(ct, frame), {.path = path}, ""), "<polygon"), 6U);
  const std::optional<BodyBehind> head = head_of(path);
  ASSERT_TRUE(head);
  double furthest_mm = 0.0, widest_mm = 0.0;
  const Vec3 along = path.direction();
  for (const ToolPart& part : tool_parts(head->outline)) {
    for (const Eigen::Vector2d& corner : part_section(frame, part, head->pose)) {
      const Vec3 place = frame.to_patient(Vec3(corner.x(), corner.y(), 0.0)) - path.target_mm;
      furthest_mm = std::max(furthest_mm, -place.dot(along));
      widest_mm = std::max(widest_mm, (place - place.dot(along) * along).norm());
    }
  }
  EXPECT_NEAR(furthest_mm, 28.0 + path.screw->head.length_mm, 1e-6) << "the tulip's end";
  // The plane holds the axis: the outline is the body's own, to a polygon of 96 corners around it.
  EXPECT_NEAR(widest_mm, 0.5 * path.screw->head.diameter_mm, 0.01);
  path.screw->head.diameter_mm = 0.0;
  EXPECT_EQ(times_in(slice_svg(ct_slice(ct, frame), {.path = path}, ""), "<polygon"), 2U);
}

TEST(SliceFigure, ReddensWhatOfTheToolLiesBeyondTheBone) {
  const CtVolume ct = small_ct();
  const DrillPath path{"left", Vec3(0, 15, 0), Vec3(0, -10, 0), DrillBit{4.0, 30.0, 4.0}};
  // Bone where x is below 1 mm: a strip of 1 mm of the bit stands out of it.
  const OutlinedBone bone{[](std::span<const Vec3> places, std::span<float> distances) {
    for (std::size_t n = 0; n < places.size(); ++n) distances[n] = static_cast<float>(places[n].x() - 1.0);
  }};
  const SliceFrame frame = cross_frame(path, 12.0, {10.0, 10.0}, 0.1);
  const auto red_share = [&](double from_mm) {
    const std::string svg = slice_svg(ct_slice(ct, frame), {.path = path, .bone = &bone, .red_from_mm = from_mm}, "");
    return svg.size();
  };
  // Grey pictures have one channel: a red one is larger. From deeper on nothing here counts.
  EXPECT_GT(red_share(5.0), red_share(20.0));
}

TEST(SliceFigure, RejectsAPictureThatDoesNotFitItsFrame) {
  const CtVolume ct = small_ct();
  const DrillReportData data = full_data(ct);
  CtSlice slice = ct_slice(ct, path_frame(data.path, data.bone_bounds_mm));
  slice.frame.width += 1;
  EXPECT_THROW(slice_svg(slice, {.path = data.path}, ""), Error);
}

}  // namespace
}  // namespace spinaltap
