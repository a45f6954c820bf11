// Compiled with optimisation: long loops of its own.

#include "core/segment/level_warnings.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <string>

namespace spinaltap {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;

/// Three bodies alike, 26 mm high with discs of 8 mm, from z = 0 up, and a canal 24 mm behind their middles. Cut out
/// whole, the middle one is as sound as a vertebra can be.
struct BodyColumn {
  std::vector<BodySpan> chain;
  std::vector<VertebralBody> bodies;
  SpinalCanal canal;
  LevelFigures figures;

  BodyColumn() {
    for (int n = 0; n < 3; ++n) {
      const double low_mm = 34.0 * n;
      BodySpan span;
      span.lower = {low_mm, Vec3(0.0, 0.0, low_mm), Vec3::UnitZ(), 0.9, false};
      span.upper = {low_mm + 26.0, Vec3(0.0, 0.0, low_mm + 26.0), Vec3::UnitZ(), 0.9, false};
      span.middle.centre_mm = Vec3(0.0, 0.0, low_mm + 13.0);
      span.middle.half_width_mm = 21.0;
      span.middle.half_depth_mm = 16.0;
      chain.push_back(span);
      BodyCylinder cylinder;
      cylinder.centre_mm = span.middle.centre_mm;
      cylinder.half_mm = Vec3(21.0, 16.0, 13.0);
      cylinder.fit = 0.6;
      bodies.push_back({cylinder, StarSurface(cylinder.centre_mm, 100)});
    }
    for (double z = 0.0; z <= 95.0; z += SpinalCanal::kStepMm) {
      canal.points_mm.push_back(Vec3(0.0, 24.0, z));
      canal.support.push_back(1.5);
    }
    figures.left_pedicle_mm2 = figures.right_pedicle_mm2 = 90.0;
    figures.canal_closed = 1.0;
    figures.behind_canal_mm = 45.0;
    figures.left_reach_mm = figures.right_reach_mm = 42.0;
    figures.bridges[0].mm2 = 30.0;
    figures.unsure_share = 0.04;
  }

