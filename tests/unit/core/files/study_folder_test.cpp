#include "core/files/study_folder.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <limits>
#include <optional>

#include "core/base/error.h"
#include "core/base/random.h"
#include "core/base/staged_output.h"
#include "core/ct/level.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/test_kind.h"

namespace spinaltap {
namespace {

using testing::HasSubstr;
using testing::ThrowsMessage;

/// Numbers of every kind that a row may hold.
StudyRow full_row(std::size_t run) {
  StudyRow row;
  for (std::size_t n = 0; n < kStudyColumns; ++n) {
    row[static_cast<StudyColumn>(n)] = random_uniform(run, n) * std::pow(10.0, static_cast<double>(n % 9) - 4.0);
  }
  row[StudyFactor::push_n] = std::numeric_limits<double>::quiet_NaN();
  row[StudyColumn::min_clearance_canal_mm] = std::numeric_limits<double>::infinity();
  row[StudyColumn::plunge_depth_mm] = std::numeric_limits<double>::quiet_NaN();
  row[StudyColumn::run] = static_cast<double>(run);
  row[StudyColumn::seed] = 4294967295.0;
  row[StudyColumn::contact] = 1.0;
  row[StudyColumn::breach] = 0.0;
  row[StudyColumn::grade] = static_cast<double>(run % 5);
  row[StudyColumn::removed_points] = 1e6;
  row[StudyColumn::events_lost] = 0.0;
  row[StudyColumn::patient] = 12.0;
  row[StudyColumn::screw] = 30.0;
  row[StudyColumn::level] = static_cast<double>(Level::kT12);
  row[StudyColumn::side] = static_cast<double>(run % 2);
  row[StudyColumn::screw_grade] = static_cast<double>((run + 1) % 5);
  row[StudyColumn::screw_breach_side] = static_cast<double>(run % 5);
  return row;
}

const StudyIdentity kStudy{R"({"name":"one","seed":7})", 100};

TEST(StudyRow, ComesBackFromTextBitForBit) {
  for (std::size_t run = 0; run < 50; ++run) {
    const StudyRow row = full_row(run);
    const std::string text = study_csv(row);
    const StudyRow back = read_study_csv(text);
    for (std::size_t n = 0; n < kStudyColumns; ++n) {
      const auto column = static_cast<StudyColumn>(n);
      EXPECT_TRUE(row[column] == back[column] || (std::isnan(row[column]) && std::isnan(back[column])))
          << name_of(column);
    }
    EXPECT_EQ(study_csv(back), text);
  }
}

TEST(StudyRow, IsWrittenAsReadersOfTablesTakeIt) {
  const std::string head = study_csv_head();
  const std::string text = study_csv(full_row(3));
  EXPECT_EQ(std::count(head.begin(), head.end(), ','), std::count(text.begin(), text.end(), ','));
  EXPECT_THAT(head, testing::StartsWith("run,entry_left_mm,"));
  EXPECT_THAT(text, testing::StartsWith("3,"));
  EXPECT_THAT(text, HasSubstr(",1000000,"));     // no exponents in whole numbers
  EXPECT_THAT(text, HasSubstr(",4294967295,"));  // of the seed
  EXPECT_THAT(text, HasSubstr(",D,"));           // grade 3
  EXPECT_THAT(text, HasSubstr(",12,30,T12,right,"));
  EXPECT_THAT(text, HasSubstr(",E,"));       // the screw's
  EXPECT_THAT(text, HasSubstr(",caudal,"));  // of its breach
  EXPECT_THAT(text, HasSubstr(",,"));        // what there is not
  EXPECT_THAT(text, HasSubstr(",inf,"));
  // For other programs it is an empty field, and nothing else changes.
  EXPECT_EQ(study_csv_for_others("3,inf,1.5,,-inf,D"), "3,,1.5,,,D");
  EXPECT_EQ(study_csv_for_others("inf"), "");
}

TEST(StudyRow, RejectsTextThatIsNoRow) {
  const std::string good = study_csv(full_row(3));
  EXPECT_THROW(read_study_csv(good + ",1"), Error);
  EXPECT_THROW(read_study_csv(good.substr(0, good.rfind(','))), Error);
  EXPECT_THROW(read_study_csv("x" + good), Error);
  EXPECT_THROW(read_study_csv("1.5" + good.substr(1)), Error);
  EXPECT_THROW(read_study_csv(good.substr(1)), Error);
  EXPECT_THROW(read_study_csv(""), Error);
}

class StudyFolder : public ::testing::Test {
 protected:
  StudyFolder() { open_study_folder(path_, kStudy); }
  StudyRows rows() const {
    StudyRows rows;
    read_study_parts(path_, kStudy, rows);
    return rows;
  }
  void append(std::size_t from, std::size_t to, const std::string& name = "part-1-of-1.csv") const {
    StudyPart part(path_, name, kStudy);
    for (std::size_t run = from; run < to; ++run) part.append(study_csv(full_row(run)));
  }

