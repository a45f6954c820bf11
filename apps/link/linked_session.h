#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "apps/link/link_loop.h"
#include "apps/link/link_mesh.h"
#include "apps/link/link_server.h"
#include "core/session/session_setup.h"
#include "vdb/sim/bone.h"

namespace spinaltap {

/// What a session of a tracked tool has where nothing else is asked for: voxels of 0.2 mm, so that the tool may come
/// from anywhere and a cycle is short (points, where they are asked for, within 6 mm of the path); and a way of over
/// 20 mm between two poses is a slip of the tracker, which is not cut.
void set_linked_defaults(SessionSetup& setup);

struct LinkedOptions {
  LinkServerOptions server = {};  ///< its points are put in: the path's entry and target, without names of their own
  LinkLoopOptions loop = {};
  LinkMeshOptions mesh = {};
  std::filesystem::path record;  ///< empty: none
  bool may_replace_record = false;
  /// Called when peers may connect, with the port; 0 where none may.
  std::function<void(std::uint16_t port)> ready = {};
};

struct LinkedSession {
  LinkLoopReport loop;
  LinkReport network;
  std::vector<SessionEvent> events;
  double max_thrust_n = 0.0;
  double max_depth_mm = 0.0;
  bool is_stopped = false;  ///< a rule asked to
  std::uint64_t not_recorded = 0;
  std::string record_trouble;  ///< what the disk said; empty while all is well
  std::uint64_t mesh_updates = 0;
  std::uint64_t mesh_lost = 0;  ///< cycles that came too fast for the bone that is sent
};

/// Drills a bone with what is tracked over OpenIGTLink: begins the session of `setup`, whose path is the plan's, opens
/// the server, and runs until it ends. Nothing of where the bone came from goes out: neither names of patients, files
/// and plans nor a CT. Throws Error as Session and LinkServer do; nothing listens then.
LinkedSession drill_linked(const Bone& bone, const SessionSetup& setup, const LinkedOptions& options,
                           const Progress& progress = {});

}  // namespace spinaltap
