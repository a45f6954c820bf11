// consumer BONE PLAN RECORD: uses the installed library from outside: loads a bone, drills the plan's first path as
// `spinaltap drill --record` does, and prints the record's fingerprint.

#include <spinaltap/spinaltap.h>

#include <cstdio>
#include <filesystem>

int main(int argc, char** argv) {
  using namespace spinaltap;
  if (argc != 4) return 2;
  try {
    const Bone bone = Bone::load(argv[1]);
    const DrillPath path = read_plan(argv[2]).front();
    Session session(bone, path);
    std::filesystem::remove(argv[3]);
    session.record(argv[3]);
    PlannedMotion tool_operator(path, {.line = {.lead_in_mm = session.setup().volume.lead_in_mm}});
    session.run(tool_operator);
    session.end_record();
    const Replay again = replay(argv[3], bone);
    std::printf("SpinalTap %s: %zu triangles; shipped files in %s\n", std::string(version()).c_str(),
                bone.surface().triangles.size(), data_file("phantom/l3.json").c_str());
    std::printf("record %s\n", hash_of(read_record(argv[3])).c_str());
    return again.is_same() ? 0 : 1;
  } catch (const Error& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
}
