#include "core/ct/bone_identity.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/base/error.h"

namespace spinaltap {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::ThrowsMessage;

const BoneIdentity kL3{"aa", Level{22}};
const BoneIdentity kL4{"aa", Level{23}};
const BoneIdentity kOther{"bb", Level{22}};

TEST(BoneIdentity, IsTheSameUnlessSomethingSpeaksAgainstIt) {
  EXPECT_TRUE(may_be_same(kL3, kL3));
  EXPECT_TRUE(may_be_same(kL3, {}));
  EXPECT_TRUE(may_be_same({"aa", Level::kNone}, kL3));
  EXPECT_TRUE(may_be_same({"", kL3.level}, kL3));
  EXPECT_FALSE(may_be_same(kL3, kL4));
  EXPECT_FALSE(may_be_same(kL3, kOther));
  EXPECT_FALSE(may_be_same({"", kL4.level}, kL3));
}

TEST(BoneIdentity, IsRefusedByName) {
  EXPECT_NO_THROW(check_same_bone("plan", kL3, kL3));
  EXPECT_THAT([] { check_same_bone("plan \"a\"", kL3, kOther, ", or else"); },
              ThrowsMessage<Error>(AllOf(HasSubstr("plan \"a\" is of L3 of the CT aa"), HasSubstr("L3 of the CT bb"),
                                         HasSubstr("another patient's"), HasSubstr(", or else"))));
  EXPECT_THAT([] { check_same_bone("plan", kL4, kL3); },
              ThrowsMessage<Error>(AllOf(HasSubstr("L4 of the CT aa"), HasSubstr("another vertebra of the same CT"))));
  EXPECT_THAT(
      [] {
        check_same_bone("plan", {"", kL4.level}, kL3);
      },
      ThrowsMessage<Error>(HasSubstr("L4 of a CT that is not named")));
}

}  // namespace
}  // namespace spinaltap
