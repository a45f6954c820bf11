#include "core/base/error.h"

#include <gtest/gtest.h>

#include <filesystem>

#include "core/base/file_stream.h"
#include "core/base/staged_output.h"
#include "core/files/plan_file.h"
#include "core/tool/drill_path.h"
#include "tests/support/temporary_folder.h"

namespace spinaltap {
namespace {

template <class Work>
ErrorKind kind_of_what_throws(const Work& work) {
  try {
    work();
  } catch (const Error& error) {
    return error.kind();
  }
  ADD_FAILURE() << "nothing was thrown";
  return ErrorKind::internal;
}

TEST(Error, HasAKindBesideItsWords) {
  EXPECT_EQ(kind_of_what_throws([] { fail("expected ", 1, ", found ", 2); }), ErrorKind::input);
  EXPECT_EQ(kind_of_what_throws([] { fail_as(ErrorKind::unsupported, "this is not done"); }), ErrorKind::unsupported);
  EXPECT_EQ(kind_of_what_throws([] { throw Cancelled(); }), ErrorKind::cancelled);
  EXPECT_EQ(name_of(ErrorKind::input), "input");
  EXPECT_EQ(name_of(ErrorKind::internal), "internal");
}

TEST(Error, SaysWhatItIsAbout) {
  const test::TemporaryFolder folder;
  EXPECT_EQ(kind_of_what_throws([&] { read_plan(folder.path() / "none.json"); }), ErrorKind::file);
  EXPECT_EQ(kind_of_what_throws([&] {
              write_whole_file(folder.path() / "text", "not JSON");
              read_plan(folder.path() / "text");
            }),
            ErrorKind::input);
  EXPECT_EQ(kind_of_what_throws([&] { write_whole_file(folder.path() / "none" / "a" / "b", "text"); }),
            ErrorKind::disk);
  DrillPath path{"short", Vec3::Zero(), Vec3::Zero(), {}};
  EXPECT_EQ(kind_of_what_throws([&] { check_path(path); }), ErrorKind::geometry);
}

}  // namespace
}  // namespace spinaltap
