#include "core/session/operator/recorded_motion.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <string>

#include "core/base/error.h"
#include "core/base/file_stream.h"
#include "core/base/text_fields.h"

namespace spinaltap {
namespace {

constexpr std::size_t kColumns = 11;
constexpr std::size_t kNeeded = 7;
constexpr std::array<std::string_view, kColumns> kNames{"time_s", "x_mm",       "y_mm",   "z_mm",   "axis_x", "axis_y",
                                                        "axis_z", "spindle_on", "side_x", "side_y", "side_z"};
constexpr std::size_t kSpindle = 7;
constexpr std::size_t kSide = 8;
/// How far a side may lie off a right angle with the axis, as a sine: what poses are allowed.
constexpr double kMaxSideLean = 0.01;

class PoseCsvReader {
 public:
  PoseCsvReader(const std::filesystem::path& path, const PoseCsvOptions& options) : file_(path), options_(options) {}

  std::vector<ToolInput> read() {
    std::string_view line;
    if (!lines_.next_filled(line)) fail("expected poses with a line of column names, found nothing in ", file_.name());
    take_header(without_byte_order_mark(line));
    while (lines_.next_filled(line)) add(line);
    if (inputs_.empty()) fail("expected a pose at least, found none in ", file_.name());
    // The first pose has no way: the time before it is as good as that after it.
    inputs_.front().dt_s = inputs_.size() > 1 ? inputs_[1].dt_s : ToolInput{}.dt_s;
    return std::move(inputs_);
  }

 private:
  void take_header(std::string_view header) {
    std::array<bool, kColumns> found{};
    CsvFields fields(header);
    for (std::string_view field; fields.next(field);) {
      const auto role =
          static_cast<std::size_t>(std::find(kNames.begin(), kNames.end(), csv_column_name(field)) - kNames.begin());
      role_.push_back(role);
      if (role == kColumns) continue;
      if (found[role]) fail("expected one column ", kNames[role], ", found two in ", lines_.place());
      found[role] = true;
    }
    for (std::size_t role = 0; role < kNeeded; ++role) {
      if (!found[role]) fail("expected a column ", kNames[role], ", found ", in_quotes(header), " in ", lines_.place());
    }
    if (found[kSide] != found[kSide + 1] || found[kSide] != found[kSide + 2]) {
      fail("expected side_x, side_y and side_z, all or none, found ", in_quotes(header), " in ", lines_.place());
    }
  }

  void add(std::string_view line) {
    std::array<double, kColumns> row{};
    row[kSpindle] = 1.0;
    CsvFields fields(line);
    std::size_t count = 0;
    for (std::string_view field; fields.next(field); ++count) {
      const std::size_t role = count < role_.size() ? role_[count] : kColumns;
      if (role == kColumns) continue;
      if (role >= kSide && field.find_first_not_of(" \t\r") == std::string_view::npos) continue;  // not said
      const std::optional<double> number = parse_number(field);
      if (!number) fail("expected a number as ", kNames[role], ", found ", in_quotes(field), " in ", lines_.place());
      row[role] = *number;
    }
    if (count != role_.size()) fail("expected ", role_.size(), " columns, found ", count, " in ", lines_.place());
    add(row);
  }

  void add(const std::array<double, kColumns>& row) {
    const double time_s = row[0];
    if (!std::isfinite(time_s) || (!inputs_.empty() && !(time_s > time_s_))) {
      fail("expected times that rise, found ", time_s, " s after ", time_s_, " s in ", lines_.place());
    }
    if (row[kSpindle] != 0.0 && row[kSpindle] != 1.0) {
      fail("expected 0 or 1 as spindle_on, found ", row[kSpindle], " in ", lines_.place());
    }
    ToolInput input;
    input.pose = {Vec3(row[1], row[2], row[3]), Vec3(row[4], row[5], row[6])};
    input.spindle_on = row[kSpindle] == 1.0;
    input.dt_s = time_s - time_s_;
    const double length = input.pose.axis.norm();
    const bool is_good = input.pose.tip_mm.allFinite() && std::isfinite(length) && length > 0.0;
    if (is_good) input.pose.axis /= length;
    if (!is_good && !options_.lets_bad_poses_pass) {
      fail("expected a tip and an axis that are finite, and an axis that is not zero, found (", row[1], ", ", row[2],
           ", ", row[3], ") and (", row[4], ", ", row[5], ", ", row[6], ") in ", lines_.place());
    }
    take_side(Vec3(row[kSide], row[kSide + 1], row[kSide + 2]), input.pose, is_good);
    time_s_ = time_s;
    inputs_.push_back(input);
  }

  /// None where it is zero.
  void take_side(const Vec3& given, Pose& pose, bool has_axis) {
    if (given == Vec3::Zero()) return;
    const double length = given.norm();
    const bool is_across = has_axis && std::isfinite(length) && std::abs(given.dot(pose.axis)) <= kMaxSideLean * length;
    pose.side = is_across ? Vec3(given / length) : given;
    if (is_across || options_.lets_bad_poses_pass) return;
    fail("expected a side that is finite and across the axis, found (", given.x(), ", ", given.y(), ", ", given.z(),
         ") in ", lines_.place());
  }

  FileReader file_;
  TextLines lines_{file_};
  PoseCsvOptions options_;
  std::vector<std::size_t> role_;  ///< of each column of the file: which of kNames it is; kColumns: none
  std::vector<ToolInput> inputs_;
  double time_s_ = 0.0;
};

}  // namespace

std::vector<ToolInput> read_pose_csv(const std::filesystem::path& path, const PoseCsvOptions& options) {
  return PoseCsvReader(path, options).read();
}

}  // namespace spinaltap
