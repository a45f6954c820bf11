#include "vdb/sim/spinaltap_c.h"

#include <algorithm>
#include <cstddef>
#include <cstring>
#include <new>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/base/error.h"
#include "core/files/data_files.h"
#include "core/files/plan_file.h"
#include "core/session/record/session_record.h"
#include "vdb/sim/phantom_output.h"
#include "vdb/sim/replay.h"
#include "vdb/sim/session.h"

struct spinaltap_bone {
  spinaltap::Bone bone;
};
struct spinaltap_session {
  spinaltap::Session session;
};
struct spinaltap_surface {
  std::vector<spinaltap::SurfaceUpdate> blocks;
};

namespace spinaltap::c_interface {
namespace {

static_assert(static_cast<int>(ErrorKind::input) == SPINALTAP_INPUT &&
              static_cast<int>(ErrorKind::internal) == SPINALTAP_INTERNAL);
static_assert(static_cast<int>(BitShape::round_burr) == SPINALTAP_ROUND_BURR &&
              static_cast<int>(BitShape::tapered_screw) == SPINALTAP_TAPERED_SCREW &&
              static_cast<int>(BitShape::plate) == SPINALTAP_PLATE);

/// Of structs that stand in arrays, and of all that hot calls give: no larger than this header's.
template <class Struct>
std::size_t bytes_of(const Struct* from) {
  return std::min<std::size_t>(from->struct_bytes, sizeof(Struct));
}

/// What a caller's struct has, and for what it does not know of, `defaults`.
template <class Struct>
Struct taken(const Struct* from, Struct defaults) {
  if (from == nullptr) return defaults;
  if (from->struct_bytes < 8) fail("expected a struct with its size first, found one of ", from->struct_bytes);
  const std::uint32_t bytes = defaults.struct_bytes;
  std::memcpy(&defaults, from, bytes_of(from));
  defaults.struct_bytes = bytes;
  return defaults;
}

/// As much of it as the caller's struct takes.
template <class Struct>
void give(const Struct& from, Struct* to) noexcept {
  const std::uint32_t bytes = to->struct_bytes;
  std::memcpy(to, &from, bytes_of(to));
  to->struct_bytes = bytes;
}

/// As much of a text as there is room for, with a 0 at its end.
void put_text(const char* text, char* to, std::size_t room) noexcept {
  std::strncpy(to, text, room - 1);
  to[room - 1] = '\0';
}

void tell(spinaltap_error* error, spinaltap_code code, const char* text) noexcept {
  if (error == nullptr) return;
  const std::size_t bytes = bytes_of(error);
  if (bytes >= offsetof(spinaltap_error, text)) error->code = code;
  if (bytes <= offsetof(spinaltap_error, text)) return;
  put_text(text, error->text, bytes - offsetof(spinaltap_error, text));
}

/// Runs what may throw.
template <class Work>
spinaltap_code guarded(spinaltap_error* error, const Work& work) noexcept {
  try {
    work();
    return SPINALTAP_OK;
  } catch (const Error& mistake) {
    const auto code = static_cast<spinaltap_code>(mistake.kind());
    tell(error, code, mistake.what());
    return code;
  } catch (const std::bad_alloc&) {
    tell(error, SPINALTAP_INTERNAL, "not enough memory");
  } catch (const std::exception& mistake) {
    tell(error, SPINALTAP_INTERNAL, mistake.what());
  } catch (...) {
    tell(error, SPINALTAP_INTERNAL, "something unknown was thrown");
  }
  return SPINALTAP_INTERNAL;
}

template <class Thing>
Thing& there(Thing* thing, const char* what) {
  if (thing == nullptr) fail("expected ", what, ", found null");
  return *thing;
}

const char* text_of(const char* text, const char* what) { return &there(text, what); }

Vec3 vec3_of(const double (&numbers)[3]) { return {numbers[0], numbers[1], numbers[2]}; }
void put(const Vec3& from, double (&to)[3]) { std::copy_n(from.data(), 3, to); }

spinaltap_tool tool_of(const DrillBit& bit) {
  return {sizeof(spinaltap_tool), static_cast<std::int32_t>(bit.shape),
          bit.diameter_mm,        bit.length_mm,
          bit.tip_length_mm,      bit.tip_diameter_mm,
          bit.shank_diameter_mm,  bit.thickness_mm,
          bit.stroke_mm};
}

DrillBit bit_of(const spinaltap_tool* given) {
  const spinaltap_tool tool = taken(given, tool_of(DrillBit()));
  if (tool.shape < SPINALTAP_DRILL || tool.shape > SPINALTAP_PLATE ||
      tool.shape == static_cast<int>(BitShape::profile)) {
    fail("expected the shape of a tool, found ", tool.shape);
  }
  DrillBit bit;
  bit.shape = static_cast<BitShape>(tool.shape);
  bit.diameter_mm = tool.diameter_mm;
  bit.length_mm = tool.length_mm;
  bit.tip_length_mm = tool.tip_length_mm;
  bit.tip_diameter_mm = tool.tip_diameter_mm;
  bit.shank_diameter_mm = tool.shank_diameter_mm;
  bit.thickness_mm = tool.thickness_mm;
  bit.stroke_mm = tool.stroke_mm;
  check_bit(bit);
  return bit;
}

spinaltap_path path_of(const DrillPath& path) {
  const bool has_outline = path.bit.shape == BitShape::profile;
  if (path.is_curved() || has_outline) {
    fail_as(ErrorKind::unsupported, "expected a straight path with a simple tool, found ",
            has_outline ? "a tool with an outline" : "a curved one");
  }
  spinaltap_path made{};
  made.struct_bytes = sizeof made;
  put(path.entry_mm, made.entry_mm);
  put(path.target_mm, made.target_mm);
  made.tool = tool_of(path.bit);
  return made;
}

void check_path_size(std::uint32_t bytes) {
  if (bytes < offsetof(spinaltap_path, tool) + sizeof(std::uint32_t)) {
    fail("expected a path's size first, found ", bytes);
  }
}

/// The tool within it has a size of its own, and is its last.
void give(const spinaltap_path& from, spinaltap_path* to) {
  const std::uint32_t bytes = to->struct_bytes;
  check_path_size(bytes);
  std::memcpy(to, &from, offsetof(spinaltap_path, tool));
  to->struct_bytes = bytes;
  if (to->tool.struct_bytes == 0)
    to->tool.struct_bytes = bytes - static_cast<std::uint32_t>(offsetof(spinaltap_path, tool));
  give(from.tool, &to->tool);
}

DrillPath path_of(const spinaltap_path& given) {
  check_path_size(given.struct_bytes);
  DrillPath path;
  path.entry_mm = vec3_of(given.entry_mm);
  path.target_mm = vec3_of(given.target_mm);
  path.bit = bit_of(&given.tool);
  return path;
}

spinaltap_session_options default_options() {
  const SessionSetup setup;
  spinaltap_session_options options{};
  options.struct_bytes = sizeof options;
  options.has_clearances = setup.has_clearances ? 1 : 0;
  options.follows_path = setup.options.follows_path ? 1 : 0;
  options.spacing_mm = setup.volume.spacing_mm;
  options.radius_mm = setup.volume.radius_mm;
  options.lead_in_mm = setup.volume.lead_in_mm;
  options.rpm = setup.options.spindle.rpm;
  options.stop_thrust_n = setup.options.stop.thrust_n;
  options.stop_clearance_mm = setup.options.stop.clearance_mm;
  return options;
}

SessionSetup setup_of(const spinaltap_session_options& options) {
  SessionSetup setup;
  setup.has_clearances = options.has_clearances != 0;
  setup.volume.spacing_mm = options.spacing_mm;
  setup.volume.radius_mm = options.radius_mm;
  setup.volume.lead_in_mm = options.lead_in_mm;
  if (options.uses_voxels != 0) setup.engine = EngineKind::voxel;
  setup.options.follows_path = options.follows_path != 0;
  setup.options.has_device = options.has_device != 0;
  setup.options.spindle.rpm = options.rpm;
  setup.options.stop = {options.stop_thrust_n, options.stop_clearance_mm, options.stop_on_breach != 0};
  return setup;
}

std::vector<Bone> bones_of(const spinaltap_bone* const* bones, std::uint32_t count) {
  there(bones, "bones");
  std::vector<Bone> all;
  for (std::uint32_t n = 0; n < count; ++n) all.push_back(there(bones[n], "a bone").bone);
  return all;
}

spinaltap_cycle cycle_of(const Cycle& from) noexcept {
  spinaltap_cycle cycle{};
  cycle.state = static_cast<std::int32_t>(from.state);
  cycle.index = from.index;
  cycle.time_s = from.time_s;
  cycle.depth_mm = from.depth_mm;
  put(from.force.force_n, cycle.force_n);
  cycle.thrust_n = from.force.thrust_n;
  cycle.torque_n_mm = from.force.torque_n_mm;
  cycle.feed_mm_per_turn = from.force.feed_mm_per_turn;
  cycle.tip_density_g_cm3 = from.force.tip_density_g_cm3;
  put(from.force.lateral_n, cycle.lateral_n);
  put(from.force.contact_n, cycle.contact_n);
  cycle.clearance_outer_mm = from.clearance.outer_mm;
  cycle.clearance_canal_mm = from.clearance.canal_mm;
  cycle.inside_mm = from.tip.inside_mm;
  cycle.ahead_mm = from.tip.ahead_mm;
  cycle.removed = from.step.removed;
  cycle.removed_mm3 = from.step.removed_mm3;
  put(from.pose.tip_mm, cycle.tip_mm);
  put(from.pose.axis, cycle.axis);
  return cycle;
}

}  // namespace
}  // namespace spinaltap::c_interface

