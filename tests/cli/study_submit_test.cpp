// study submit, status and resume, with programs in place of Slurm's that note what they are asked; what the scripts do
// is run by bash. ./run cluster-test does the same with Slurm itself.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>

#include "core/base/staged_output.h"
#include "core/files/json_file.h"
#include "core/files/plan_file.h"
#include "tests/cli/bone_ball.h"
#include "tests/cli/program.h"
#include "tests/support/temporary_folder.h"

namespace spinaltap {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;
using ::testing::Not;

constexpr std::size_t kRuns = 10;

/// A ball of bone, a hole through it, and a folder for programs in place of Slurm's.
class StudySubmit : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = new test::TemporaryFolder;
    test::write_bone_ball(in("bone.vdb"));
    const Vec3 way(0.0, 0.0, 5.0);
    write_plan({{"hole", test::kBoneCentre - 1.4 * way, test::kBoneCentre, {2.0, 30.0, 1.0, BitShape::drill, 0.5}}},
               in("plan.json"));
    const Json spec{{"format", "spinaltap-study"},
                    {"version", 2},
                    {"name", "a \"ball\""},
                    {"bone", "bone.vdb"},
                    {"plan", "plan.json"},
                    {"volume", {{"spacing_mm", 0.2}}},
                    {"operator", {{"kind", "feed"}, {"feed_mm_s", 1.0}, {"step_mm", 0.05}}},
                    {"design",
                     {{"runs", kRuns},
                      {"seed", 3},
                      {"factors", {{"entry_left_mm", {{"normal", {{"mean", 0.0}, {"deviation", 0.5}}}}}}}}}};
    std::ofstream(in("study.json")) << spec.dump(2);
    expect_done("study study.json -o whole");
  }
  static void TearDownTestSuite() { delete folder_; }

  void SetUp() override {
    fs::remove_all(in("s"));
    fs::remove_all(in("slurm bin"));
    fs::create_directory(in("slurm bin"));
    program("sbatch", "printf '%s\\n' \"$*\" >>'" + in("asked").string() +
                          "'; n=$(cat jobs 2>/dev/null || echo 40); n=$((n + 1)); echo $n >jobs; echo \"$n;here\"");
    program("squeue", "cat '" + in("queue").string() + "'");
    program("scontrol", "printf 'scontrol %s\\n' \"$*\" >>'" + in("asked").string() + "'");
    for (const char* file : {"asked", "queue", "jobs"}) std::ofstream(in(file), std::ios::trunc);
    fs::remove(in("jobs"));
  }

  static fs::path in(const std::string& name) { return folder_->path() / name; }
  static void program(const std::string& name, const std::string& script) {
    const fs::path file = in("slurm bin") / name;
    std::ofstream(file) << "#!/bin/sh\n" << script << "\n";
    fs::permissions(file, fs::perms::owner_all);
  }
  static test::ProgramRun run(const std::string& arguments) {
    return test::run_program(arguments, folder_->path(), "PATH='" + in("slurm bin").string() + "':$PATH; export PATH;");
  }
  static test::ProgramRun expect_done(const std::string& arguments) {
    const test::ProgramRun done = run(arguments);
    EXPECT_EQ(done.exit_code, 0) << arguments << "\n" << done.errors;
    return done;
  }
  static std::string asked() { return read_whole_file(in("asked")); }
  /// Runs a script as Slurm runs the task of a shard; `also`: while it is at work.
  static test::ProgramRun task(int shard, const std::string& also = "") {
    return test::run_command("export PATH='" + in("slurm bin").string() +
                                 "':$PATH SLURM_JOB_ID=99 SLURM_ARRAY_TASK_ID=" + std::to_string(shard) +
                                 "; (cd s; exec bash study.sbatch) & task=$!; " + also + " wait $task",
                             folder_->path());
  }

  static const test::TemporaryFolder* folder_;
};

const test::TemporaryFolder* StudySubmit::folder_ = nullptr;