  BodyInRow row(std::size_t own = 1) const { return {bodies, canal, own}; }
  std::vector<LevelWarning> warnings(std::size_t own = 1) const { return check_level(figures, chain, row(own)); }
};

std::string texts_of(const std::vector<LevelWarning>& warnings) {
  std::string all;
  for (const LevelWarning& warning : warnings) all += warning.text + "\n";
  return all;
}

TEST(LevelWarnings, SaysNothingOfASoundVertebra) {
  const BodyColumn column;
  for (const std::size_t own : {0U, 1U, 2U}) EXPECT_EQ(texts_of(column.warnings(own)), "") << "body " << own;
  EXPECT_EQ(total_severity(column.warnings()), 0.0);
}

TEST(LevelWarnings, SaysNothingWhereNeighboursDifferAsThoseOfOneSpineDo) {
  BodyColumn column;
  column.bodies[0].cylinder.half_mm *= 1.12;  // more than from one level to the next in any spine
  column.bodies[2].cylinder.half_mm *= 0.9;
  column.figures.left_share = 0.53;
  column.figures.left_reach_mm = 46.0;
  EXPECT_EQ(texts_of(column.warnings()), "");
}

void bridge(BodyColumn& column, Contact contact) {
  column.figures.bridges[static_cast<std::size_t>(contact)].mm2 = 30.0;
}

struct Spoilt {
  const char* what;
  std::function<void(BodyColumn&)> spoil;
  const char* says;  ///< part of the one warning
  bool is_suspect;
};

void PrintTo(const Spoilt& spoilt, std::ostream* out) { *out << spoilt.what; }

class SuspectLevel : public ::testing::TestWithParam<Spoilt> {};

TEST_P(SuspectLevel, IsWarnedOfInWordsWithTheFigure) {
  BodyColumn column;
  GetParam().spoil(column);
  const std::vector<LevelWarning> warnings = column.warnings();
  EXPECT_THAT(texts_of(warnings), HasSubstr(GetParam().says));
  EXPECT_EQ(total_severity(warnings) >= kSuspect, GetParam().is_suspect) << texts_of(warnings);
  for (const LevelWarning& warning : warnings) {
    EXPECT_GT(warning.severity, 0.0);
    EXPECT_LE(warning.severity, 1.0);
  }
}

INSTANTIATE_TEST_SUITE_P(
    Kinds, SuspectLevel,
    ::testing::Values(
        Spoilt{"no upper endplate", [](BodyColumn& c) { c.chain[1].upper.edge = 0.02; }, "upper endplate is weak",
               true},
        Spoilt{"no lower endplate", [](BodyColumn& c) { c.chain[1].lower.edge = 0.02; }, "lower endplate is weak",
               true},
        Spoilt{"cut by the border", [](BodyColumn& c) { c.chain[1].upper.is_cut = true; }, "goes on beyond the CT",
               false},
        Spoilt{"two bodies as one", [](BodyColumn& c) { c.bodies[1].cylinder.half_mm.z() = 30.0; }, "as high as deep",
               true},
        Spoilt{"half a body", [](BodyColumn& c) { c.bodies[1].cylinder.half_mm.z() = 5.5; }, "as high as deep", true},
        Spoilt{"body and rib's head", [](BodyColumn& c) { c.bodies[1].cylinder.half_mm.x() = 35.0; },
               "times as wide as its", true},
        Spoilt{"half a body's depth", [](BodyColumn& c) { c.bodies[1].cylinder.half_mm.y() = 9.0; },
               "times as deep as its", true},
        Spoilt{"a missing body",
               [](BodyColumn& c) {
                 c.chain[2].lower.centre_mm.z() += 34.0;
                 c.chain[2].upper.centre_mm.z() += 34.0;
                 c.bodies[2].cylinder.centre_mm.z() += 34.0;
               },
               "a body may be missing there", true},
        Spoilt{"no wall", [](BodyColumn& c) { c.bodies[1].cylinder.fit = 0.1; }, "wall is faint", true},
        Spoilt{"no left pedicle", [](BodyColumn& c) { c.figures.left_pedicle_mm2 = 4.0; }, "the left pedicle", true},
        Spoilt{"no right pedicle", [](BodyColumn& c) { c.figures.right_pedicle_mm2 = 4.0; }, "the right pedicle", true},
        Spoilt{"an open arch", [](BodyColumn& c) { c.figures.canal_closed = 0.8; }, "around the canal", true},
        Spoilt{"no spinous process", [](BodyColumn& c) { c.figures.behind_canal_mm = 10.0; },
               "spinous process is missing", true},
        Spoilt{"much to the left", [](BodyColumn& c) { c.figures.left_share = 0.62; }, "lie to the left", true},
        Spoilt{"little to the left", [](BodyColumn& c) { c.figures.left_share = 0.38; }, "lie to the left", true},
        Spoilt{"a rib left on", [](BodyColumn& c) { c.figures.right_reach_mm = 58.0; }, "a rib may have stayed on",
               true},
        Spoilt{"bone beside the body",
               [](BodyColumn& c) { c.figures.bridges[static_cast<std::size_t>(Contact::beside)].mm2 = 230.0; },
               "no gap shows over 230", true},
        // Thin discs close in coarse CTs, and the bodies are right.
        Spoilt{"a body that touches the one above",
               [](BodyColumn& c) { c.figures.bridges[static_cast<std::size_t>(Contact::body_above)].mm2 = 800.0; },
               "no gap shows over 800 mm2 between it and the body above", false},
        Spoilt{"a body that touches both",
               [](BodyColumn& c) {
                 c.figures.bridges[static_cast<std::size_t>(Contact::body_above)].mm2 = 800.0;
                 c.figures.bridges[static_cast<std::size_t>(Contact::body_below)].mm2 = 800.0;
               },
               "no gap shows over 800 mm2 between it and the body below", false},
        Spoilt{"a body that touches where its endplate is weak",
               [](BodyColumn& c) {
                 c.figures.bridges[static_cast<std::size_t>(Contact::body_above)].mm2 = 800.0;
                 c.chain[1].upper.edge = 0.15;
               },
               "the upper endplate is weak", true},
        Spoilt{"a spinous process beyond the CT",
               [](BodyColumn& c) {
                 c.figures.behind_canal_mm = 10.0;
                 c.figures.is_cut_behind = true;
               },
               "at the CT's border: the spinous process is cut there", false},
        Spoilt{"a transverse process beyond the CT",
               [](BodyColumn& c) {
                 c.figures.left_reach_mm = 20.0;
                 c.figures.left_share = 0.38;
                 c.figures.is_cut_left = true;
               },
               "on one side to the CT's border", false},
        Spoilt{"a transverse process too short where the other one is beyond the CT",
               [](BodyColumn& c) {
                 c.figures.left_reach_mm = 20.0;
                 c.figures.is_cut_right = true;
               },
               "a process be cut off", true},
        Spoilt{"a bridged joint", [](BodyColumn& c) { bridge(c, Contact::upper_left); }, "above, in the left joint",
               false},
        Spoilt{"another", [](BodyColumn& c) { bridge(c, Contact::upper_right); }, "above, in the right joint", false},
        Spoilt{"a third", [](BodyColumn& c) { bridge(c, Contact::lower_left); }, "below, in the left joint", false},
        Spoilt{"a fourth", [](BodyColumn& c) { bridge(c, Contact::lower_right); }, "below, in the right joint", false},
        Spoilt{"a fused rib", [](BodyColumn& c) { bridge(c, Contact::left_rib); }, "the left rib", false},
        Spoilt{"another rib", [](BodyColumn& c) { bridge(c, Contact::right_rib); }, "the right rib", false},
        // A guess at its joints leaves most of a vertebra right.
        Spoilt{"all joints bridged",
               [](BodyColumn& c) {
                 for (const Contact contact :
                      {Contact::upper_left, Contact::upper_right, Contact::lower_left, Contact::lower_right}) {
                   bridge(c, contact);
                 }
               },
               "in the right joint", false},
        Spoilt{"all joints bridged, and a piece too much",
               [](BodyColumn& c) {
                 for (auto n = static_cast<std::size_t>(Contact::upper_left); n < kContacts; ++n) {
                   c.figures.bridges[n].mm2 = 30.0;
                 }
                 c.figures.lopsided_mm3 = 600.0;
               },
               "in the right joint", true},
        Spoilt{"whose is it", [](BodyColumn& c) { c.figures.unsure_share = 0.4; }, "unsure whose", true},
        Spoilt{"metal", [](BodyColumn& c) { c.figures.metal_mm3 = 400.0; }, "metal", true},
        Spoilt{"cement", [](BodyColumn& c) { c.figures.cement_mm3 = 2000.0; }, "as of cement", true}));

TEST(LevelWarnings, TellWhereTheCanalGoesOnBeyondTheOutermostBodies) {
  BodyColumn column;
  for (double z = 97.5; z <= 125.0; z += SpinalCanal::kStepMm) {
    column.canal.points_mm.push_back(Vec3(0.0, 24.0, z));
    column.canal.support.push_back(1.5);
  }
  EXPECT_THAT(texts_of(column.warnings(2)), HasSubstr("a vertebra may be missing"));
  EXPECT_EQ(texts_of(column.warnings(1)), "");
  EXPECT_EQ(texts_of(column.warnings(0)), "");
}

TEST(LevelWarnings, OfACrushedBodyAreItsOwn) {
  BodyColumn column;
  column.bodies[1].cylinder.half_mm.z() *= 0.6;
  EXPECT_THAT(texts_of(column.warnings(1)), HasSubstr("times as high as its"));
  column = BodyColumn();
  column.bodies[2].cylinder.half_mm.z() *= 0.6;
  EXPECT_EQ(texts_of(column.warnings(1)), "");
}

TEST(LevelWarnings, AddsSmallWarningsUp) {
  EXPECT_EQ(total_severity({}), 0.0);
  EXPECT_NEAR(total_severity({{"a", 0.3}, {"b", 0.3}}), 1.0 - 0.7 * 0.7, 1e-12);
  EXPECT_EQ(total_severity({{"a", 1.0}, {"b", 0.2}}), 1.0);
}

/// Part of a CT with the middle body of BodyColumn, two pedicles of 9 x 14 mm and a closed arch around the canal; on a
/// grid of 1 mm whose voxels lie `from_mm` beside the canal's middle along y.
struct DrawnLevel {
  LevelCut cut;
  std::vector<std::uint8_t> mine;
  std::vector<std::uint8_t> others;

