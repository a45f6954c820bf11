#include "apps/link/linked_session.h"

#include <algorithm>
#include <optional>

#include "apps/link/link_exchange.h"
#include "core/base/error.h"
#include "core/session/cutting_motion.h"
#include "vdb/sim/session.h"

namespace spinaltap {

void set_linked_defaults(SessionSetup& setup) {
  setup.engine = EngineKind::voxel;
  setup.volume.spacing_mm = 0.2;
  setup.volume.radius_mm = 6.0;
  setup.options.max_jump_mm = 20.0;
}

LinkedSession drill_linked(const Bone& bone, const SessionSetup& setup, const LinkedOptions& options,
                           const Progress& progress) {
  Session session(bone, setup.path, setup, progress);
  LinkedSession linked;
  if (!options.record.empty()) {
    session.record(options.record, {.words = {{"operator", "link"}, {"pace", "real time"}},
                                    .may_replace = options.may_replace_record,
                                    .waits = false});
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
  const auto observe = [&](const Cycle& cycle) {
    linked.max_thrust_n = std::max(linked.max_thrust_n, cycle.force.thrust_n);
    linked.max_depth_mm = std::max(linked.max_depth_mm, cycle.depth_mm);
    if (mesh) mesh->take(cutting_input(cycle, setup.options));
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
  try {
    session.end_record();
  } catch (const Error& error) {
    linked.record_trouble = error.what();
  }
  linked.not_recorded = session.record_lost();
  return linked;
}

}  // namespace spinaltap
