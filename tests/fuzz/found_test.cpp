// What once broke a reader, and what each reader must read, through the table that fuzz_readers uses.

#include <gtest/gtest.h>

#include <set>

#include "core/base/staged_output.h"
#include "tests/fuzz/mutate.h"
#include "tests/fuzz/readers.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/test_paths.h"

namespace spinaltap::test {
namespace {

namespace fs = std::filesystem;

const fs::path kFound = fs::path(test::kSourceFolder) / "tests/fuzz/found";

class FuzzedReader : public testing::TestWithParam<std::string> {
 protected:
  const Reader& reader() const { return reader_called(GetParam()); }
};

TEST_P(FuzzedReader, ReadsWhatItsCasesAreMadeOf) {
  for (const Seed& seed : reader().seeds()) {
    const TemporaryFolder folder;
    for (const Case& file : unchanged(seed)) write_quickly(folder.path() / file.name, file.bytes);
    const Outcome outcome = outcome_of(reader(), folder.path());
    EXPECT_TRUE(outcome.is_read && outcome.finding.empty()) << seed.name << ": " << outcome.message << outcome.finding;
  }
}

TEST_P(FuzzedReader, StandsWhatOnceBrokeIt) {
  if (!fs::exists(kFound / GetParam())) return;
  for (const auto& entry : fs::directory_iterator(kFound / GetParam())) {
    const TemporaryFolder folder;
    fs::copy(entry.path(), folder.path(), fs::copy_options::recursive);
    EXPECT_EQ(outcome_of(reader(), folder.path()).finding, "") << entry.path();
  }
}

std::vector<std::string> reader_names() {
  std::vector<std::string> names;
  for (const Reader& reader : all_readers()) names.push_back(reader.name);
  return names;
}

INSTANTIATE_TEST_SUITE_P(All, FuzzedReader, testing::ValuesIn(reader_names()), [](const auto& instance) {
  std::string letters = instance.param;
  for (char& letter : letters) letter = letter == '-' ? '_' : letter;
  return letters;
});

TEST(FuzzedReaders, HaveNamesOfTheirOwnAndAllThatWasFoundIsRead) {
  const std::vector<std::string> names = reader_names();
  const std::set<std::string> once(names.begin(), names.end());
  EXPECT_EQ(once.size(), names.size());
  for (const auto& entry : fs::directory_iterator(kFound)) EXPECT_TRUE(once.contains(entry.path().filename())) << entry;
}

// What walks through JSON calls itself: some 40,000 brackets in one another were more than a stack holds.
TEST(FuzzedReaders, RejectJsonThatIsDeeperThanAStackHolds) {
  constexpr std::size_t kDepth = 200'000;
  const std::string deep = ", \"deep\": " + std::string(kDepth, '[') + std::string(kDepth, ']') + "}";
  std::size_t rejected = 0;
  for (const Reader& reader : all_readers()) {
    for (const Seed& seed : reader.seeds()) {
      for (const SeedFile& json : seed.files) {
        if (!json.is_json || json.content.rfind('}') == std::string::npos) continue;
        const TemporaryFolder folder;
        for (const Case& file : unchanged(seed)) write_quickly(folder.path() / file.name, file.bytes);
        const std::string content = json.content.substr(0, json.content.rfind('}')) + deep;
        write_quickly(folder.path() / json.name, json.pack ? json.pack(content) : content);
        const Outcome outcome = outcome_of(reader, folder.path());
        EXPECT_EQ(outcome.finding, "") << reader.name << ", " << json.name;
        if (!outcome.is_read) ++rejected;
      }
    }
  }
  EXPECT_GE(rejected, 15U);
}

TEST(ChangedCase, IsTheSameForTheSameRandomNumbersAndOftenAnother) {
  const std::vector<Seed> seeds = reader_called("plan").seeds();
  std::size_t others = 0;
  for (std::uint64_t seed = 0; seed < 100; ++seed) {
    std::mt19937_64 first(seed), again(seed);
    const Case one = changed_case(seeds.front(), seeds, first);
    EXPECT_EQ(one.bytes, changed_case(seeds.front(), seeds, again).bytes);
    if (one.bytes != seeds.front().files.front().content) ++others;
  }
  EXPECT_GT(others, 80U);
}

}  // namespace
}  // namespace spinaltap::test