TEST_F(StudySubmit, PrintsItsScriptsAndWritesNothingWhereItIsADryRun) {
  const test::ProgramRun dry = expect_done(
      "study submit study.json -o s --run-seconds 2000 --cpus 2 --max-parallel-tasks 3 --partition fast --account lab "
      "--mem 3G "
      "--sbatch=--constraint=avx2 --sbatch='--exclude=n1,n2' --dry-run --json dry.json");
  for (const char* line :
       {"#!/bin/bash\n", "#SBATCH --array=1-5%3\n", "#SBATCH --cpus-per-task=2\n", "#SBATCH --partition=fast\n",
        "#SBATCH --account=lab\n", "#SBATCH --mem=3G\n", "#SBATCH --constraint=avx2\n", "#SBATCH --exclude=n1,n2\n",
        "#SBATCH --requeue\n", "#SBATCH --signal=B:USR1@120\n", "#SBATCH --job-name=spinaltap-a__ball_\n",
        "#SBATCH --job-name=spinaltap-a__ball_-merge\n", "--dependency=afterok:NUMBER --kill-on-invalid-dep=yes"}) {
    EXPECT_THAT(dry.output, HasSubstr(line));
  }
  // 10 runs of 2,000 s on two processors: 10,000 s are five tasks of half an hour and more; twice 2,000 s, 10 minutes.
  const Json figures = read_json(in("dry.json"));
  EXPECT_EQ(figures["shards"], 5);
  EXPECT_EQ(figures["seconds_a_shard"], 2000.0);
  EXPECT_THAT(dry.output, HasSubstr("#SBATCH --time=01:17:00\n"));
  EXPECT_FALSE(fs::exists(in("s")));
  EXPECT_EQ(asked(), "");
  // Days, and never more shards than runs.
  EXPECT_THAT(expect_done("study submit study.json -o s --run-seconds 1e5 --dry-run").output,
              HasSubstr("#SBATCH --time=2-07:44:00\n"));
  EXPECT_THAT(run("study submit study.json -o s --run-seconds 1 --shards 11 --dry-run").errors,
              HasSubstr("at most 10 shards"));
}

TEST_F(StudySubmit, TimesRunsWhereNobodySaysWhatTheyTake) {
  const test::ProgramRun dry = expect_done("study submit study.json -o s --cpus 2 --dry-run --json timed.json");
  const Json figures = read_json(in("timed.json"));
  EXPECT_GT(figures["cpu_seconds_per_run"], 0.0);
  EXPECT_LT(figures["cpu_seconds_per_run"], 60.0);
  EXPECT_EQ(figures["shards"], 1) << "ten runs of less than a minute";
  EXPECT_THAT(dry.output, HasSubstr("#SBATCH --mem="));
  EXPECT_FALSE(fs::exists(in("s")));
  // Timed in the folder itself, they count.
  expect_done("study submit study.json -o s --cpus 2 --json submitted.json");
  EXPECT_THAT(asked(), HasSubstr("study.sbatch"));
  const Json status = (expect_done("study status s --json status.json"), read_json(in("status.json")));
  EXPECT_GE(status["done"], 2);
  EXPECT_EQ(status["left"].get<int>() + status["done"].get<int>(), kRuns);
}

TEST_F(StudySubmit, SubmitsTellsAndSubmitsWhatIsMissing) {
  expect_done("study submit study.json -o s --run-seconds 1 --shards 4 --max-parallel-tasks 2");
  EXPECT_THAT(asked(),
              HasSubstr("--parsable --chdir=" + in("s").string() + " " + in("s/study.sbatch").string() + "\n"));
  EXPECT_THAT(asked(), HasSubstr("--dependency=afterok:41 --kill-on-invalid-dep=yes " + in("s/merge.sbatch").string()));
  EXPECT_THAT(run("study submit study.json -o s --run-seconds 1").errors, HasSubstr("is there already"));

  // Two are done, one runs, one was lost; so was the merge. Jobs of others are none of ours.
  for (const int shard : {1, 4}) EXPECT_EQ(task(shard).exit_code, 0);
  std::ofstream(in("queue")) << "41|2|RUNNING|None\n7|3|RUNNING|None\n9|N/A|PENDING|Priority\n";
  const test::ProgramRun told = expect_done("study status s --json lost.json");
  const Json status = read_json(in("lost.json"));
  EXPECT_EQ(status["runs"], kRuns);
  EXPECT_EQ(status["queue"], Json({{"RUNNING", 1}}));
  ASSERT_EQ(status["shards"].size(), 4U);
  int done = 0;
  for (const Json& shard : status["shards"]) done += shard["done"].get<int>();
  EXPECT_EQ(status["done"], done);
  EXPECT_EQ(status["shards"][0]["state"], "done");
  EXPECT_EQ(status["shards"][1]["state"], "RUNNING");
  EXPECT_EQ(status["shards"][2]["state"], "not in the queue");
  EXPECT_EQ(status["shards"][3]["done"], status["shards"][3]["runs"]);
  EXPECT_THAT(told.output, HasSubstr("study resume s"));
  EXPECT_THAT(told.output, Not(HasSubstr("shard 4 ")));

  std::ofstream(in("asked"), std::ios::trunc);
  const test::ProgramRun dry = expect_done("study resume s --dry-run");
  EXPECT_THAT(dry.output, HasSubstr("--array=3%2"));
  EXPECT_EQ(asked(), "");
  expect_done("study resume s");
  EXPECT_THAT(asked(), HasSubstr("--array=3%2 " + in("s/study.sbatch").string() + "\n"));
  EXPECT_THAT(asked(), HasSubstr("--dependency=afterok:43:41_2 "));
  // Now it waits there: nothing more to submit.
  std::ofstream(in("queue")) << "41|2|RUNNING|None\n43|3|PENDING|Resources\n44|N/A|PENDING|Dependency\n";
  std::ofstream(in("asked"), std::ios::trunc);
  EXPECT_THAT(expect_done("study resume s").output, HasSubstr("in the queue"));
  EXPECT_EQ(asked(), "");
  EXPECT_THAT(expect_done("study status s").output, HasSubstr("(Resources)"));

  for (const int shard : {2, 3}) EXPECT_EQ(task(shard).exit_code, 0);
  std::ofstream(in("queue"), std::ios::trunc);
  EXPECT_EQ(test::run_command("cd s && bash merge.sbatch", folder_->path()).exit_code, 0);
  for (const char* name : {"runs.csv", "summary.json", "breach_map.csv", "report.html"}) {
    EXPECT_EQ(read_whole_file(in("s") / name), read_whole_file(in("whole") / name)) << name;
  }
  EXPECT_THAT(expect_done("study resume s").output, HasSubstr("all is done"));
  EXPECT_EQ(asked(), "");
}