  CutMasks masks() const { return {.finished = mine, .given = mine, .others = others}; }

  explicit DrawnLevel(const BodyCylinder& body, double from_mm = 0.5) {
    GridGeometry& geometry = cut.geometry;
    geometry.size = {101, 102, 61};
    geometry.origin_mm = body.centre_mm + Vec3(-50.0, -30.0 - from_mm, -30.0);
    cut.box.high = {100, 101, 60};
    const std::size_t count = geometry.voxel_count();
    cut.brightness.assign(count, Brightness::kBone);
    cut.peak_hu.assign(count, 60.0F);
    cut.depth_mm.assign(count, -1.0F);
    cut.bone.assign(count, 0);
    cut.ribs.assign(count, 0);
    cut.markers.assign(count, WalkerVoxel::kFree);
    cut.conductivity.assign(count, 1.0F);
    cut.probability.assign(count, 0.0F);
    mine.assign(count, 0);
    others.assign(count, 0);
    draw(body, [](const Vec3& p) { return std::hypot(p.x() / 21.0, p.y() / 16.0) < 1.0 && std::abs(p.z()) < 13.0; });
    for (const double side : {-1.0, 1.0}) {
      draw(body, [side](const Vec3& p) {
        return std::abs(p.x() - side * 14.0) < 4.5 && std::abs(p.z()) < 7.0 && p.y() > 0.0 && p.y() < 33.0;
      });
    }
    draw(body, [](const Vec3& p) {  // laminae, and the spinous process to 45 mm behind the canal's middle
      const bool lamina = std::abs(p.x()) < 18.5 && p.y() > 30.0 && p.y() < 36.0 && std::abs(p.z()) < 7.0;
      const bool spinous = std::abs(p.x()) < 3.0 && p.y() > 30.0 && p.y() < 69.0 && std::abs(p.z()) < 7.0;
      return lamina || spinous;
    });
  }

