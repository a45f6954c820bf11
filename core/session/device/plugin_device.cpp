#include "core/session/device/plugin_device.h"

#include <dlfcn.h>

#include <array>
#include <cstring>
#include <string>

#include "core/base/error.h"
#include "core/session/device/device_plugin.h"

namespace spinaltap {
namespace {

using PluginTable = spinaltap_device_plugin_table;

struct PluginLibraryCloser {
  void operator()(void* library) const { dlclose(library); }
};
using PluginLibrary = std::unique_ptr<void, PluginLibraryCloser>;

std::string plugin_loader_words() {
  const char* const words = dlerror();
  return words != nullptr ? words : "no reason given";
}

PluginLibrary load_plugin_library(const std::filesystem::path& file) {
  std::error_code none;
  if (!std::filesystem::is_regular_file(file, none)) {
    fail_as(ErrorKind::file, "expected a device's plug-in, found no such file: ", file.string());
  }
  // The whole path: else the loader looks in the system's folders.
  void* const library = dlopen(std::filesystem::absolute(file).c_str(), RTLD_NOW | RTLD_LOCAL);
  if (library == nullptr) {
    fail("expected a device's plug-in, found no shared library that can be loaded in ", file.string(), ": ",
         plugin_loader_words());
  }
  return PluginLibrary(library);
}

const PluginTable& plugin_table_of(const PluginLibrary& library, const std::filesystem::path& file) {
  void* const symbol = dlsym(library.get(), SPINALTAP_DEVICE_SYMBOL);
  if (symbol == nullptr) {
    fail("expected a device's plug-in that exports ", SPINALTAP_DEVICE_SYMBOL, ", found none in ", file.string());
  }
  spinaltap_device_plugin_function function = nullptr;
  static_assert(sizeof function == sizeof symbol);
  std::memcpy(&function, &symbol, sizeof function);
  const PluginTable* const table = function();
  if (table == nullptr) fail("expected a device's plug-in, found one that gives no table in ", file.string());
  if (table->abi != SPINALTAP_DEVICE_ABI) {
    fail("expected a device's plug-in of version ", SPINALTAP_DEVICE_ABI, ", found version ", table->abi, " in ",
         file.string());
  }
  if (table->open == nullptr || table->close == nullptr || table->describe == nullptr || table->read == nullptr ||
      table->give == nullptr) {
    fail("expected a device's plug-in with open, close, describe, read and give, found one that lacks some in ",
         file.string());
  }
  return *table;
}

class PluginDevice final : public HapticDevice {
 public:
  PluginDevice(const std::filesystem::path& file, const std::string& options)
      : library_(load_plugin_library(file)), table_(plugin_table_of(library_, file)) {
    std::array<char, 512> why{};
    device_ = table_.open(options.c_str(), why.data(), static_cast<std::uint32_t>(why.size()));
    why.back() = '\0';
    name_ = table_.name != nullptr ? table_.name : file.filename().string();
    if (device_ == nullptr) {
      fail("cannot open the device ", name_, " of ", file.string(), ": ",
           why.front() != '\0' ? why.data() : "it does not say why");
    }
    try {
      take_limits();
    } catch (...) {
      table_.close(device_);
      throw;
    }
  }
  ~PluginDevice() override { table_.close(device_); }

  const std::string& name() const override { return name_; }
  const DeviceLimits& limits() const override { return limits_; }

  bool read(DeviceSample& sample) noexcept override {
    spinaltap_device_sample said{};
    if (table_.read(device_, &said) != 1) return false;
    const auto vector = [](const double(&from)[3]) { return Vec3(from[0], from[1], from[2]); };
    sample.pose = {vector(said.tip_mm), vector(said.axis), vector(said.side)};
    sample.buttons = said.buttons;
    sample.time_s = said.time_s;
    return true;
  }

  bool give(const Vec3& force_n, const Vec3& torque_n_mm) noexcept override {
    return table_.give(device_, force_n.data(), torque_n_mm.data()) > 0;
  }

 private:
  void take_limits() {
    spinaltap_device_limits said{};
    table_.describe(device_, &said);
    limits_.rate_hz = said.rate_hz;
    limits_.delay_s = said.delay_s;
    limits_.max_force_n = said.max_force_n;
    limits_.max_stiffness_n_mm = said.max_stiffness_n_mm;
    limits_.mass_kg = said.mass_kg;
    limits_.damping_n_s_mm = said.damping_n_s_mm;
    limits_.friction_n = said.friction_n;
    limits_.position_step_mm = said.position_step_mm;
    limits_.senses_turn = said.senses_turn != 0;
    limits_.gives_torque = said.gives_torque != 0;
    limits_.max_torque_n_mm = said.max_torque_n_mm;
    limits_.max_stiffness_n_mm_rad = said.max_stiffness_n_mm_rad;
    limits_.inertia_kg_mm2 = said.inertia_kg_mm2;
    limits_.damping_n_mm_s_rad = said.damping_n_mm_s_rad;
    limits_.angle_step_rad = said.angle_step_rad;
    check_device_limits(limits_);
  }

  PluginLibrary library_;  ///< before what lies in it
  const PluginTable& table_;
  void* device_ = nullptr;
  std::string name_;
  DeviceLimits limits_;
};

}  // namespace

std::unique_ptr<HapticDevice> open_device_plugin(const std::filesystem::path& library, const std::string& options) {
  return std::make_unique<PluginDevice>(library, options);
}

}  // namespace spinaltap
