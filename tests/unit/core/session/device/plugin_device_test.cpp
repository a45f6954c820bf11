#include "core/session/device/plugin_device.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "core/base/error.h"
#include "core/session/device/coupled_operator.h"
#include "tests/support/drill_block.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/test_paths.h"

namespace spinaltap {
namespace {

std::string plugin_error(const std::filesystem::path& library, const std::string& options = {}) {
  try {
    open_device_plugin(library, options);
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

TEST(PluginDevice, TheExampleIsLoadedAndDrills) {
  const std::unique_ptr<HapticDevice> device = open_device_plugin(test::kExamplePlugin, "push");
  EXPECT_EQ(device->name(), "pushed mass");
  EXPECT_EQ(device->limits().max_force_n, 10.0);
  EXPECT_FALSE(device->limits().senses_turn);
  test::DrillBlock block([](double depth_mm) { return depth_mm > 0.0 ? 500.0 : std::nan(""); });
  SessionOptions options;
  options.has_device = true;
  const auto session = block.session(options);
  CoupledOptions coupled;
  coupled.coupling.force_scale = 0.1;
  coupled.lead_in_mm = 1.0;
  coupled.longest_s = 6.0;
  CoupledOperator hand(*device, block.path, coupled);
  run_session(*session, hand);
  EXPECT_EQ(hand.end(), OperatorEnd::ran_out_of_time);
  EXPECT_EQ(hand.silent_cycles(), 0U);
  // It was pushed 12 mm; what the bone held back of that is in the springs of hand and device.
  EXPECT_GT(session->last().depth_mm, 0.5);
  EXPECT_LT(session->last().depth_mm, 11.0);
  EXPECT_GT(session->last().force.thrust_n, 1.0);
}

TEST(PluginDevice, SaysWhatIsWrongWithALibrary) {
  const test::TemporaryFolder folder;
  EXPECT_THAT(plugin_error(folder.path() / "none.so"), testing::HasSubstr("no such file"));
  EXPECT_THAT(plugin_error(folder.path()), testing::HasSubstr("no such file"));
  const std::filesystem::path text = folder.path() / "text.so";
  std::ofstream(text) << "a text";
  EXPECT_THAT(plugin_error(text), testing::HasSubstr("no shared library that can be loaded"));
  EXPECT_THAT(plugin_error(test::kPluginWithoutEntry),
              testing::HasSubstr("exports spinaltap_device_plugin, found none"));
  EXPECT_THAT(plugin_error(test::kPluginOfOldVersion), testing::HasSubstr("version 1, found version 2"));
  EXPECT_THAT(plugin_error(test::kPluginOfHalf), testing::HasSubstr("lacks some"));
  EXPECT_THAT(plugin_error(test::kExamplePlugin, "pull"), testing::HasSubstr("cannot open the device pushed mass"));
  EXPECT_THAT(plugin_error(test::kExamplePlugin, "pull"), testing::HasSubstr("found pull"));
}

}  // namespace
}  // namespace spinaltap