  /// Adds what `in` says, in the body's frame, or takes it away.
  void draw(const BodyCylinder& body, const std::function<bool(const Vec3&)>& in, bool add = true) {
    const GridGeometry& geometry = cut.geometry;
    for (int k = 0; k < geometry.size[2]; ++k) {
      for (int j = 0; j < geometry.size[1]; ++j) {
        for (int i = 0; i < geometry.size[0]; ++i) {
          const std::size_t voxel = geometry.offset(i, j, k);
          if (!in(geometry.to_patient(Vec3(i, j, k)) - body.centre_mm)) continue;
          mine[voxel] = cut.bone[voxel] = add ? 1 : 0;
          cut.probability[voxel] = add ? 1.0F : 0.0F;
        }
      }
    }
    // Without bone no walker passes.
    for (std::size_t v = 0; v < mine.size(); ++v) {
      cut.markers[v] = cut.bone[v] != 0 ? WalkerVoxel::kFree : WalkerVoxel::kOutside;
    }
  }
};

TEST(MeasureLevel, MeasuresAFigureOfKnownSize) {
  const BodyColumn column;
  const DrawnLevel level(column.bodies[1].cylinder);
  const LevelFigures figures = measure_level(level.cut, level.masks(), column.row());
  EXPECT_NEAR(figures.left_pedicle_mm2, 9.0 * 13.0, 20.0);  // voxels of 1 mm, 13 of them less than 7 mm from the middle
  EXPECT_NEAR(figures.right_pedicle_mm2, figures.left_pedicle_mm2, 1e-9);
  EXPECT_NEAR(figures.left_share, 0.5, 0.02);  // the middle column of voxels is neither's
  EXPECT_EQ(figures.canal_closed, 1.0);
  EXPECT_NEAR(figures.behind_canal_mm, 44.0, 1.0);
  EXPECT_NEAR(figures.left_reach_mm, 21.0, 1.0);
  EXPECT_NEAR(figures.right_reach_mm, 21.0, 1.0);
  for (const Bridge& bridge : figures.bridges) EXPECT_EQ(bridge.mm2, 0.0);
  EXPECT_EQ(figures.lopsided_mm3, 0.0);
  EXPECT_EQ(figures.unsure_share, 0.0);
  EXPECT_EQ(figures.metal_mm3, 0.0);
  EXPECT_EQ(figures.cement_mm3, 0.0);
  EXPECT_THAT(check_level(figures, column.chain, column.row()), IsEmpty());
}

TEST(MeasureLevel, MeasuresPediclesWhereverTheGridBegins) {
  const BodyColumn column;
  for (const double from_mm : {0.1, 0.3, 0.5, 0.7, 0.9}) {
    const DrawnLevel level(column.bodies[1].cylinder, from_mm);
    const LevelFigures figures = measure_level(level.cut, level.masks(), column.row());
    EXPECT_NEAR(figures.left_pedicle_mm2, 9.0 * 13.0, 20.0) << "voxels from " << from_mm << " mm";
  }
}

TEST(MeasureLevel, MissesAPedicleThatIsCutThrough) {
  const BodyColumn column;
  DrawnLevel level(column.bodies[1].cylinder);
  level.draw(
      column.bodies[1].cylinder, [](const Vec3& p) { return p.x() > 8.0 && std::abs(p.y() - 24.0) < 5.5; }, false);
  const LevelFigures figures = measure_level(level.cut, level.masks(), column.row());
  EXPECT_EQ(figures.left_pedicle_mm2, 0.0);
  EXPECT_GT(figures.right_pedicle_mm2, 90.0);
  EXPECT_LT(figures.canal_closed, 1.0);
  EXPECT_GE(total_severity(check_level(figures, column.chain, column.row())), kSuspect);
}

TEST(MeasureLevel, CountsMetalAndALumpOfCement) {
  const BodyColumn column;
  const BodyCylinder& body = column.bodies[1].cylinder;
  DrawnLevel level(body);
  const GridGeometry& geometry = level.cut.geometry;
  for (int k = 0; k < geometry.size[2]; ++k) {
    for (int j = 0; j < geometry.size[1]; ++j) {
      for (int i = 0; i < geometry.size[0]; ++i) {
        const std::size_t voxel = geometry.offset(i, j, k);
        const Vec3 p = geometry.to_patient(Vec3(i, j, k)) - body.centre_mm;
        if (std::hypot(p.x() / 21.0, p.y() / 16.0) < 1.0 && std::abs(p.z()) < 13.0) level.cut.depth_mm[voxel] = 6.0F;
        if (p.cwiseAbs().maxCoeff() < 5.5) level.cut.brightness[voxel] = Brightness::kCement;
        if (std::abs(p.x() - 14.0) < 2.5 && std::abs(p.y() - 20.0) < 5.5 && std::abs(p.z()) < 2.5) {
          level.cut.brightness[voxel] = Brightness::kMetal;
        }
      }
    }
  }
  const LevelFigures figures = measure_level(level.cut, level.masks(), column.row());
  EXPECT_NEAR(figures.cement_mm3, 11.0 * 10.0 * 11.0, 1e-6);
  EXPECT_NEAR(figures.metal_mm3, 5.0 * 10.0 * 5.0, 1e-6);
  const std::string texts = texts_of(check_level(figures, column.chain, column.row()));
  EXPECT_THAT(texts, HasSubstr("metal"));
  EXPECT_THAT(texts, HasSubstr("cement"));
}

TEST(MeasureLevel, AddsUpTheBoneThatACutGoesThrough) {
  const BodyColumn column;
  DrawnLevel level(column.bodies[1].cylinder);
  // A bar of another bone, 5 x 13 mm, goes on from the tip of the spinous process, at a quarter of bone's conductivity.
  const GridGeometry& geometry = level.cut.geometry;
  for (int k = 0; k < geometry.size[2]; ++k) {
    for (int j = 0; j < geometry.size[1]; ++j) {
      for (int i = 0; i < geometry.size[0]; ++i) {
        const Vec3 p = geometry.to_patient(Vec3(i, j, k)) - column.bodies[1].cylinder.centre_mm;
        const std::size_t voxel = geometry.offset(i, j, k);
        if (p.y() < 69.0 || std::abs(p.x()) > 2.5 || std::abs(p.z()) > 6.5) continue;
        level.cut.bone[voxel] = 1;
        level.cut.markers[voxel] = WalkerVoxel::kOther;
        level.cut.conductivity[voxel] = 0.25F;
      }
    }
  }
  const auto mm2 = [&](Contact contact) {
    return measure_level(level.cut, level.masks(), column.row()).bridges[static_cast<std::size_t>(contact)].mm2;
  };
  // Two of its five columns of voxels lie to the left of the middle, six of its thirteen layers above it.
  EXPECT_NEAR(mm2(Contact::left_rib), 0.25 * 2.0 * 13.0, 1e-6);
  EXPECT_NEAR(mm2(Contact::right_rib), 0.25 * 3.0 * 13.0, 1e-6);
  EXPECT_EQ(mm2(Contact::upper_left), 0.0);
  level.others.assign(level.others.size(), 1);
  EXPECT_NEAR(mm2(Contact::upper_left), 0.25 * 2.0 * 6.0, 1e-6);
  EXPECT_NEAR(mm2(Contact::upper_right), 0.25 * 3.0 * 6.0, 1e-6);
  EXPECT_NEAR(mm2(Contact::lower_left), 0.25 * 2.0 * 7.0, 1e-6);
  EXPECT_NEAR(mm2(Contact::lower_right), 0.25 * 3.0 * 7.0, 1e-6);
  EXPECT_EQ(mm2(Contact::left_rib), 0.0);
  for (const Contact contact : {Contact::body_above, Contact::body_below, Contact::beside}) {
    EXPECT_EQ(mm2(contact), 0.0);
  }
}

TEST(MeasureLevel, TellsABodyThatTouchesFromBoneBesideIt) {
  const BodyColumn column;
  const BodyCylinder& body = column.bodies[1].cylinder;
  DrawnLevel level(body);
  // All bone that is above the body or at its side is another's.
  const GridGeometry& geometry = level.cut.geometry;
  for (int k = 0; k < geometry.size[2]; ++k) {
    for (int j = 0; j < geometry.size[1]; ++j) {
      for (int i = 0; i < geometry.size[0]; ++i) {
        const Vec3 p = geometry.to_patient(Vec3(i, j, k)) - body.centre_mm;
        const std::size_t voxel = geometry.offset(i, j, k);
        const bool is_above = p.z() > 12.2 && std::abs(p.x()) < 5.5 && std::abs(p.y()) < 5.5;
        const bool is_beside = p.x() > 19.8 && std::abs(p.y()) < 2.5 && std::abs(p.z()) < 2.5;
        if (!(is_above || is_beside) || level.mine[voxel] != 0) continue;
        level.cut.markers[voxel] = WalkerVoxel::kOther;
        level.cut.conductivity[voxel] = 1.0F;
        level.others[voxel] = is_above ? 1 : 0;
      }
    }
  }
  const LevelFigures figures = measure_level(level.cut, level.masks(), column.row());
  const auto mm2 = [&](Contact contact) { return figures.bridges[static_cast<std::size_t>(contact)].mm2; };
  EXPECT_NEAR(mm2(Contact::body_above), 11.0 * 11.0, 23.0);
  EXPECT_EQ(mm2(Contact::body_below), 0.0);
  EXPECT_GT(mm2(Contact::beside), 15.0);
  EXPECT_LT(mm2(Contact::beside), 40.0);
}

TEST(CheckVoxels, SaysWhereArchesCannotBeParted) {
  EXPECT_THAT(check_voxels(Vec3(0.8, 0.8, 2.5)), IsEmpty());
  EXPECT_THAT(check_voxels(Vec3(3.0, 3.0, 3.0)), IsEmpty());
  const std::vector<LevelWarning> thick = check_voxels(Vec3(0.8, 0.8, 5.0));
  ASSERT_EQ(thick.size(), 1U);
  EXPECT_GE(thick[0].severity, kSuspect);
  EXPECT_THAT(thick[0].text, HasSubstr("the CT's voxels are 5 mm long"));
  EXPECT_GE(check_voxels(Vec3(4.0, 1.0, 1.0)).at(0).severity, kSuspect);
}

TEST(FindBorder, TellsWhereAVertebraReachesIt) {
  const BodyColumn column;
  const BodyCylinder& body = column.bodies[1].cylinder;
  // The CT ends 20 mm to the right of the body's middle, 60 mm to the left, in front and above, and 50 mm behind.
  GridGeometry ct;
  ct.origin_mm = body.centre_mm - Vec3(20.0, 60.0, 60.0);
  ct.size = {81, 111, 121};
  const auto border_of = [&](const std::function<bool(const Vec3&)>& in) {
    const VoxelBox box{{0, 0, 0}, {ct.size[0] - 1, ct.size[1] - 1, ct.size[2] - 1}};
    std::vector<std::uint8_t> inside;
    for (int k = 0; k < ct.size[2]; ++k) {
      for (int j = 0; j < ct.size[1]; ++j) {
        for (int i = 0; i < ct.size[0]; ++i)
          inside.push_back(in(ct.to_patient(Vec3(i, j, k)) - body.centre_mm) ? 1 : 0);
      }
    }
    LevelFigures figures;
    const bool reaches = find_border(ct, box, inside, column.row(), figures);
    return std::array{reaches, figures.is_cut_behind, figures.is_cut_left, figures.is_cut_right};
  };
  const auto within = [](double x, double y, double z) {
    return [=](const Vec3& p) { return std::abs(p.x()) < x && std::abs(p.y()) < y && std::abs(p.z()) < z; };
  };
  EXPECT_EQ(border_of(within(15.0, 30.0, 10.0)), (std::array{false, false, false, false}));
  EXPECT_EQ(border_of(within(45.0, 30.0, 10.0)), (std::array{true, false, false, true}));
  EXPECT_EQ(border_of(within(3.0, 55.0, 10.0)), (std::array{true, true, false, false}));
  // One voxel may be noise's.
  EXPECT_EQ(border_of([](const Vec3& p) { return p.y() > 49.5 && p.norm() < 50.005; }),
            (std::array{true, false, false, false}));
}

TEST(MeasureLevel, FindsThePieceThatOneSideLacks) {
  const BodyColumn column;
  const BodyCylinder& body = column.bodies[1].cylinder;
  DrawnLevel level(body);
  // A superior articular process, on the left only.
  level.draw(body, [](const Vec3& p) {
    return std::abs(p.x() - 14.0) < 4.5 && std::abs(p.y() - 30.0) < 4.5 && p.z() > 7.0 && p.z() < 22.0;
  });
  const LevelFigures figures = measure_level(level.cut, level.masks(), column.row());
  EXPECT_NEAR(figures.lopsided_mm3, 9.0 * 9.0 * 11.5, 100.0);  // all but what is nearer than 4 mm to the right pedicle
  EXPECT_LT((figures.lopsided_at_mm - (body.centre_mm + Vec3(14.0, 30.0, 16.0))).norm(), 1.5);
}

}  // namespace
}  // namespace spinaltap
