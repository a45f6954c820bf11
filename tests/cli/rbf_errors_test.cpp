// What spinaltap fit and eval reject: one line, an exit that is not 0, and no file.

#include "core/base/gzip.h"
#include "tests/cli/rbf_folder.h"

namespace spinaltap {
namespace {

using test::ball;
using test::csv;
using test::run_program;
using testing::AllOf;
using testing::HasSubstr;

class RbfErrors : public test::RbfFolder {};

TEST_F(RbfErrors, NameFileAndLineOfBadPoints) {
  EXPECT_THAT(rejected("fit ../none.csv -o out/a.rbf"), HasSubstr("no such file: ../none.csv"));
  EXPECT_THAT(rejected("fit ../ball.csv --error-bars"),
              HasSubstr("expected a column error_bar, found none in ../ball"));
  write("bad.csv", "x,y,z,value\n1,2,3,4\n1,2,x,4\n");
  EXPECT_THAT(rejected("fit ../bad.csv"), AllOf(HasSubstr("found \"x\""), HasSubstr("../bad.csv, line 3")));
  write("three.csv", "0,0,0,1\n1,0,0,1\n0,1,0,1\n");
  EXPECT_THAT(rejected("fit ../three.csv -o out/a.rbf"), HasSubstr("points"));
  write("cut.csv.gz", gzip(csv(ball(150))).substr(0, 2000));
  EXPECT_THAT(rejected("fit ../cut.csv.gz"), HasSubstr("cut short"));
  write("ball.txt", csv(ball(20)));
  EXPECT_THAT(rejected("fit ../ball.txt"), HasSubstr(".csv, .csv.gz or .ply"));
  EXPECT_THAT(rejected("fit ../ball.csv -o ../work"), HasSubstr("found a folder"));
}

TEST_F(RbfErrors, RejectOptionsOutOfRange) {
  for (const char* options : {"--kernel cubic", "--accuracy 0", "--accuracy nan", "--smoothing -1", "--reduce -0.1",
                              "--merge -1", "--slabs 0 --reduce 1", "--slabs 2"}) {
    rejected(std::string("fit ../ball.csv ") + options);
  }
  run("fit ball.csv");
  for (const char* options : {"--accuracy 0", "--accuracy nan", "--low-pass -1", "--low-pass nan", "-o values.txt",
                              "--grid 1 -o field.nrrd"}) {
    rejected(std::string("eval ../surface.rbf ../ball.csv ") + options);
  }
  for (const char* options : {"", "--grid 0 -o a.nrrd", "--grid nan -o a.nrrd", "--grid 1", "--grid 1e-4 -o a.nrrd",
                              "--grid 1 --gradient -o a.nrrd"}) {
    rejected(std::string("eval ../surface.rbf ") + options);
  }
}

TEST_F(RbfErrors, SayWhatIsWrongWithAModel) {
  EXPECT_THAT(rejected("eval ../none.rbf ../ball.csv"), HasSubstr("no such file: ../none.rbf"));
  EXPECT_THAT(rejected("eval ../ball.csv ../ball.csv"), HasSubstr("another kind of file: ../ball.csv"));
  run("fit ball.csv");
  const std::string bytes = read_whole_file(in("surface.rbf"));
  write("cut.rbf", bytes.substr(0, bytes.size() / 2));
  EXPECT_THAT(rejected("eval ../cut.rbf ../ball.csv -o out/values.csv"), HasSubstr("cut short?"));
  std::string damaged = bytes;
  damaged[bytes.size() / 2] ^= 1;
  write("damaged.rbf", damaged);
  EXPECT_THAT(rejected("eval ../damaged.rbf ../ball.csv"), HasSubstr("checksum differs"));
  write("two.csv", "1,2\n");
  EXPECT_THAT(rejected("eval ../surface.rbf ../two.csv"), HasSubstr("../two.csv, line 1"));
}

TEST_F(RbfErrors, LeaveTheOldFilesOnAFullDisk) {
  run("fit ball.csv");
  EXPECT_THAT(rejected("fit ../ball.csv -o out/a.rbf", "ulimit -f 8;"), HasSubstr("cannot write"));
  EXPECT_THAT(rejected("eval ../surface.rbf ../ball.csv -o a.csv", "ulimit -f 8;"), HasSubstr("cannot write"));
  EXPECT_THAT(rejected("eval ../surface.rbf ../ball.csv -o a.ply", "ulimit -f 8;"), HasSubstr("cannot write"));
  EXPECT_THAT(rejected("eval ../surface.rbf --grid 1 -o a.nrrd", "ulimit -f 8;"), HasSubstr("cannot write"));
  const std::string old = read_whole_file(in("surface.rbf"));
  EXPECT_NE(run_program("fit ball.csv --kernel triharmonic --force", folder_.path(), "ulimit -f 8;").exit_code, 0);
  EXPECT_EQ(read_whole_file(in("surface.rbf")), old);
}

}  // namespace
}  // namespace spinaltap