// What follows is C's. NOLINTBEGIN(google-build-using-namespace)
using namespace spinaltap;
using namespace spinaltap::c_interface;
// NOLINTEND(google-build-using-namespace)

uint32_t spinaltap_c_version(void) { return SPINALTAP_C_VERSION; }

spinaltap_code spinaltap_bone_load(const char* file, spinaltap_bone** bone, spinaltap_error* error) {
  return guarded(error, [&] {
    spinaltap_bone*& to = there(bone, "where to put the bone");
    to = new spinaltap_bone{Bone::load(text_of(file, "a file"))};
  });
}

spinaltap_code spinaltap_bone_phantom(double voxel_mm, spinaltap_bone** bone, spinaltap_path* path,
                                      spinaltap_error* error) {
  return guarded(error, [&] {
    spinaltap_bone*& to = there(bone, "where to put the bone");
    const PhantomBone made = phantom_bone(voxel_mm);
    if (path != nullptr) give(path_of(made.paths.front()), path);
    to = new spinaltap_bone{made.bone};
  });
}

void spinaltap_bone_free(spinaltap_bone* bone) { delete bone; }

spinaltap_code spinaltap_bone_bounds(const spinaltap_bone* bone, double low_mm[3], double high_mm[3],
                                     spinaltap_error* error) {
  return guarded(error, [&] {
    const Box3 box_mm = there(bone, "a bone").bone.model().bounds_mm();
    std::copy_n(box_mm.min().data(), 3, &there(low_mm, "a corner"));
    std::copy_n(box_mm.max().data(), 3, &there(high_mm, "a corner"));
  });
}