TEST_F(StudySubmit, ATaskLeavesBetweenRowsAndGoesOn) {
  // Long enough to be met at work: fine steps.
  Json spec = read_json(in("study.json"));
  spec["operator"]["step_mm"] = 0.0005;
  spec["design"]["runs"] = 40;
  std::ofstream(in("long.json")) << spec.dump();
  expect_done("study submit long.json -o s --run-seconds 1 --shards 1");
  const std::string rows = "until [ $(cat s/part-*.csv 2>/dev/null | wc -l) -gt 2 ]; do sleep 0.05; done; ";
  std::ofstream(in("asked"), std::ios::trunc);
  // Cancelled or preempted: Slurm does what comes next.
  const test::ProgramRun left = task(1, rows + "kill -TERM $task;");
  EXPECT_EQ(left.exit_code, 75) << left.errors;
  EXPECT_THAT(left.errors, HasSubstr("told to leave by SIGTERM: "));
  EXPECT_THAT(asked(), Not(HasSubstr("requeue")));
  const std::string part = read_whole_file(in("s/part-1-of-1.csv"));
  EXPECT_EQ(part.back(), '\n') << "a row was cut short";
  // The time is up: it queues again.
  const test::ProgramRun late = task(1, "until [ $(cat s/part-*.csv | wc -l) -gt " +
                                            std::to_string(std::count(part.begin(), part.end(), '\n') + 1) +
                                            " ]; do sleep 0.05; done; kill -USR1 $task;");
  EXPECT_EQ(late.exit_code, 75) << late.errors;
  EXPECT_THAT(late.errors, HasSubstr("told to leave by SIGUSR1: "));
  EXPECT_THAT(asked(), HasSubstr("scontrol requeue 99\n"));
  EXPECT_TRUE(read_whole_file(in("s/part-1-of-1.csv")).starts_with(part));
  // Killed: it is begun again at once, and goes on.
  const test::ProgramRun killed = task(1, "sleep 0.3; until pkill -KILL -P $task spinaltap; do sleep 0.02; done;");
  EXPECT_EQ(killed.exit_code, 0) << killed.errors;
  EXPECT_THAT(killed.output, HasSubstr("ended with 137"));
  EXPECT_TRUE(fs::exists(in("s/runs.csv")));
  expect_done("study long.json -o long");
  EXPECT_EQ(read_whole_file(in("s/runs.csv")), read_whole_file(in("long/runs.csv")));
}

TEST_F(StudySubmit, SaysWhatIsWrong) {
  EXPECT_THAT(run("study").errors, HasSubstr("spec"));
  EXPECT_THAT(run("study status whole").errors, HasSubstr("study submit"));
  EXPECT_THAT(run("study submit study.json -o s --run-seconds 1 --partition 'a\nb' --dry-run").errors,
              HasSubstr("on one line"));
  EXPECT_THAT(run("study submit study.json -o s --run-seconds 1 --sbatch nodelist --dry-run").errors,
              HasSubstr("--constraint=avx2"));
  program("sbatch", "echo 'sbatch: error: invalid partition specified: fast' >&2; exit 1");
  const test::ProgramRun rejected = run("study submit study.json -o s --run-seconds 1 --partition fast");
  EXPECT_EQ(rejected.exit_code, 2);
  EXPECT_THAT(rejected.errors, HasSubstr("invalid partition"));
  SetUp();
  expect_done("study submit study.json -o s --run-seconds 1 --shards 2");
  program("squeue", "echo 'slurm_load_jobs error: Unable to contact slurm controller' >&2; exit 1");
  EXPECT_THAT(run("study resume s").errors, HasSubstr("Unable to contact"));
  fs::rename(in("s"), in("moved"));
  EXPECT_THAT(run("study resume moved").errors, HasSubstr("submit the study again"));
  fs::remove_all(in("moved"));
}

}  // namespace
}  // namespace spinaltap
