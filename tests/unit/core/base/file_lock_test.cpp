// Locks of files, also where the file system has none: flock() of the C library is replaced in this program.

#include "core/base/file_lock.h"

#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/file.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>

#include "core/base/detail/hdf5_driver.h"
#include "core/base/error.h"
#include "core/base/hdf5_file.h"
#include "core/files/study_folder.h"
#include "core/study/study_row.h"
#include "tests/support/temporary_folder.h"

namespace spinaltap {
namespace {

/// What flock() fails with; 0: it does what it does.
std::atomic<int> flock_error{0};

}  // namespace
}  // namespace spinaltap

extern "C" int flock(int descriptor, int operation) noexcept {
  if (const int error = spinaltap::flock_error; error != 0) {
    errno = error;
    return -1;
  }
  return static_cast<int>(::syscall(SYS_flock, descriptor, operation));
}

namespace spinaltap {
namespace {

using testing::HasSubstr;
using testing::ThrowsMessage;

class FileLocks : public ::testing::Test {
 protected:
  ~FileLocks() override { flock_error = 0; }
  test::TemporaryFolder folder_;
  const StudyIdentity study_{R"({"name":"one"})", 10};
};

TEST_F(FileLocks, AreHeldByOneAtATime) {
  const std::string name = folder_.path() / "file";
  const int one = ::open(name.c_str(), O_RDWR | O_CREAT, 0644);
  const int other = ::open(name.c_str(), O_RDWR, 0644);
  EXPECT_EQ(try_lock(one, true), FileLock::held);
  EXPECT_EQ(try_lock(other, true), FileLock::taken);
  EXPECT_EQ(try_lock(other, false), FileLock::taken);
  ::close(one);
  EXPECT_EQ(try_lock(other, false), FileLock::held);
  ::close(other);
}

TEST_F(FileLocks, AreDoneWithoutWhereTheFileSystemHasNone) {
  for (const int error : {ENOSYS, EOPNOTSUPP, ENOLCK, EINVAL}) {
    SCOPED_TRACE(error);
    flock_error = error;
    EXPECT_EQ(try_lock(0, true), FileLock::no_locking);
    EXPECT_NO_THROW(StudyPart(folder_.path(), "part-1-of-1.csv", study_).append("1"));
    const std::filesystem::path record = folder_.path() / ("record" + std::to_string(error) + ".h5");
    {
      Hdf5File file = Hdf5File::create(record);
      file.make_group("/setup");
      file.close();
    }
    EXPECT_NO_THROW(Hdf5File::open(record));
  }
}

TEST_F(FileLocks, WhereThereAreNoneEachWriterOfAStudyHasAFileOfItsOwn) {
  StudyRow rows[3];
  for (std::size_t n = 0; n < 3; ++n) rows[n][StudyColumn::run] = static_cast<double>(n);
  open_study_folder(folder_.path(), study_);
  StudyPart(folder_.path(), "part-1-of-2.csv", study_).append(study_csv(rows[0]));
  flock_error = EOPNOTSUPP;
  {
    // Two tasks that both think the shard theirs, as after a requeue whose first process still lives.
    StudyPart one(folder_.path(), "part-1-of-2.csv", study_);
    StudyPart two(folder_.path(), "part-1-of-2.csv", study_);
    EXPECT_FALSE(one.is_locked());
    EXPECT_NE(one.path(), two.path());
    for (const StudyPart* part : {&one, &two}) {
      EXPECT_THAT(part->path().filename().string(), testing::StartsWith("part-1-of-2."));
      EXPECT_THAT(part->path().filename().string(), HasSubstr("-" + std::to_string(::getpid()) + "-"));
    }
    one.append(study_csv(rows[1]));
    two.append(study_csv(rows[1]));
    two.append(study_csv(rows[2]));
  }
  StudyRows found;
  read_study_parts(folder_.path(), study_, found);
  EXPECT_EQ(found.size(), 3U);
  flock_error = 0;
  EXPECT_TRUE(StudyPart(folder_.path(), "part-1-of-2.csv", study_).is_locked());
}

TEST_F(FileLocks, OfAnotherProcessAreToldFromThoseThatFailed) {
  flock_error = EWOULDBLOCK;
  EXPECT_THAT([&] { StudyPart(folder_.path(), "part-1-of-1.csv", study_); },
              ThrowsMessage<Error>(HasSubstr("another process")));
  flock_error = EIO;
  EXPECT_THAT([&] { StudyPart(folder_.path(), "part-1-of-1.csv", study_); },
              ThrowsMessage<Error>(HasSubstr("cannot lock")));
}

TEST(Hdf5Driver, SaysItsVersionWhereItsLibraryAsksForIt) {
  struct {  // as HDF5 1.14 has it
    unsigned version = 0;
    int value = 0;
    const char* name = nullptr;
  } since_1_14;
  detail::set_driver_version(since_1_14);
  EXPECT_EQ(since_1_14.version, 1U) << "H5FD_CLASS_VERSION: H5FDregister() rejects any other";
  EXPECT_GE(since_1_14.value, 256) << "those below are HDF5's own";
  EXPECT_LT(since_1_14.value, 512);
  struct {
    const char* name = "as it is";
  } before;
  detail::set_driver_version(before);
  EXPECT_STREQ(before.name, "as it is");
}

}  // namespace
}  // namespace spinaltap