spinaltap_code spinaltap_set_data_folder(const char* folder, spinaltap_error* error) {
  return guarded(error, [&] { set_data_folder(text_of(folder, "a folder")); });
}

void spinaltap_tool_default(spinaltap_tool* tool) {
  if (tool != nullptr) give(tool_of(DrillBit()), tool);
}

spinaltap_code spinaltap_path_read(const char* plan_file, uint32_t index, spinaltap_path* path,
                                   spinaltap_error* error) {
  return guarded(error, [&] {
    const std::vector<DrillPath> paths = read_plan(text_of(plan_file, "a plan"));
    if (index >= paths.size()) fail("expected a path below ", paths.size(), ", found ", index);
    give(path_of(paths[index]), &there(path, "where to put the path"));
  });
}

void spinaltap_session_options_default(spinaltap_session_options* options) {
  if (options != nullptr) give(default_options(), options);
}

spinaltap_code spinaltap_session_new(const spinaltap_bone* const* bones, uint32_t bone_count,
                                     const spinaltap_path* path, const spinaltap_session_options* given,
                                     spinaltap_session** session, spinaltap_error* error) {
  return guarded(error, [&] {
    spinaltap_session*& to = there(session, "where to put the session");
    const spinaltap_session_options options = taken(given, default_options());
    const SessionSetup setup = setup_of(options);
    Progress progress;
    if (options.progress != nullptr) {
      progress = Progress([&](std::string_view stage, double fraction) {
        if (options.progress(options.user, std::string(stage).c_str(), fraction) != 0) progress.cancel();
      });
    }
    std::vector<Bone> all = bones_of(bones, bone_count);
    to = path != nullptr ? new spinaltap_session{Session(std::move(all), path_of(*path), setup, progress)}
                         : new spinaltap_session{Session(std::move(all), setup, progress)};
  });
}

