#include "core/base/staged_output.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <csignal>
#include <functional>
#include <vector>

#include "core/base/error.h"
#include "tests/support/error_of.h"
#include "tests/support/temporary_folder.h"

namespace spinaltap {
namespace {

/// Sees each fsync() of this program, in place of the C library, and gives what it comes to; none: the library's.
std::function<int(const std::filesystem::path&)> on_sync;

}  // namespace
}  // namespace spinaltap

extern "C" int fsync(int descriptor) {
  if (!spinaltap::on_sync) return static_cast<int>(::syscall(SYS_fsync, descriptor));
  return spinaltap::on_sync(std::filesystem::read_symlink("/proc/self/fd/" + std::to_string(descriptor)));
}

namespace spinaltap {
namespace {

namespace fs = std::filesystem;
using test::error_of;
using test::TemporaryFolder;
using testing::HasSubstr;

/// How many files and folders lie below a folder.
std::ptrdiff_t count_in(const fs::path& folder) {
  return std::distance(fs::recursive_directory_iterator(folder), fs::recursive_directory_iterator());
}

TEST(StagedOutput, ShowsItsFilesOnCommitAndReplacesOldOnes) {
  const TemporaryFolder folder;
  const fs::path a = folder.path() / "a.txt", b = folder.path() / "b.txt";
  write_whole_file(a, "old");
  StagedOutput output;
  output.write(a, "new a");
  output.write(b, "new b");
  EXPECT_EQ(read_whole_file(a), "old");
  EXPECT_FALSE(fs::exists(b));
  output.commit();
  EXPECT_EQ(read_whole_file(a), "new a");
  EXPECT_EQ(read_whole_file(b), "new b");
  EXPECT_EQ(count_in(folder.path()), 2);
}

TEST(StagedOutput, LeavesTheOldFileAndNothingElseWithoutCommit) {
  const TemporaryFolder folder;
  write_whole_file(folder.path() / "a.txt", "old");
  {
    StagedOutput output;
    output.write(folder.path() / "a.txt", "new");
    output.write(folder.path() / "deep" / "er" / "b.txt", "new");
    EXPECT_TRUE(fs::is_directory(folder.path() / "deep" / "er"));
  }
  EXPECT_EQ(read_whole_file(folder.path() / "a.txt"), "old");
  EXPECT_EQ(count_in(folder.path()), 1);
}

TEST(StagedOutput, MakesMissingFoldersAndKeepsThemOnCommit) {
  const TemporaryFolder folder;
  StagedOutput output;
  output.write(folder.path() / "x" / "y" / "z.txt", "here");
  output.commit();
  EXPECT_EQ(read_whole_file(folder.path() / "x" / "y" / "z.txt"), "here");
}

TEST(StagedOutput, LeavesAFolderThatSomebodyElseUsesMeanwhile) {
  const TemporaryFolder folder;
  {
    StagedOutput output;
    output.write(folder.path() / "x" / "y" / "z.txt", "here");
    write_whole_file(folder.path() / "x" / "mine.txt", "mine");
  }
  EXPECT_EQ(read_whole_file(folder.path() / "x" / "mine.txt"), "mine");
  EXPECT_FALSE(fs::exists(folder.path() / "x" / "y"));
}

TEST(StagedOutput, KeepsTheExtensionOfATemporaryName) {
  const TemporaryFolder folder;
  StagedOutput output;
  EXPECT_EQ(output.stage(folder.path() / "bone.vdb").extension(), ".vdb");
}

TEST(StagedOutput, ShowsNoneOfItsFilesWhenOneWasNotWritten) {
  const TemporaryFolder folder;
  StagedOutput output;
  output.write(folder.path() / "a.txt", "a");
  output.stage(folder.path() / "b.txt");
  EXPECT_THAT(error_of([&] { output.commit(); }), HasSubstr("b.txt"));
  EXPECT_FALSE(fs::exists(folder.path() / "a.txt"));
}

TEST(StagedOutput, RejectsAFolderAsAFileAndAFileAsAFolder) {
  const TemporaryFolder folder;
  StagedOutput output;
  EXPECT_THROW(output.stage(folder.path()), Error);
  EXPECT_THROW(output.stage(folder.path() / "x" / ""), Error);
  write_whole_file(folder.path() / "file", "");
  EXPECT_THROW(output.write(folder.path() / "file" / "a.txt", "a"), Error);
  EXPECT_THROW(output.write(folder.path() / "file" / "sub" / "a.txt", "a"), Error);
  EXPECT_EQ(count_in(folder.path()), 1);
}

TEST(StagedOutput, LeavesTheOldFileWhenTheDiskIsFull) {
  const TemporaryFolder folder;
  write_whole_file(folder.path() / "a.txt", "old");
  rlimit before{};
  ASSERT_EQ(::getrlimit(RLIMIT_FSIZE, &before), 0);
  const auto old_handler = std::signal(SIGXFSZ, SIG_IGN);
  // A file of at most 4,096 bytes stands for a disk with no more room.
  const rlimit small{4096, before.rlim_max};
  ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &small), 0);
  std::string message;
  {
    StagedOutput output;
    message = error_of([&] { output.write(folder.path() / "a.txt", std::string(100'000, 'x')); });
  }
  ::setrlimit(RLIMIT_FSIZE, &before);
  std::signal(SIGXFSZ, old_handler);
  EXPECT_THAT(message, HasSubstr("cannot write"));
  EXPECT_EQ(read_whole_file(folder.path() / "a.txt"), "old");
  EXPECT_EQ(count_in(folder.path()), 1);
}

TEST(StagedOutput, PutsTheOldFilesBackWhereOneCannotBeMoved) {
  const TemporaryFolder folder;
  write_whole_file(folder.path() / "a.txt", "old");
  {
    StagedOutput output;
    output.write(folder.path() / "a.txt", "new");
    output.write(folder.path() / "b.txt", "new");
    output.write(folder.path() / "c.txt", "new");
    output.list_in(folder.path());
    fs::create_directory(folder.path() / "c.txt");
    EXPECT_THAT(error_of([&] { output.commit(); }), HasSubstr("c.txt"));
  }
  EXPECT_EQ(read_whole_file(folder.path() / "a.txt"), "old");
  EXPECT_EQ(count_in(folder.path()), 2) << "a.txt, and the folder c.txt";
}

void write_set(const fs::path& folder, std::initializer_list<const char*> names) {
  StagedOutput output;
  for (const char* name : names) output.write(folder / name, name);
  output.list_in(folder);
  output.commit();
}

TEST(StagedOutput, LeavesNoFileOfAnEarlierSetAmongThoseOfAList) {
  const TemporaryFolder folder;
  write_whole_file(folder.path() / "thesis.txt", "years of work");
  write_set(folder.path(), {"a.txt", "points_1.vdb", "deep/points_2.vdb"});
  EXPECT_EQ(read_whole_file(folder.path() / "files.txt"),
            "spinaltap-files whole\n5 a.txt\n17 deep/points_2.vdb\n12 points_1.vdb\n");
  write_set(folder.path(), {"a.txt", "b.txt"});
  EXPECT_EQ(read_whole_file(folder.path() / "files.txt"), "spinaltap-files whole\n5 a.txt\n5 b.txt\n");
  EXPECT_FALSE(fs::exists(folder.path() / "points_1.vdb"));
  EXPECT_FALSE(fs::exists(folder.path() / "deep" / "points_2.vdb"));
  EXPECT_EQ(read_whole_file(folder.path() / "thesis.txt"), "years of work");
}

TEST(StagedOutput, GoesOnAfterASetWhoseMovingWasKilledAndStaysInItsFolder) {
  const TemporaryFolder folder;
  const fs::path out = folder.path() / "out";
  fs::create_directory(out);
  write_whole_file(folder.path() / "outside.txt", "not ours");
  write_whole_file(out / "half.txt", "of the killed one");
  write_whole_file(out / "files.txt", "spinaltap-files unfinished\n0 half.txt\n0 ../outside.txt\n0 " +
                                          (folder.path() / "outside.txt").string() + "\n0 .\n");
  write_set(out, {"a.txt"});
  EXPECT_FALSE(fs::exists(out / "half.txt"));
  EXPECT_TRUE(fs::exists(folder.path() / "outside.txt"));
  write_whole_file(out / "files.txt", "my own list");
  EXPECT_THAT(error_of([&] { write_set(out, {"a.txt"}); }), HasSubstr("found something else"));
}

/// Whether a file was there, and its list whole, when something was synced.
struct Synced {
  std::string name;
  bool is_there;
  bool is_listed;
};

TEST(StagedOutput, IsOnTheDiskBeforeItIsSeenAndItsListLast) {
  const TemporaryFolder folder;
  const fs::path file = folder.path() / "a.txt", list = folder.path() / "files.txt";
  std::vector<Synced> synced;
  on_sync = [&](const fs::path& path) {
    const bool is_listed = fs::exists(list) && read_whole_file(list).starts_with("spinaltap-files whole");
    synced.push_back({path.filename().string(), fs::exists(file), is_listed});
    return 0;
  };
  write_set(folder.path(), {"a.txt"});
  on_sync = nullptr;
  ASSERT_GE(synced.size(), 4U);
  EXPECT_EQ(synced.front().name, "a.txt");
  EXPECT_FALSE(synced.front().is_there);
  EXPECT_EQ(synced.back().name, folder.path().filename());
  EXPECT_TRUE(synced.back().is_listed);
  for (const Synced& one : synced) EXPECT_TRUE(!one.is_listed || one.is_there);
  const auto folder_with_file = std::find_if(synced.begin(), synced.end(), [&](const Synced& one) {
    return one.name == folder.path().filename() && one.is_there && !one.is_listed;
  });
  EXPECT_NE(folder_with_file, synced.end()) << "the names are on the disk before the list says so";
}

TEST(StagedOutput, LeavesTheOldFileWhereTheDiskRejectsTheSync) {
  const TemporaryFolder folder;
  write_whole_file(folder.path() / "a.txt", "old");
  on_sync = [](const fs::path&) {
    errno = EIO;
    return -1;
  };
  {
    StagedOutput output;
    output.write(folder.path() / "a.txt", "new");
    EXPECT_THAT(error_of([&] { output.commit(); }), HasSubstr("cannot write"));
  }
  on_sync = nullptr;
  EXPECT_EQ(read_whole_file(folder.path() / "a.txt"), "old");
  EXPECT_EQ(count_in(folder.path()), 1);
}

TEST(StagedOutput, LeavesNothingOfItsListWhicheverSyncTheDiskRejects) {
  const TemporaryFolder folder;
  const fs::path out = folder.path() / "out";
  write_set(out, {"a.txt", "b.txt"});
  const std::string list = read_whole_file(out / "files.txt");
  bool is_through = false;
  for (int rejected = 1; !is_through; ++rejected) {
    SCOPED_TRACE(rejected);
    int syncs = 0;
    bool were_moved = false;
    on_sync = [&](const fs::path&) {
      if (++syncs < rejected) return 0;
      were_moved = were_moved || !fs::exists(out / "b.txt") || fs::exists(out / "c.txt");
      errno = EIO;
      return -1;
    };
    const std::string error = error_of([&] { write_set(out, {"a.txt", "c.txt"}); });
    on_sync = nullptr;
    is_through = error.empty();
    EXPECT_EQ(is_through, syncs < rejected);
    for (const auto& entry : fs::directory_iterator(out)) {
      EXPECT_THAT(entry.path().filename().string(), testing::AnyOf("a.txt", "b.txt", "c.txt", "files.txt"));
    }
    if (!were_moved && !is_through) {
      EXPECT_EQ(read_whole_file(out / "files.txt"), list);
    }
    write_set(out, {"a.txt", "b.txt"});
    EXPECT_EQ(count_in(out), 3);
    EXPECT_EQ(read_whole_file(out / "files.txt"), list);
  }
}

TEST(StagedOutput, RemovesTheListThatAKilledRunWasWriting) {
  const TemporaryFolder folder;
  std::array<char, 256> host{};
  ASSERT_EQ(::gethostname(host.data(), host.size() - 1), 0);
  const std::string name = ".spinaltap-list-" + std::string(host.data()) + "-";
  const pid_t ended = ::fork();
  if (ended == 0) ::_exit(0);
  ASSERT_EQ(::waitpid(ended, nullptr, 0), ended);
  write_whole_file(folder.path() / (name + std::to_string(ended)), "spinaltap-files unfin");
  write_whole_file(folder.path() / (name + std::to_string(::getppid())), "of a run that goes on");
  write_set(folder.path(), {"a.txt"});
  EXPECT_FALSE(fs::exists(folder.path() / (name + std::to_string(ended))));
  EXPECT_EQ(count_in(folder.path()), 3);
}

TEST(StagedFolder, IsOnTheDiskBeforeItIsSeenAndIsNeverGone) {
  const TemporaryFolder folder;
  const fs::path out = folder.path() / "out";
  for (const bool replaces : {false, true}) {
    SCOPED_TRACE(replaces);
    std::vector<std::string> synced;
    on_sync = [&](const fs::path& path) {
      synced.push_back(path.filename().string());
      EXPECT_EQ(fs::exists(out), replaces || path == folder.path());
      return 0;
    };
    StagedFolder staged(out, "mine.json");
    write_whole_file(staged.temporary() / "mine.json", replaces ? "new" : "old");
    staged.commit();
    on_sync = nullptr;
    ASSERT_GE(synced.size(), 2U);
    EXPECT_EQ(synced.front(), "mine.json");
    EXPECT_EQ(synced.back(), folder.path().filename());
    EXPECT_EQ(read_whole_file(out / "mine.json"), replaces ? "new" : "old");
  }
  EXPECT_EQ(count_in(folder.path()), 2);
}

TEST(StagedFolder, AppearsWholeOnCommitAndNotBefore) {
  const TemporaryFolder folder;
  const fs::path out = folder.path() / "made" / "out";
  StagedFolder staged(out, "mine.json");
  write_whole_file(staged.temporary() / "mine.json", "{}");
  EXPECT_FALSE(fs::exists(out));
  staged.commit();
  EXPECT_EQ(read_whole_file(out / "mine.json"), "{}");
  EXPECT_EQ(count_in(folder.path()), 3);
}

TEST(StagedFolder, LeavesNothingWithoutCommit) {
  const TemporaryFolder folder;
  {
    const StagedFolder staged(folder.path() / "made" / "for" / "out", "mine.json");
    write_whole_file(staged.temporary() / "a.txt", "a");
  }
  EXPECT_EQ(count_in(folder.path()), 0);
}

TEST(StagedFolder, ReplacesAFolderThatHoldsItsMarkerAndAnEmptyOne) {
  const TemporaryFolder folder;
  const fs::path out = folder.path() / "out";
  fs::create_directory(out);
  for (const char* content : {"first", "second"}) {
    StagedFolder staged(out / "", "mine.json");  // "out/" is "out"
    write_whole_file(staged.temporary() / "mine.json", content);
    write_whole_file(staged.temporary() / (std::string(content) + ".txt"), "");
    staged.commit();
    EXPECT_EQ(read_whole_file(out / "mine.json"), content);
  }
  EXPECT_FALSE(fs::exists(out / "first.txt"));
  EXPECT_EQ(count_in(folder.path()), 3);
}

TEST(StagedFolder, RejectsFoldersThatItDidNotMake) {
  const TemporaryFolder folder;
  fs::create_directory(folder.path() / "out");
  write_whole_file(folder.path() / "out" / "thesis.txt", "years of work");
  EXPECT_THAT(error_of([&] { StagedFolder(folder.path() / "out", "mine.json"); }), HasSubstr("holds other files"));
  EXPECT_THAT(error_of([&] { StagedFolder(folder.path() / "out" / "thesis.txt", "mine.json"); }),
              HasSubstr("found a file"));
  EXPECT_THROW(StagedFolder("", "mine.json"), Error);
  EXPECT_EQ(read_whole_file(folder.path() / "out" / "thesis.txt"), "years of work");
  EXPECT_EQ(count_in(folder.path()), 2);
}

TEST(StagedFolder, KeepsWhatItWroteWhenItIsCommittedTwice) {
  const TemporaryFolder folder;
  StagedFolder staged(folder.path() / "out", "mine.json");
  write_whole_file(staged.temporary() / "mine.json", "{}");
  staged.commit();
  EXPECT_THROW(staged.commit(), Error);
  EXPECT_EQ(read_whole_file(folder.path() / "out" / "mine.json"), "{}");
}

TEST(StagedFolder, PutsTheOldFolderBackWhenTheNewOneIsLost) {
  const TemporaryFolder folder;
  const fs::path out = folder.path() / "out";
  fs::create_directory(out);
  write_whole_file(out / "mine.json", "old");
  StagedFolder staged(out, "mine.json");
  fs::remove_all(staged.temporary());
  EXPECT_THROW(staged.commit(), Error);
  EXPECT_EQ(read_whole_file(out / "mine.json"), "old");
}

TEST(ReadWholeFile, GivesBackWhatWasWrittenAndRejectsOtherThings) {
  const TemporaryFolder folder;
  const std::string bytes("a\0b\n\r\xff", 6);
  write_whole_file(folder.path() / "a", bytes);
  EXPECT_EQ(read_whole_file(folder.path() / "a"), bytes);
  EXPECT_EQ(read_whole_file(folder.path() / "a", 6), bytes);
  EXPECT_THAT(error_of([&] { read_whole_file(folder.path() / "a", 5); }), HasSubstr("at most 5 bytes, found 6"));
  EXPECT_THAT(error_of([&] { read_whole_file(folder.path() / "b"); }), HasSubstr("no such file"));
  EXPECT_THAT(error_of([&] { read_whole_file(folder.path()); }), HasSubstr("regular file"));
}

}  // namespace
}  // namespace spinaltap
