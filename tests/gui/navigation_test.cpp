#include <gmock/gmock.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <Eigen/Geometry>

#include <QComboBox>
#include <QLabel>
#include <QLineEdit>
#include <QPushButton>
#include <cmath>

#include "apps/link/link_frames.h"
#include "apps/spinaltap-planner/navigation/bulls_eye_view.h"
#include "apps/spinaltap-planner/navigation/device_source.h"
#include "apps/spinaltap-planner/navigation/navigation_panel.h"
#include "apps/spinaltap-planner/navigation/record_source.h"
#include "core/base/error.h"
#include "core/session/device/open_device.h"
#include "core/session/record/session_record.h"
#include "core/tool/path_curve.h"
#include "tests/gui/planner_window.h"
#include "tests/unit/apps/link/link_peer.h"
#include "vdb/sim/replay.h"

namespace spinaltap::test {
namespace {

using State = DrillPlayer::State;
using testing::HasSubstr;

DeviceSample sample_after(DesktopDevice& device, int reads) {
  DeviceSample sample;
  for (int n = 0; n < reads; ++n) EXPECT_TRUE(device.read(sample));
  return sample;
}

TEST(NavigationDevice, ComesToWhereTheHandWantsIt) {
  DesktopDevice device;
  DeviceSample sample = sample_after(device, 1);
  EXPECT_EQ(sample.pose.tip_mm, Vec3::Zero());
  EXPECT_EQ(sample.pose.axis, Vec3::UnitZ());
  device.move({1.0, -2.0, 3.0});
  device.press(1U << kSpindleButton);
  sample = sample_after(device, 2000);
  EXPECT_NEAR((sample.pose.tip_mm - Vec3(1.0, -2.0, 3.0)).norm(), 0.0, 1e-6);
  EXPECT_EQ(sample.buttons, 1U);
  EXPECT_NEAR(sample.time_s, 2.001, 1e-9);
  // A key that is held for a second: 2 mm/s.
  device.go({0.0, 0.0, 2.0}, Eigen::Vector2d::Zero());
  sample_after(device, 1000);
  device.go(Vec3::Zero(), Eigen::Vector2d::Zero());
  sample = sample_after(device, 2000);
  EXPECT_NEAR(sample.pose.tip_mm.z(), 5.0, 1e-6);
}

TEST(NavigationDevice, IsHeldBackByTheForceAndByItsLeash) {
  DesktopDevice device;
  // A spring: the force over its stiffness.
  device.give({0.0, 0.0, -3.0}, Vec3::Zero());
  EXPECT_NEAR(sample_after(device, 3000).pose.tip_mm.z(), -3.0 / DesktopDevice::kHandN_mm, 1e-6);
  // Against a wall that gives all that the device can, a hand that goes on for a metre leans no harder.
  device.move({0.0, 0.0, 1000.0});
  device.give({0.0, 0.0, -device.limits().max_force_n}, Vec3::Zero());
  const double held_mm = sample_after(device, 5000).pose.tip_mm.z();
  device.give(Vec3::Zero(), Vec3::Zero());
  const double free_mm = sample_after(device, 5000).pose.tip_mm.z();
  EXPECT_NEAR(free_mm - held_mm, device.limits().max_force_n / DesktopDevice::kHandN_mm, 0.001);
}

TEST(NavigationDevice, LeansOverAsItIsSeen) {
  DesktopDevice device;
  device.lean({0.2, 0.0});
  DeviceSample sample = sample_after(device, 2000);
  EXPECT_NEAR((sample.pose.axis - Vec3(std::sin(0.2), 0.0, std::cos(0.2))).norm(), 0.0, 1e-6);  // to the right
  EXPECT_NEAR(sample.pose.axis.dot(sample.pose.side), 0.0, 1e-12);
  device.lean({-0.2, 0.3});
  sample = sample_after(device, 2000);
  EXPECT_NEAR((sample.pose.axis - Vec3(0.0, std::sin(0.3), std::cos(0.3))).norm(), 0.0, 1e-6);  // downwards
  device.lean({10.0, 0.0});
  sample = sample_after(device, 2000);
  EXPECT_NEAR(std::acos(sample.pose.axis.z()), DesktopDevice::kMostLeanRad, 1e-6);
}

/// The window, with the phantom, its paths and the page of the navigation picture.
class Navigation : public PlannerWindow {
 protected:
  void show_navigation() {
    show_phantom();
    window->show_page("navigate");
    let_work(100);
  }
  DrillPlayer& player() { return planner().player(); }
  BullsEyeView& bulls_eye() { return *window->navigation().findChild<BullsEyeView*>("bulls_eye"); }
  std::string text(const char* name) { return child<QLabel>(name).text().toStdString(); }
  bool wait_for(State state) {
    return wait_until([&] { return player().state() == state; }, 120'000);
  }
  const DrillPath& path() { return *document().chosen_path(); }
  void connect_failed(QString& why) {
    QObject::connect(&player(), &DrillPlayer::failed, window.get(), [&why](const QString& told) { why = told; });
  }
  /// A port of the loopback that nobody listens at.
  static std::uint16_t free_port() {
    const int any = ::socket(AF_INET, SOCK_STREAM, 0);
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    socklen_t size = sizeof address;
    EXPECT_EQ(::bind(any, reinterpret_cast<const sockaddr*>(&address), size), 0);
    EXPECT_EQ(::getsockname(any, reinterpret_cast<sockaddr*>(&address), &size), 0);
    ::close(any);
    return ntohs(address.sin_port);
  }
  /// All that the picture says.
  std::vector<std::string> figures() {
    std::vector<std::string> all;
    for (const char* name :
         {"nav_entry", "nav_target", "nav_tip", "nav_angle", "nav_left", "nav_outer", "nav_canal", "nav_hand"}) {
      all.push_back(text(name) + " " + child<QLabel>(name).styleSheet().toStdString());
    }
    return all;
  }
};

TEST_F(Navigation, DrawsThePlanWhereItIsSeenAlongTheBit) {
  show_navigation();
  const PathCurve curve(path());
  Cycle cycle;
  // 2 mm beside the path, along it: both ends are 2 mm from the middle, on the same side.
  cycle.pose = curve.pose_at(10.0);
  cycle.pose.tip_mm += 2.0 * curve.axes_at(0.0).col(0);
  const NavigationFigures beside = navigation_figures(curve, cycle);
  EXPECT_NEAR(beside.entry_off_mm, 2.0, 1e-9);
  EXPECT_EQ(beside.angle, Alarm::none);
  EXPECT_EQ(beside.left, Alarm::none);
  bulls_eye().show_tool(beside, path());
  const QPointF middle = bulls_eye().place_of(cycle.pose.tip_mm);
  const auto apart_mm = [&](const Vec3& p_mm) {
    return QLineF(middle, bulls_eye().place_of(p_mm)).length() * bulls_eye().mm_per_pixel();
  };
  EXPECT_NEAR(apart_mm(path().entry_mm), 2.0, 0.02);
  EXPECT_NEAR(apart_mm(path().target_mm), 2.0, 0.02);
  // Its tip on the path, 10 mm deep, leaning over by 6 degrees: 10 and length - 10 times sin 6°, on opposite sides.
  cycle.pose = curve.pose_at(10.0);
  cycle.pose.axis = Eigen::AngleAxisd(6.0 * kDegree, curve.axes_at(0.0).col(0)) * cycle.pose.axis;
  const NavigationFigures leaning = navigation_figures(curve, cycle);
  EXPECT_EQ(leaning.angle, Alarm::bad);
  EXPECT_EQ(leaning.worst(), Alarm::bad);
  bulls_eye().show_tool(leaning, path());
  EXPECT_NEAR(apart_mm(path().entry_mm), 10.0 * std::sin(6.0 * kDegree), 0.02);
  EXPECT_NEAR(apart_mm(path().target_mm), (curve.length_mm() - 10.0) * std::sin(6.0 * kDegree), 0.02);
  const QPointF to_entry = bulls_eye().place_of(path().entry_mm) - middle;
  const QPointF to_target = bulls_eye().place_of(path().target_mm) - middle;
  EXPECT_LT(QPointF::dotProduct(to_entry, to_target), 0.0);
}

TEST_F(Navigation, KeyboardAndMouseDrillAreRecordedAndShownAgain) {
  show_navigation();
  child<QComboBox>("nav_source").setCurrentIndex(0);
  input.click(child<QPushButton>("nav_start"));
  ASSERT_TRUE(wait_for(State::drilling)) << box_text.toStdString();
  EXPECT_EQ(child<QPushButton>("nav_start").text(), "Stop");
  ASSERT_TRUE(wait_until([&] { return player().seconds() > 0.3; }));
  EXPECT_THAT(text("nav_state"), HasSubstr("keyboard and mouse"));
  EXPECT_THAT(text("nav_state"), HasSubstr("spindle off"));
  EXPECT_EQ(text("nav_tip"), "0.0 mm");
  EXPECT_EQ(text("nav_angle"), "0.0°");
  // To the right as it is seen, in air: 40 pixels of 0.05 mm.
  const Vec3 before_mm = player().last()->pose.tip_mm;
  const QPoint middle = bulls_eye().rect().center();
  input.drag(bulls_eye(), middle, middle + QPoint(40, 0));
  let_work(800);
  const Vec3 way_mm = player().last()->pose.tip_mm - before_mm;
  const PanePlane view = plane_down_path(path(), 0.0);
  EXPECT_NEAR(way_mm.dot(view.right), 2.0, 0.1);
  EXPECT_NEAR(way_mm.dot(view.down), 0.0, 0.1);
  EXPECT_NEAR(way_mm.dot(view.into()), 0.0, 0.1);
  EXPECT_EQ(text("nav_entry"), "2.0 mm");
  input.drag(bulls_eye(), middle, middle - QPoint(40, 0));
  // Spindle on, and 60 notches of the wheel: bone goes, and is felt.
  bulls_eye().setFocus();
  input.key("space");
  ASSERT_TRUE(wait_until([&] { return player().last()->input.spindle_on; }));
  input.move(bulls_eye(), middle);
  double felt_n = 0.0;
  for (int n = 0; n < 60; ++n) {
    input.wheel(1);
    let_work(30);
    felt_n = std::max(felt_n, player().last()->input.device.force_n.norm());
  }
  EXPECT_GT(felt_n, 0.5);
  EXPECT_GT(player().removed(), 100U);
  EXPECT_GT(player().last()->depth_mm, 1.0);
  // Slices follow the tip.
  EXPECT_LT((planner().view().crosshair_mm() - player().last()->pose.tip_mm).norm(), 1.0);
  input.key("Escape");
  ASSERT_TRUE(wait_for(State::stopped));
  EXPECT_TRUE(player().is_over());
  EXPECT_TRUE(player().orders().empty());  // nobody can have this again but from its record
  let_work(100);
  const std::vector<std::string> shown = figures();
  const QImage picture = bulls_eye().grab().toImage();
  const std::size_t removed = player().removed();
  // The record replays bit for bit, and brings the same picture.
  const std::filesystem::path file = folder.path() / "hand.h5";
  planner().save_record(file);
  ASSERT_TRUE(wait_until([&] { return !planner().job().is_running(); }, 120'000));
  const SessionRecord record = read_record(file);
  EXPECT_TRUE(record.parts.has_device);
  EXPECT_EQ(record.setup.at("operator device"), "keyboard and mouse");
  const Replay again = replay(file, *phantom_bone()->bone);
  EXPECT_TRUE(again.is_same()) << again.difference << again.gap;
  player().undo_hole();
  window->navigation().start("record", text_of(file.string()));
  ASSERT_TRUE(wait_for(State::drilling));
  ASSERT_TRUE(wait_for(State::stopped));
  let_work(100);
  EXPECT_EQ(figures(), shown);
  EXPECT_EQ(bulls_eye().grab().toImage(), picture);
  EXPECT_EQ(player().removed(), removed);
}

TEST_F(Navigation, APluginsDeviceDrillsAndCanBeSteppedBack) {
  show_navigation();
  window->navigation().start("device", "loopback:push=10,seconds=3");
  ASSERT_TRUE(wait_for(State::drilling));
  ASSERT_TRUE(wait_for(State::stopped));
  EXPECT_NEAR(player().seconds(), 3.0, 0.01);  // the hand ends it
  EXPECT_GT(player().last()->input.device.force_n.norm(), 0.1);
  EXPECT_GT(player().removed(), 100U);
  EXPECT_FALSE(player().can_go_on());
  player().step_back(1.0);
  ASSERT_TRUE(wait_for(State::stopped));
  EXPECT_NEAR(player().seconds(), 2.0, 0.01);
  EXPECT_THAT(text("nav_state"), HasSubstr("loopback"));
  // What is no device is said in words.
  player().undo_hole();
  QString why;
  connect_failed(why);
  answer_box(QMessageBox::Ok);
  window->navigation().start("device", "none.so");
  ASSERT_TRUE(wait_until([&] { return !why.isEmpty(); }, 60'000));
  EXPECT_THAT(why.toStdString(), HasSubstr("no such file: none.so"));
}

TEST_F(Navigation, ALinkedToolIsShownAndItsLossIsTold) {
  show_navigation();
  const std::uint16_t port = free_port();
  window->navigation().start("listen", QString::number(port));
  const PathCurve curve(path());
  Pose tool = curve.pose_at(-5.0);
  tool.tip_mm += 1.5 * curve.axes_at(0.0).col(1);
  std::unique_ptr<LinkTestPeer> peer;
  ASSERT_TRUE(wait_until(
      [&] {
        if (!peer || !peer->is_connected()) peer = std::make_unique<LinkTestPeer>(port);
        if (peer->is_connected()) peer->send_transform("Tool", bit_in_ras(tool));
        return player().state() == State::drilling && player().last() && player().seconds() > 0.2;
      },
      120'000));
  EXPECT_EQ(text("nav_entry"), "1.5 mm");
  EXPECT_EQ(text("nav_target"), "1.5 mm");
  EXPECT_EQ(text("nav_angle"), "0.0°");
  EXPECT_EQ(text("nav_left"), QStringLiteral("%1 mm").arg(curve.length_mm() + 5.0, 0, 'f', 1).toStdString());
  EXPECT_TRUE(peer->receive("TRANSFORM", "Bit").has_value());
  EXPECT_TRUE(peer->receive("POINT", "Plan").has_value());
  // It drills in by 8 mm, 10 mm/s.
  for (int n = 0; n < 130; ++n) {
    tool.tip_mm += 0.1 * tool.axis;
    peer->send_transform("Tool", bit_in_ras(tool));
    let_work(10);
  }
  EXPECT_NEAR(player().last()->depth_mm, 8.0, 0.3);
  EXPECT_GT(player().removed(), 100U);
  // Nothing for half a second: not seen, and the spindle off.
  ASSERT_TRUE(wait_until([&] { return player().last()->input.device.status == DeviceStatus::lost; }, 5000));
  let_work(100);
  EXPECT_THAT(text("nav_state"), HasSubstr("TOOL NOT SEEN"));
  EXPECT_FALSE(player().last()->input.spindle_on);
  peer->send_string("Command", "END");
  ASSERT_TRUE(wait_for(State::stopped));
  // The port is free again.
  EXPECT_TRUE(wait_until([&] { return !LinkTestPeer(port).is_connected(); }));
  const std::filesystem::path file = folder.path() / "linked.h5";
  planner().save_record(file);
  ASSERT_TRUE(wait_until([&] { return !planner().job().is_running(); }, 120'000));
  const Replay again = replay(file, *phantom_bone()->bone);
  EXPECT_TRUE(again.is_same()) << again.difference << again.gap;
}

TEST_F(Navigation, RejectsWrongSourcesInWords) {
  show_navigation();
  const auto why = [&](const char* source, const QString& address) -> std::string {
    try {
      window->navigation().start(source, address);
    } catch (const Error& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_THAT(why("foot", ""), HasSubstr("expected hand, device, listen, connect or record"));
  EXPECT_THAT(why("listen", "port"), HasSubstr("expected a port"));
  EXPECT_THAT(why("connect", ":18944"), HasSubstr("expected a server as HOST:PORT"));
  EXPECT_THAT(why("record", text_of(phantom_file().string())), HasSubstr("expected an HDF5 file"));
  EXPECT_EQ(player().state(), State::idle);
}

}  // namespace
}  // namespace spinaltap::test