void spinaltap_session_free(spinaltap_session* session) { delete session; }

spinaltap_code spinaltap_session_chosen(const spinaltap_session* session, char* text, uint32_t bytes) {
  return guarded(nullptr, [&] {
    const std::string chosen = there(session, "a session").session.chosen();
    if (text == nullptr || bytes == 0) fail("expected room for a text, found none");
    put_text(chosen.c_str(), text, bytes);
  });
}

spinaltap_code spinaltap_session_step(spinaltap_session* session, const spinaltap_input* input,
                                      spinaltap_cycle* cycle) {
  if (session == nullptr || input == nullptr || input->struct_bytes < sizeof(spinaltap_input)) return SPINALTAP_INPUT;
  return guarded(nullptr, [&] {
    ToolInput tool;
    tool.pose = {vec3_of(input->tip_mm), vec3_of(input->axis), vec3_of(input->side)};
    tool.spindle_on = input->spindle_on != 0;
    tool.dt_s = input->dt_s;
    const Cycle& done = session->session.step_input(tool);
    if (cycle != nullptr) give(cycle_of(done), cycle);
  });
}

spinaltap_code spinaltap_session_last(const spinaltap_session* session, spinaltap_cycle* cycle) {
  if (session == nullptr || cycle == nullptr) return SPINALTAP_INPUT;
  give(cycle_of(session->session.last()), cycle);
  return SPINALTAP_OK;
}

int32_t spinaltap_session_is_stopped(const spinaltap_session* session) {
  return session != nullptr && session->session.is_stopped() ? 1 : 0;
}

spinaltap_code spinaltap_session_set_tool(spinaltap_session* session, const spinaltap_tool* tool,
                                          spinaltap_error* error) {
  return guarded(error, [&] { there(session, "a session").session.set_tool(bit_of(&there(tool, "a tool"))); });
}

spinaltap_code spinaltap_session_end_hole(spinaltap_session* session, spinaltap_error* error) {
  return guarded(error, [&] { there(session, "a session").session.end_hole(); });
}

spinaltap_code spinaltap_session_undo(spinaltap_session* session, int32_t* was_undone, spinaltap_error* error) {
  return guarded(error, [&] {
    const bool is_undone = there(session, "a session").session.undo();
    if (was_undone != nullptr) *was_undone = is_undone ? 1 : 0;
  });
}

spinaltap_code spinaltap_session_save_drilled(spinaltap_session* session, const char* file, spinaltap_error* error) {
  return guarded(error, [&] { there(session, "a session").session.drilled().save(text_of(file, "a file")); });
}

const char* spinaltap_event_name(int32_t kind) {
  return kind < 0 || kind > static_cast<std::int32_t>(EventKind::tool_change)
             ? ""
             : name_of(static_cast<EventKind>(kind)).data();  // of texts that end in 0
}

uint32_t spinaltap_session_event_count(const spinaltap_session* session) {
  return session == nullptr ? 0 : static_cast<std::uint32_t>(session->session.events().size());
}

