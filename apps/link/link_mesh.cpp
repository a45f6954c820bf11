#include "apps/link/link_mesh.h"

#include <chrono>
#include <vector>

#include "core/base/error.h"
#include "core/session/real_time/timing.h"

namespace spinaltap {
namespace {

void append_block(const SurfaceBlock& block, std::vector<Eigen::Vector3f>& vertices_mm,
                  std::vector<std::array<std::uint32_t, 3>>& triangles) {
  const auto first = static_cast<std::uint32_t>(vertices_mm.size());
  for (const Eigen::Vector3f& vertex : block.vertices_mm) vertices_mm.push_back(ras_from_lps(vertex));
  for (const auto& [a, b, c] : block.triangles) triangles.push_back({first + a, first + b, first + c});
}

}  // namespace

std::string whole_surface(const RemainingSurface& surface) {
  std::vector<Eigen::Vector3f> vertices_mm;
  std::vector<std::array<std::uint32_t, 3>> triangles;
  for (const auto& block : surface.blocks()) append_block(*block, vertices_mm, triangles);
  return triangles.empty() ? std::string() : polydata_content(vertices_mm, triangles);
}

std::string block_surface(const SurfaceBlock& block) {
  std::vector<Eigen::Vector3f> vertices_mm;
  std::vector<std::array<std::uint32_t, 3>> triangles;
  append_block(block, vertices_mm, triangles);
  return triangles.empty() ? std::string() : polydata_content(vertices_mm, triangles);
}

std::string block_name(const std::string& bone, const std::array<int, 3>& block) {
  std::string name = bone;
  for (const int index : block) name += "_" + std::to_string(index);
  return name;
}

LinkMesh::LinkMesh(const BoneModel& bone, const DrillBit& bit, double max_jump_mm, LinkServer& server,
                   const LinkMeshOptions& options)
    : options_(options), server_(server), mesh_(bone, bit, max_jump_mm) {
  if (!(options.rate_hz >= 0.1 && options.rate_hz <= 1000.0)) {
    fail("link: expected a rate of 0.1 to 1000 Hz for the bone, found ", options.rate_hz, " Hz");
  }
  if (options_.kind == LinkMeshKind::whole) give_whole();
  if (options_.kind == LinkMeshKind::blocks) {
    std::vector<SurfaceUpdate> all;
    for (const auto& block : mesh_.surface().blocks()) all.push_back({block->block, block});
    give_blocks(all);
  }
  thread_ = std::thread([this] { run(); });
}

LinkMesh::~LinkMesh() { end(); }

void LinkMesh::end() {
  ends_ = true;
  if (thread_.joinable()) thread_.join();
}

void LinkMesh::run() {
  constexpr std::int64_t kWholeNs = 1'000'000'000;
  const auto period =
      std::chrono::duration_cast<std::chrono::nanoseconds>(std::chrono::duration<double>(1.0 / options_.rate_hz));
  std::int64_t whole_ns = wall_ns();
  for (bool is_last = false; !is_last;) {
    std::this_thread::sleep_for(std::min(period, std::chrono::nanoseconds(std::chrono::milliseconds(200))));
    is_last = ends_;
    update();
    const bool is_due = is_last || wall_ns() - whole_ns >= kWholeNs;
    if (options_.kind != LinkMeshKind::whole || !has_changed_ || !is_due) continue;
    give_whole();
    has_changed_ = false;
    whole_ns = wall_ns();
  }
}

/// False: nothing came.
bool LinkMesh::update() {
  std::vector<ToolInput> inputs;
  ToolInput input;
  while (inputs_.take(input)) inputs.push_back(input);
  if (inputs.empty()) return false;
  mesh_.update(inputs);
  ++updates_;
  if (mesh_.updates().empty()) return true;
  has_changed_ = true;
  if (options_.kind == LinkMeshKind::blocks) give_blocks(mesh_.updates());
  return true;
}

void LinkMesh::give_whole() { server_.give_surfaces({{options_.name, whole_surface(mesh_.surface())}}); }

void LinkMesh::give_blocks(std::span<const SurfaceUpdate> updates) {
  std::map<std::string, std::string> contents;
  for (const SurfaceUpdate& update : updates) {
    contents[block_name(options_.name, update.block)] = update.surface ? block_surface(*update.surface) : std::string();
  }
  server_.give_surfaces(contents);
}

}  // namespace spinaltap
