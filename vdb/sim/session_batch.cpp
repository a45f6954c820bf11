#include "vdb/sim/session_batch.h"

#include <tbb/blocked_range.h>
#include <tbb/global_control.h>
#include <tbb/info.h>
#include <tbb/parallel_for.h>
#include <tbb/partitioner.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <cstddef>

#include "core/base/error.h"
#include "vdb/sim/build_session.h"

namespace spinaltap {

namespace {

/// What the members of one hole share: bone that nobody drills, and clearances.
struct Hole {
  SessionSetup setup;
  BuiltSession whole;
};

struct Member {
  const Hole* hole = nullptr;
  std::unique_ptr<DrilledBone> bone;
  std::unique_ptr<DrillSession> session;
};

void begin(Member& member) {
  member.session = member.bone->begin_session(member.hole->setup, member.hole->whole.clearances.get());
}

}  // namespace

struct SessionBatch::State {
  std::vector<Bone> bones;  ///< whose walls the clearances ask
  std::vector<std::unique_ptr<Hole>> holes;
  std::vector<Member> members;
  tbb::task_arena arena;
};

SessionBatch::SessionBatch(std::vector<BonePath> holes, std::size_t count, const SessionSetup& setup, int threads,
                           const Progress& progress)
    : state_(std::make_unique<State>()) {
  if (holes.empty()) fail("expected bones and paths to drill, found none");
  if (count == 0) fail("expected 1 session or more, found 0");
  if (threads < 0) fail("expected a number of threads, or 0 for one a core; found ", threads);
  // TBB writes to the terminal where it is asked for more than there are.
  const int max =
      std::min(tbb::info::default_concurrency(),
               static_cast<int>(tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism)));
  state_->arena.initialize(threads > 0 ? std::min(threads, max) : max);
  if (holes.size() > count) holes.erase(holes.begin() + static_cast<std::ptrdiff_t>(count), holes.end());
  for (const BonePath& hole : holes) {
    auto made = std::make_unique<Hole>();
    made->setup = setup;
    made->setup.bone_hash = hole.bone.hash();
    made->setup.path = hole.path;
    made->whole = build_session(hole.bone, made->setup, progress);
    state_->bones.push_back(hole.bone);
    state_->holes.push_back(std::move(made));
  }
  state_->members.resize(count);
  for (std::size_t n = 0; n < count; ++n) {
    Member& member = state_->members[n];
    member.hole = state_->holes[n % holes.size()].get();
    member.bone = std::make_unique<DrilledBone>(member.hole->whole.bone);
    begin(member);
  }
}
SessionBatch::~SessionBatch() = default;
SessionBatch::SessionBatch(SessionBatch&&) noexcept = default;
SessionBatch& SessionBatch::operator=(SessionBatch&&) noexcept = default;

std::size_t SessionBatch::count() const { return state_->members.size(); }

DrillSession& SessionBatch::session(std::size_t n) { return *state_->members.at(n).session; }

DrillSession& SessionBatch::reset(std::size_t n) {
  Member& member = state_->members.at(n);
  member.session.reset();  // it holds on to the bone
  member.bone->restore(member.hole->whole.bone);
  begin(member);
  return *member.session;
}

void SessionBatch::for_each(const std::function<void(std::size_t n)>& work) {
  const std::size_t count = state_->members.size();
  if (count == 1) return work(0);
  state_->arena.execute([&] {
    tbb::parallel_for(
        tbb::blocked_range<std::size_t>(0, count, 1),
        [&work](const tbb::blocked_range<std::size_t>& range) {
          for (std::size_t n = range.begin(); n < range.end(); ++n) work(n);
        },
        tbb::simple_partitioner());
  });
}

}  // namespace spinaltap
