// One vertebra out of real CTs, from one seed point; see tests/support/test_data.h for where they lie.

#include <gtest/gtest.h>

#include <algorithm>

#include "core/ct/dicom_read.h"
#include "core/ct/label_map.h"
#include "core/segment/detail/connected_parts.h"
#include "core/segment/float_grid.h"
#include "core/segment/segment_spine.h"
#include "tests/support/mask_overlap.h"
#include "tests/support/test_data.h"

namespace spinaltap {
namespace {

TEST(SegmentRealCt, L3AgreesWithItsLabelMapFromAnySeedInItsBody) {
  SPINALTAP_NEED_TEST_DATA(folder, "L3_ct_1.5mm")
  const CtVolume ct = read_dicom(folder / "dicom");
  const BoneMask label = read_label_map(folder / "sub-ct_seg-vert_label-22_msk.nii.gz", 22, ct.geometry);
  // The middle; near the left wall; near the front; near the back.
  for (const Vec3& seed_mm :
       {Vec3(24.0, 165.0, -66.0), Vec3(40.0, 165.0, -72.0), Vec3(24.0, 148.0, -60.0), Vec3(24.0, 172.0, -66.0)}) {
    const Segmentation found = segment_vertebra(ct, {.seed_mm = seed_mm});
    const double dice = test::dice(found.mask, label);
    const double mean_mm = test::mean_surface_distance_mm(found.mask, label);
    std::printf("L3 from (%.0f, %.0f, %.0f): Dice %.3f, mean surface distance %.2f mm\n", seed_mm.x(), seed_mm.y(),
                seed_mm.z(), dice, mean_mm);
    EXPECT_GE(dice, 0.90);
    EXPECT_LE(mean_mm, 0.75);
  }
}

/// T11 and what lies around it. Voxels (column, row, slice from the bottom) were read off the CT's slices.
class SegmentT11 : public ::testing::Test {
 protected:
  void find(const std::optional<Vec3>& seed_mm) {
    SPINALTAP_NEED_TEST_DATA(folder, "T11_ct_0.78mm")
    ct_ = read_dicom(folder / "dicom");
    found_ = segment_vertebra(ct_, {.seed_mm = seed_mm});
    std::printf("T11: %.0f mm3, cut over %.0f mm2\n", volume_mm3(), found_.report.cut_area_mm2);
  }

  double volume_mm3() const {
    const auto voxels = std::count(found_.mask.inside.begin(), found_.mask.inside.end(), std::uint8_t{1});
    return static_cast<double>(voxels) * ct_.geometry.spacing_mm.prod();
  }

  struct Place {
    const char* name;
    int column, row, slice;
  };

  void expect_anatomy() const {
    // Rows before 376 lie in front of the canal: T11's body fills slices 29 to 53, its tilted rims a few more.
    const BoneMask& mask = found_.mask;
    for (int k = 0; k < 70; ++k) {
      int in_body = 0;
      for (int j = 0; j < 376; ++j) {
        for (int i = 0; i < 512; ++i) in_body += mask.at(i, j, k) ? 1 : 0;
      }
      if (k >= 32 && k <= 50) {
        EXPECT_GT(in_body, 1000) << "of about 1400 voxels of the body in slice " << k;
      }
      if (k <= 23 || k >= 60) {
        EXPECT_EQ(in_body, 0) << "T12 or T10 in slice " << k;
      }
    }
    for (const Place& p :
         {Place{"tip of the spinous process", 243, 410, 18}, Place{"right transverse process", 219, 395, 38},
          Place{"left transverse process", 271, 398, 39}, Place{"cancellous bone", 244, 350, 38},
          Place{"right pedicle", 229, 384, 42}, Place{"right superior articular process", 233, 387, 51},
          Place{"left superior articular process", 258, 387, 51},
          Place{"left inferior articular process", 258, 392, 26},
          Place{"right inferior articular process", 232, 388, 26}}) {
      EXPECT_TRUE(mask.at(p.column, p.row, p.slice)) << p.name;
    }
    for (const Place& p : {Place{"right rib", 205, 391, 42}, Place{"left rib", 282, 392, 42},
                           Place{"head of the right rib", 222, 376, 42}, Place{"head of the left rib", 270, 380, 43},
                           Place{"body of T12", 245, 355, 15}, Place{"right facet of T12", 228, 383, 20},
                           Place{"left facet of T12", 262, 383, 20}, Place{"body of T10", 245, 360, 62},
                           Place{"lamina of T10", 243, 397, 51}, Place{"spinous process of T10", 243, 410, 45},
                           Place{"canal", 244, 378, 40}}) {
      EXPECT_FALSE(mask.at(p.column, p.row, p.slice)) << p.name;
    }
  }

  void expect_size_and_symmetry() const {
    // T11's transverse processes end 20 to 25 mm, its ribs over 100 mm from the midline (column 244).
    const VoxelBox box = mask_box(found_.mask);
    EXPECT_GT(box.low[0], 244 - 36);
    EXPECT_LT(box.high[0], 244 + 36);
    // From the spinous process's tip to the superior articular processes: 40 to 55 mm, and not to the CT's ends.
    EXPECT_GE(box.low[2], 5);
    EXPECT_LE(box.high[2], 62);
    // A body of about 37 x 32 x 24 mm is 20 to 24 cm3; the arch adds a third to a half.
    EXPECT_GT(volume_mm3(), 25'000.0);
    EXPECT_LT(volume_mm3(), 36'000.0);
    double left = 0.0;
    double right = 0.0;
    for (int k = box.low[2]; k <= box.high[2]; ++k) {
      for (int j = box.low[1]; j <= box.high[1]; ++j) {
        for (int i = box.low[0]; i <= box.high[0]; ++i) {
          if (found_.mask.at(i, j, k)) (i > 245 ? left : right) += 1.0;
        }
      }
    }
    // A rib's head and neck on one side would add over 15%.
    EXPECT_NEAR(left / right, 1.0, 0.12);
    EXPECT_EQ(part_sizes(found_.mask.inside, ct_.geometry).size(), 1U);
  }

  CtVolume ct_;
  Segmentation found_;
};

TEST_F(SegmentT11, StandsAloneFromASeedInItsMiddle) {
  find(Vec3(-9.0, 222.0, -638.0));
  if (IsSkipped() || HasFatalFailure()) return;
  expect_anatomy();
  expect_size_and_symmetry();
}

TEST_F(SegmentT11, StandsAloneFromASeedNearItsWall) {
  find(Vec3(2.0, 222.0, -645.0));
  if (IsSkipped() || HasFatalFailure()) return;
  expect_anatomy();
  expect_size_and_symmetry();
}

TEST_F(SegmentT11, IsTheLargestBodyThatIsWhole) {
  find(std::nullopt);
  if (IsSkipped() || HasFatalFailure()) return;
  expect_anatomy();
}

}  // namespace
}  // namespace spinaltap
