// What the libraries and programs declare is used by a program, or kept_names.txt says why it is there.

#include "tests/package/unused_names.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include "tests/support/test_paths.h"

namespace spinaltap::test {
namespace {

namespace fs = std::filesystem;
using testing::ElementsAre;
using testing::IsEmpty;

std::string text_of(const fs::path& file) {
  std::ostringstream text;
  text << std::ifstream(file).rdbuf();
  return text.str();
}

std::vector<Source> own_sources() {
  std::vector<Source> sources;
  const fs::path root = kSourceFolder;
  for (const char* folder : {"core", "vdb", "mesh", "apps"}) {
    for (const auto& entry : fs::recursive_directory_iterator(root / folder)) {
      const std::string kind = entry.path().extension().string();
      if (kind != ".h" && kind != ".cpp" && kind != ".c") continue;
      sources.push_back({fs::relative(entry.path(), root).string(), text_of(entry.path())});
    }
  }
  std::sort(sources.begin(), sources.end(), [](const Source& a, const Source& b) { return a.name < b.name; });
  return sources;
}

std::vector<std::string> kept_names() {
  std::vector<std::string> names;
  std::istringstream lines(text_of(fs::path(kSourceFolder) / "tests/package/kept_names.txt"));
  for (std::string line; std::getline(lines, line);) {
    if (line.starts_with("#")) continue;
    const std::size_t end = line.find(": ");
    EXPECT_NE(end, std::string::npos) << "expected NAME: why, found " << line;
    names.push_back(line.substr(0, end));
  }
  return names;
}

std::vector<std::string> names_of(const std::vector<UnusedName>& unused) {
  std::vector<std::string> names;
  for (const UnusedName& one : unused) names.push_back(one.name);
  return names;
}

/// With a program that uses `used` alone.
std::vector<std::string> unused_of(const std::string& header, const std::string& used,
                                   const std::vector<std::string>& kept = {}) {
  const std::vector<Source> sources{{"core/x.h", header}, {"apps/main.cpp", "int main() { " + used + " }"}};
  return names_of(unused_names(sources, kept));
}

TEST(UnusedNames, AreKeptForAReasonOnly) {
  const std::vector<Source> sources = own_sources();
  ASSERT_GT(sources.size(), 1000U);
  const std::vector<std::string> kept = kept_names();
  for (const UnusedName& one : unused_names(sources, kept)) {
    ADD_FAILURE() << one.source << ":" << one.line << ": expected a use outside tests/ or a line in "
                  << "tests/package/kept_names.txt, found neither for " << one.name;
  }
  const std::vector<std::string> unused = names_of(unused_names(sources, {}));
  for (const std::string& name : kept) {
    EXPECT_THAT(unused, testing::Contains(name)) << "kept_names.txt names what is used, or not there";
  }
}

TEST(UnusedNames, AreFoundAmongTheProjectsOwn) {
  std::vector<Source> sources = own_sources();
  const std::vector<std::string> kept = kept_names();
  sources.push_back({"core/base/planted.h", "namespace spinaltap {\n\nint planted_name(const Vec3& at);\n}\n"});
  const std::vector<UnusedName> unused = unused_names(sources, kept);
  ASSERT_THAT(names_of(unused), ElementsAre("planted_name"));
  EXPECT_EQ(unused[0].source, "core/base/planted.h");
  EXPECT_EQ(unused[0].line, 3);
}

TEST(UnusedNames, AreFunctionsClassesMembersAndConstants) {
  EXPECT_THAT(unused_of("int used(); int dead();", "used();"), ElementsAre("dead"));
  EXPECT_THAT(unused_of("inline constexpr int kDead = 3; constexpr int kUsed{4};", "kUsed;"), ElementsAre("kDead"));
  EXPECT_THAT(unused_of("struct Dead { int x = 1; }; struct Used { int x; };", "Used one;"), ElementsAre("Dead"));
  EXPECT_THAT(unused_of("using Dead = int; enum class Alone { one };", ""), ElementsAre("Dead", "Alone"));
  EXPECT_THAT(unused_of("class A { public: A(); int used() const; int dead() const { return 1; } };", "A().used();"),
              ElementsAre("A::dead"));
  EXPECT_THAT(
      unused_of("template <class T> std::function<void(T)> dead(const std::map<T, int>& of) { return {}; }", ""),
      ElementsAre("dead"));
}

TEST(UnusedNames, AreThoseThatOnlyTheUnusedName) {
  EXPECT_THAT(unused_of("int helper(); inline int dead() { return dead() + helper(); }", ""),
              ElementsAre("helper", "dead"));
  EXPECT_THAT(unused_of("struct A { int f(); }; int A::f() { return helper(); } int helper();", ""),
              ElementsAre("A", "A::f", "helper"));
  EXPECT_THAT(unused_of("// used: dead()\n/* dead() */ const char* const kText = \"dead()\"; int dead();", "kText;"),
              ElementsAre("dead"));
}

TEST(UnusedNames, AreNotWhatIsUsedWithoutItsName) {
  EXPECT_THAT(
      unused_of("struct Base { virtual int f() = 0; }; struct A : Base { A() : x_{helper()} {} int f() override; "
                "int x_; }; int A::f() { return 2; } int helper(); bool operator<(const A&, const A&);",
                "A a; Base& b = a; b.f();"),
      IsEmpty());
  EXPECT_THAT(unused_of("extern \"C\" { int for_users(int x); } MAKE_PROGRAM(x, y) { helper(); } int helper();", ""),
              IsEmpty());
  EXPECT_THAT(unused_of("struct A { struct In { int x; } in; enum { kOne }; }; template <> struct std::hash<A> {};",
                        "A().in.x + A::kOne;"),
              IsEmpty());
  EXPECT_THAT(unused_of("int kept(); struct A { int f(); };", "A();", {"kept", "A::f"}), IsEmpty());
}

}  // namespace
}  // namespace spinaltap::test
