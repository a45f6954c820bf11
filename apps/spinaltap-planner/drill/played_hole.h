#pragma once

#include <array>
#include <cstddef>
#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "apps/report/operator_choice.h"
#include "apps/spinaltap-planner/navigation/navigation_source.h"
#include "apps/spinaltap-planner/opened_bone.h"
#include "core/base/progress.h"
#include "core/session/depth_log.h"
#include "core/session/operator/milling.h"
#include "vdb/sim/session.h"

namespace spinaltap {

/// How the chosen path is drilled.
struct DrillPlan {
  /// on-path, off-path, tilted, tremor, push: as `spinaltap drill --operator`; or milling
  std::string tool_operator = "on-path";
  double feed_mm_s = 1.0;                       ///< of all operators but push and milling, whose feed is its own
  double push_n = 40.0;                         ///< of the operator push
  bool stops_on_breach = false;                 ///< of the outer surface or the canal; a milling takes both away
  double speed = 1.0;                           ///< of the clock: 2 is twice life's; 0: as fast as it goes
  EngineKind engine = EngineKind::automatic;    ///< which is what serves the operator best
  std::shared_ptr<const Milling> milling = {};  ///< of the operator milling
  /// Of the operator "navigation": who moves the tool, in place of all of the above but the path; null of all others.
  std::shared_ptr<NavigationSource> source = {};
};

/// Throws Error where the operator is a milling and there is none.
OperatorChoice operator_choice(const DrillPlan& plan);

/// The session that drills a path so, with the shipped density calibrations and cutting models. Throws Error where they
/// are not there.
SessionSetup session_setup(const DrillPath& path, const DrillPlan& plan);

/// All that it takes to drill a hole again, bit for bit; to be read from any thread.
struct DoneDrilling {
  std::shared_ptr<const OpenedBone> bone;
  SessionSetup setup;
  std::map<std::string, std::string> operator_words;  ///< OperatorPlan::words
  std::vector<ToolInput> inputs;
};

/// A hole while it is drilled: a session, the operator that drills it and what has come of it. Operator and session go
/// in lock-step whatever the clock does, so that the hole can be had again at any of its cycles. For one thread at a
/// time.
class PlayedHole {
 public:
  /// `other`: a hole of the same bone, which saves work where it has the same path; may be null. Throws Error where the
  /// path misses the bone or what is asked of the operator makes no sense. `source`: moves the tool in place of the
  /// operator; may be null.
  PlayedHole(std::shared_ptr<const OpenedBone> bone, SessionSetup setup, OperatorChoice tool_operator,
             const PlayedHole* other = {}, const Progress& progress = {},
             std::shared_ptr<NavigationSource> source = {});
  ~PlayedHole();

  /// A cycle. False: the operator has ended.
  bool step();
  /// The same hole when it had only its first cycles; at least one.
  std::unique_ptr<PlayedHole> after(std::size_t cycles, const Progress& progress = {}) const;
  /// How many cycles there were so many seconds of the operator's time ago; at least one.
  std::size_t cycles_before(double seconds) const;

  /// Of one that a live source drills: it stops, and the source is let go. Others go on later.
  void stop();
  bool is_over() const { return is_over_; }
  double rate_hz() const { return operator_.rate_hz; }
  const SessionSetup& setup() const { return setup_; }
  /// One for each cycle.
  const std::vector<ToolInput>& inputs() const { return inputs_; }
  const Cycle& last() const { return session_.last(); }
  std::span<const SessionEvent> events() const { return session_.events(); }
  std::size_t removed() const { return removed_; }
  /// The rows that are whole.
  const std::vector<DepthRow>& rows() const { return log_.rows(); }
  /// With the one that is not.
  std::vector<DepthRow> all_rows() const { return DepthLog(log_).finish(); }
  DrilledHole drilled() const;
  DoneDrilling done() const { return {bone_, setup_, operator_.words, inputs_}; }

 private:
  std::shared_ptr<const OpenedBone> bone_;
  SessionSetup setup_;
  OperatorChoice choice_;
  std::shared_ptr<NavigationSource> source_;
  OperatorPlan operator_;
  Session session_;
  DepthLog log_;
  std::vector<ToolInput> inputs_;
  std::size_t removed_ = 0;
  bool is_over_ = false;
};

/// Both run the drilling's cycles again, which takes some seconds. From any thread.

/// Writes a record as `spinaltap drill --record` does, which `replay` and `export` read; replaces a file that is there.
/// Throws Error as RecordWriter does.
void write_record(const DoneDrilling& drilling, const std::filesystem::path& path, const Progress& progress = {});

/// Names of what write_report() writes.
inline constexpr std::array kDrillReportFiles{"report.html", "drilled.vdb", "drilled.stl", "log.csv", "events.csv"};

/// Writes kDrillReportFiles into a folder, as `spinaltap drill` does.
/// Earlier holes are in the drilled bone, too. Throws Error where the folder cannot be written.
void write_report(const DoneDrilling& drilling, const std::filesystem::path& folder, const Progress& progress = {});

}  // namespace spinaltap
