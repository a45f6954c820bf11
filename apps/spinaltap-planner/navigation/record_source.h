#pragma once

#include <filesystem>
#include <map>
#include <vector>

#include "apps/spinaltap-planner/navigation/navigation_source.h"
#include "vdb/sim/bone.h"

namespace spinaltap {

/// What somebody did before, cycle by cycle: the same session and the same inputs, so that every number and the bone
/// are the same.
class RecordSource final : public NavigationSource {
 public:
  /// `setup`: of that session, with the engine it had.
  RecordSource(SessionSetup setup, std::vector<ToolInput> inputs, std::map<std::string, std::string> operator_words);

  std::string name() const override { return name_; }
  void prepare(SessionSetup& setup) const override { setup = setup_; }
  OperatorPlan begin(const SessionSetup& setup, const Progress& progress) override;
  bool is_live() const override { return false; }

  const SessionSetup& setup() const { return setup_; }
  void set_name(std::string name) { name_ = std::move(name); }

 private:
  std::string name_ = "a record";
  SessionSetup setup_;
  std::vector<ToolInput> inputs_;
  std::map<std::string, std::string> words_;
};

/// A record that `spinaltap` or the planner wrote, of this bone. Throws Error where it is none, of another bone, of
/// several, or of one that had holes before.
std::shared_ptr<RecordSource> open_record(const std::filesystem::path& file, const Bone& bone);

}  // namespace spinaltap
