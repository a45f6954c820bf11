#pragma once

#include <atomic>
#include <cstdint>
#include <map>
#include <string>
#include <thread>

#include "apps/link/link_ring.h"
#include "apps/link/link_server.h"
#include "core/session/operator/operator.h"
#include "vdb/remaining/live_mesh.h"

namespace spinaltap {

/// How peers get the bone's surface.
enum class LinkMeshKind : std::uint8_t {
  none,
  whole,  ///< one POLYDATA, again while it changes: for 3D Slicer, which makes a model of each name
  blocks  ///< a POLYDATA for each block of 8 x 8 x 8 cells, and again those that changed: for simulators
};

struct LinkMeshOptions {
  LinkMeshKind kind = LinkMeshKind::whole;
  double rate_hz = 30.0;  ///< of updates; a whole bone is sent once a second at most
  std::string name = "Bone";
};

/// The bone as it is drilled, in a thread of its own beside the session, which hands it the inputs without waiting.
class LinkMesh {
 public:
  /// Meshes the whole bone, gives it to the server, and starts the thread. Throws Error on a rate out of range.
  LinkMesh(const BoneModel& bone, const DrillBit& bit, double max_jump_mm, LinkServer& server,
           const LinkMeshOptions& options);
  ~LinkMesh();
  LinkMesh(const LinkMesh&) = delete;
  LinkMesh& operator=(const LinkMesh&) = delete;

  /// What a cycle's input took: cutting_input(). From the session's thread.
  void take(const ToolInput& input) noexcept { inputs_.give(input); }
  /// Takes what was handed over until now, and ends the thread.
  void end();
  std::uint64_t updates() const { return updates_; }
  /// Inputs that found the ring full: the bone that is shown has more left than there is.
  std::size_t lost() const { return inputs_.lost(); }

 private:
  void run();
  bool update();
  void give_whole();
  void give_blocks(std::span<const SurfaceUpdate> updates);

  LinkMeshOptions options_;
  LinkServer& server_;
  LiveMesh mesh_;
  LinkRing<ToolInput> inputs_{65536};  // a minute at 1 kHz
  bool has_changed_ = false;
  std::atomic<bool> ends_{false};
  std::atomic<std::uint64_t> updates_{0};
  std::thread thread_;
};

/// All of a surface in the frame outside (RAS).
std::string whole_surface(const RemainingSurface& surface);
std::string block_surface(const SurfaceBlock& block);
/// "Bone_-3_12_40"
std::string block_name(const std::string& bone, const std::array<int, 3>& block);

}  // namespace spinaltap