  test::TemporaryFolder folder_;
  std::filesystem::path path_ = folder_.path() / "study";
};

SLOW_TESTS("StudyFolder.CutAnywhereLosesOnlyTheRowThatWasCut");

TEST_F(StudyFolder, GivesRowsBackAsTheyWereAppended) {
  append(10, 20);
  append(20, 25);
  append(0, 5, "part-2-of-2.csv");
  const StudyRows found = rows();
  EXPECT_EQ(found.size(), 20U);
  for (const auto& [run, text] : found) EXPECT_EQ(text, study_csv(full_row(run)));
}

TEST_F(StudyFolder, CutAnywhereLosesOnlyTheRowThatWasCut) {
  append(0, 4);
  const std::filesystem::path part = path_ / "part-1-of-1.csv";
  const std::string whole = read_whole_file(part);
  std::size_t max = 0;
  for (std::size_t length = 0; length <= whole.size(); ++length) {
    write_whole_file(part, whole.substr(0, length));
    const std::string cut = whole.substr(0, length);
    const auto lines = static_cast<std::size_t>(std::count(cut.begin(), cut.end(), '\n'));
    ASSERT_EQ(rows().size(), lines > 0 ? lines - 1 : 0) << length;
    max = std::max(max, rows().size());
    // Going on makes the file what it would have been.
    append(rows().size(), 4);
    ASSERT_EQ(read_whole_file(part), whole) << length;
  }
  EXPECT_EQ(max, 4U);
}

TEST_F(StudyFolder, PassesOverARowThatWasDamaged) {
  append(0, 3);
  const std::filesystem::path part = path_ / "part-1-of-1.csv";
  std::string text = read_whole_file(part);
  const std::size_t second = text.find("\n1,") + 6;
  text[second] = text[second] == '3' ? '4' : '3';
  write_whole_file(part, text);
  const StudyRows found = rows();
  EXPECT_EQ(found.size(), 2U);
  EXPECT_FALSE(found.contains(1));
}

TEST_F(StudyFolder, RejectsAnotherStudyAndSaysWhatDiffers) {
  StudyIdentity other = kStudy;
  other.study = R"({"name":"one","seed":8})";
  EXPECT_THAT([&] { open_study_folder(path_, other); }, ThrowsMessage<Error>(HasSubstr("\"seed\"")));
  open_study_folder(path_, kStudy);
  append(0, 2);
  EXPECT_THAT([&] { StudyPart(path_, "part-1-of-1.csv", other); }, ThrowsMessage<Error>(HasSubstr("another")));
  StudyRows found;
  EXPECT_THAT([&] { read_study_parts(path_, other, found); }, ThrowsMessage<Error>(HasSubstr("another")));
}

TEST_F(StudyFolder, RejectsTwoRowsOfOneRunThatDiffer) {
  append(0, 2);
  append(1, 2, "part-2-of-2.csv");
  EXPECT_EQ(rows().size(), 2U);  // the same twice is no harm
  StudyRow row = full_row(1);
  row[StudyColumn::depth_mm] += 1.0;
  StudyPart(path_, "part-3-of-3.csv", kStudy).append(study_csv(row));
  EXPECT_THAT([&] { rows(); }, ThrowsMessage<Error>(HasSubstr("run 1 came out differently")));
}

TEST_F(StudyFolder, LetsOneProcessWriteAPartAtATime) {
  std::optional<StudyPart> first(std::in_place, path_, "part-1-of-2.csv", kStudy);
  EXPECT_THAT([&] { StudyPart(path_, "part-1-of-2.csv", kStudy); },
              ThrowsMessage<Error>(HasSubstr("another process works on")));
  const StudyPart other(path_, "part-2-of-2.csv", kStudy);
  first.reset();
  const StudyPart again(path_, "part-1-of-2.csv", kStudy);
}

TEST_F(StudyFolder, TakesNoNumberOfRunsThatIsNone) {
  const std::string text = read_whole_file(path_ / "study.json");
  for (const char* runs : {"-1e308", "1e308", "-1", "0.5", "1e19", "18446744073709551616", "\"100\"", "null"}) {
    std::string damaged = text;
    damaged.replace(damaged.find("\"runs\": 100"), 11, std::string("\"runs\": ") + runs);
    write_whole_file(path_ / "study.json", damaged);
    EXPECT_THAT([&] { read_study_identity(path_); }, ThrowsMessage<Error>(HasSubstr("a whole number of 0 or more")))
        << runs;
  }
}

TEST_F(StudyFolder, NoticesWhenStudyJsonWasChanged) {
  EXPECT_EQ(read_study_identity(path_).study, kStudy.study);
  EXPECT_EQ(read_study_identity(path_).runs, 100U);
  std::string text = read_whole_file(path_ / "study.json");
  text.replace(text.find("\"one\""), 5, "\"two\"");
  write_whole_file(path_ / "study.json", text);
  EXPECT_THAT([&] { read_study_identity(path_); }, ThrowsMessage<Error>(HasSubstr("changed")));
  EXPECT_THAT([&] { read_study_identity(folder_.path()); }, ThrowsMessage<Error>(HasSubstr("study.json")));
}

}  // namespace
}  // namespace spinaltap
