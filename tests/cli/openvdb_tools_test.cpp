// A bone.vdb is read back with OpenVDB's own command line tool. It comes with Debian's libopenvdb-tools, which `./run`
// installs; without it this test fails.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>
#include <sstream>

#include "tests/cli/program.h"
#include "tests/support/analytic_bodies.h"
#include "tests/support/temporary_folder.h"
#include "vdb/grid/diff_grids.h"

namespace spinaltap {
namespace {

using testing::HasSubstr;

/// The lines that `vdb_print -l` prints of each grid, by the grid's name.
std::map<std::string, std::string> sections_of(const std::string& listing) {
  std::map<std::string, std::string> sections;
  std::istringstream lines(listing);
  std::string name;
  for (std::string line; std::getline(lines, line);) {
    const std::string head = "Name: ";
    if (line.rfind(head, 0) == 0) name = line.substr(head.size());
    if (!name.empty()) sections[name] += line + "\n";
  }
  return sections;
}

/// The number in the line that starts with `label`; vdb_print puts commas between thousands.
std::uint64_t number_after(const std::string& section, const std::string& label) {
  const std::size_t at = section.find(label);
  if (at == std::string::npos) return 0;
  std::string digits = section.substr(at + label.size(), section.find('\n', at) - at - label.size());
  std::erase_if(digits, [](char c) { return c < '0' || c > '9'; });
  return digits.empty() ? 0 : std::stoull(digits);
}

std::string corner(const std::array<int, 3>& index) {
  std::ostringstream text;
  text << '[' << index[0] << ", " << index[1] << ", " << index[2] << ']';
  return text.str();
}

TEST(BoneVdb, IsListedByOpenVdbsOwnTool) {
  const test::TemporaryFolder folder;
  const auto file = folder.path() / "bone.vdb";
  const BoneModel bone = test::bake_ball({Vec3(3.0, -2.0, 10.0), 6.0});
  write_bone(bone, file);
  const test::ProgramRun run = test::run_command("vdb_print -l bone.vdb", folder.path());
  ASSERT_EQ(run.exit_code, 0) << run.errors << "vdb_print comes with Debian's libopenvdb-tools";
  const auto sections = sections_of(run.output);
  ASSERT_EQ(sections.size(), 2U) << run.output;

  for (const GridDifference& grid : diff_grids(file, file)) {
    ASSERT_TRUE(sections.contains(grid.name)) << run.output;
    const std::string& section = sections.at(grid.name);
    EXPECT_THAT(section, HasSubstr("Type: Tree_float_5_4_3"));
    EXPECT_EQ(number_after(section, "Number of active voxels:"), grid.a.count);
    EXPECT_THAT(section, HasSubstr(corner(grid.a.low) + " -> " + corner(grid.a.high)));
  }
  EXPECT_EQ(number_after(sections.at("sdf"), "Number of active voxels:"), bone.active_voxels());
  EXPECT_THAT(sections.at("sdf"), HasSubstr("class: level set"));
  EXPECT_THAT(sections.at("sdf"), HasSubstr("voxel size: 0.25"));
  EXPECT_THAT(sections.at("sdf"), HasSubstr("Background value: 0.75"));
  EXPECT_THAT(sections.at("sdf"), HasSubstr("spinaltap:method: ball"));
  EXPECT_THAT(sections.at("hu"), HasSubstr("Background value: -1024"));
  EXPECT_THAT(sections.at("hu"), HasSubstr("is_saved_as_half_float: true"));
}

}  // namespace
}  // namespace spinaltap
