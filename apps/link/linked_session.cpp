#include "apps/link/linked_session.h"

#include <algorithm>
#include <map>
#include <optional>

#include "apps/link/link_exchange.h"
#include "core/base/error.h"
#include "core/files/recorded_setup.h"
#include "core/session/record/session_record.h"
#include "core/tool/path_curve.h"
#include "vdb/sim/build_session.h"

namespace spinaltap {

LinkedSession drill_linked(const Bone& bone, SessionSetup setup, const LinkedOptions& options,
                           const Progress& progress) {
  name_bones(setup, {&bone, 1});
  BuiltSession built = build_session(bone, setup, progress);
  LinkedSession linked;
  std::optional<RecordWriter> record;
  if (!options.record.empty()) {
    std::map<std::string, std::string> words = record_setup(setup);
    words["operator"] = "link";
    words["pace"] = "real time";
    record.emplace(options.record, words, options.may_replace_record, std::nullopt,
                   record_parts(setup.path.bit, setup.options));
  }
  LinkServerOptions server_options = options.server;
  server_options.points = plan_points(setup.path);
  server_options.stale_s = options.loop.tracking.stale_s;
  LinkServer server(server_options);
  std::optional<LinkMesh> mesh;
  if (options.mesh.kind != LinkMeshKind::none) {
    progress.report("meshing", 0.0);
    LinkMeshOptions mesh_options = options.mesh;
    mesh_options.name = options.server.names.bone;
    mesh.emplace(bone.model(), setup.path.bit, setup.options.max_jump_mm, server, mesh_options);
  }
  if (options.ready) options.ready(server.port());
  DrillSession& session = *built.session;
  const auto observe = [&](const Cycle& cycle) {
    linked.max_thrust_n = std::max(linked.max_thrust_n, cycle.force.thrust_n);
    linked.max_depth_mm = std::max(linked.max_depth_mm, cycle.depth_mm);
    if (mesh) mesh->take(cutting_input(cycle, session.options()));
    if (!record) return;
    record->add(cycle);  // where it is lost, the record counts it
    record->add_events(session.events());
  };
  linked.loop = run_link(session, server, options.loop, observe, progress);
  if (mesh) {
    mesh->end();
    linked.mesh_updates = mesh->updates();
    linked.mesh_lost = mesh->lost();
  }
  linked.events.assign(session.events().begin(), session.events().end());
  linked.is_stopped = session.is_stopped();
  linked.network = server.end();
  if (record) {
    try {
      record->close(session.events());
    } catch (const Error& error) {
      linked.record_trouble = error.what();
    }
    linked.not_recorded = record->lost();
  }
  return linked;
}

}  // namespace spinaltap