spinaltap_code spinaltap_session_events(const spinaltap_session* session, uint32_t first, spinaltap_event* events,
                                        uint32_t capacity, uint32_t* count) {
  if (session == nullptr || count == nullptr || (events == nullptr && capacity > 0)) return SPINALTAP_INPUT;
  *count = 0;
  const std::uint32_t bytes = capacity > 0 ? events->struct_bytes : 0;
  if (capacity > 0 && bytes < sizeof(spinaltap_event)) return SPINALTAP_INPUT;
  const std::span<const SessionEvent> all = session->session.events();
  auto* to = reinterpret_cast<std::byte*>(events);
  for (std::size_t n = first; n < all.size() && *count < capacity; ++n, ++*count, to += bytes) {
    spinaltap_event event{};
    event.struct_bytes = bytes;
    event.kind = static_cast<std::int32_t>(all[n].kind);
    event.cycle = all[n].cycle;
    event.time_s = all[n].time_s;
    event.depth_mm = all[n].depth_mm;
    put(all[n].place_mm, event.place_mm);
    event.value = all[n].value;
    std::memcpy(to, &event, sizeof event);
  }
  return SPINALTAP_OK;
}

spinaltap_code spinaltap_session_surface(spinaltap_session* session, uint32_t bone, spinaltap_surface** changes,
                                         spinaltap_error* error) {
  return guarded(error, [&] {
    spinaltap_surface*& to = there(changes, "where to put the surface");
    to = new spinaltap_surface{there(session, "a session").session.surface_changes(bone)};
  });
}

uint32_t spinaltap_surface_block_count(const spinaltap_surface* surface) {
  return surface == nullptr ? 0 : static_cast<std::uint32_t>(surface->blocks.size());
}

spinaltap_code spinaltap_surface_block(const spinaltap_surface* surface, uint32_t number, spinaltap_block* block) {
  if (surface == nullptr || block == nullptr || number >= surface->blocks.size()) return SPINALTAP_INPUT;
  const SurfaceUpdate& update = surface->blocks[number];
  spinaltap_block of{};
  std::copy_n(update.block.begin(), 3, of.block);
  if (update.surface) {
    of.vertex_count = static_cast<std::uint32_t>(update.surface->vertices_mm.size());
    of.triangle_count = static_cast<std::uint32_t>(update.surface->triangles.size());
    of.wall_begin = static_cast<std::uint32_t>(update.surface->wall_begin);
  }
  give(of, block);
  return SPINALTAP_OK;
}

spinaltap_code spinaltap_surface_copy(const spinaltap_surface* surface, uint32_t number, float* vertices_mm,
                                      float* normals, uint16_t* triangles) {
  if (surface == nullptr || number >= surface->blocks.size()) return SPINALTAP_INPUT;
  const auto& block = surface->blocks[number].surface;
  if (!block) return SPINALTAP_OK;
  const auto copy = [](const auto& from, auto* to) {
    if (to == nullptr) return;
    for (const auto& one : from) to = std::copy_n(one.data(), 3, to);
  };
  copy(block->vertices_mm, vertices_mm);
  copy(block->normals, normals);
  copy(block->triangles, triangles);
  return SPINALTAP_OK;
}

void spinaltap_surface_free(spinaltap_surface* surface) { delete surface; }

spinaltap_code spinaltap_session_record(spinaltap_session* session, const char* file, spinaltap_error* error) {
  return guarded(error, [&] { there(session, "a session").session.record(text_of(file, "a file")); });
}

spinaltap_code spinaltap_session_end_record(spinaltap_session* session, spinaltap_error* error) {
  return guarded(error, [&] { there(session, "a session").session.end_record(); });
}

spinaltap_code spinaltap_record_hash(const char* file, char hash[17], spinaltap_error* error) {
  return guarded(error, [&] {
    const std::string text = hash_of(read_record(text_of(file, "a file")));
    std::memcpy(&there(hash, "room for a hash"), text.c_str(), text.size() + 1);
  });
}

spinaltap_code spinaltap_record_replay(const char* file, const spinaltap_bone* const* bones, uint32_t bone_count,
                                       int32_t* is_same, spinaltap_error* error) {
  return guarded(error, [&] {
    const char* const name = text_of(file, "a file");
    const std::vector<Bone> all = bones_of(bones, bone_count);
    const Replay again = replay(read_record(name), name, all);
    there(is_same, "where to put the answer") = again.is_same() ? 1 : 0;
    tell(error, SPINALTAP_OK, again.difference.empty() ? again.gap.c_str() : again.difference.c_str());
  });
}
