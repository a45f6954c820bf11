"""tool_change BONE [LIBRARY]: tool_change.c through ctypes alone, as any language with a foreign-function interface does
it: a burr in a hand, a pedal, the surface for a renderer. LIBRARY: libspinaltap.so."""

import ctypes
import sys
from ctypes import byref, c_char, c_double, c_float, c_int32, c_uint16, c_uint32, c_uint64, c_void_p

Vec3 = c_double * 3


class Struct(ctypes.Structure):
    """With its size first."""

    def __init__(self, **values):
        super().__init__(struct_bytes=ctypes.sizeof(type(self)), **values)


def struct(name, *fields):
    return type(name, (Struct,), {"_fields_": [("struct_bytes", c_uint32), *fields]})


def doubles(*names):
    return [(name, c_double) for name in names]


Error = struct("Error", ("code", c_int32), ("text", c_char * 1024))
Tool = struct("Tool", ("shape", c_int32), *doubles("diameter_mm", "length_mm", "tip_length_mm", "tip_diameter_mm",
                                                   "shank_diameter_mm", "thickness_mm", "stroke_mm"))
Options = struct("Options", *((name, c_int32) for name in ("has_clearances", "follows_path", "has_device", "uses_voxels",
                                                           "stop_on_breach")),
                 *doubles("spacing_mm", "radius_mm", "lead_in_mm", "rpm", "stop_thrust_n", "stop_clearance_mm"),
                 ("progress", c_void_p), ("user", c_void_p))
Input = struct("Input", ("spindle_on", c_int32), ("dt_s", c_double), ("tip_mm", Vec3), ("axis", Vec3), ("side", Vec3))
Cycle = struct("Cycle", ("state", c_int32), ("index", c_uint64), *doubles("time_s", "depth_mm"), ("force_n", Vec3),
               *doubles("thrust_n", "torque_n_mm", "feed_mm_per_turn", "tip_density_g_cm3"), ("lateral_n", Vec3),
               ("contact_n", Vec3), *doubles("clearance_outer_mm", "clearance_canal_mm", "inside_mm", "ahead_mm"),
               ("removed", c_uint64), ("removed_mm3", c_double), ("tip_mm", Vec3), ("axis", Vec3))
Block = struct("Block", ("block", c_int32 * 3), ("vertex_count", c_uint32), ("triangle_count", c_uint32),
               ("wall_begin", c_uint32))

library = ctypes.CDLL(sys.argv[2] if len(sys.argv) > 2 else "libspinaltap.so")
error = Error()


def call(name, *arguments):
    """A call that may fail."""
    if getattr(library, "spinaltap_" + name)(*arguments, byref(error)) != 0:
        sys.exit(error.text.decode())


def draw(session):
    """Thirty times a second: what changed goes to the renderer, a mesh a block."""
    changes = c_void_p()
    call("session_surface", session, 0, byref(changes))
    count = library.spinaltap_surface_block_count(changes)
    for n in range(count):
        block = Block()
        library.spinaltap_surface_block(changes, n, byref(block))
        vertices_mm = (c_float * (3 * block.vertex_count))()
        triangles = (c_uint16 * (3 * block.triangle_count))()
        library.spinaltap_surface_copy(changes, n, vertices_mm, None, triangles)
    library.spinaltap_surface_free(changes)
    return count


bone, session, low, high = c_void_p(), c_void_p(), Vec3(), Vec3()
call("bone_load", sys.argv[1].encode(), byref(bone))
call("bone_bounds", bone, low, high)
options = Options()
library.spinaltap_session_options_default(byref(options))
options.spacing_mm, options.has_clearances = 0.2, 0
call("session_new", byref(bone), 1, None, byref(options), byref(session))
library.spinaltap_bone_free(bone)  # the session has what it needs
chosen = ctypes.create_string_buffer(120)
library.spinaltap_session_chosen(session, chosen, len(chosen))
print(chosen.value.decode())

burr = Tool()
library.spinaltap_tool_default(byref(burr))
burr.shape, burr.diameter_mm, burr.shank_diameter_mm = 1, 4.0, 2.5
call("session_set_tool", session, byref(burr))
blocks, max_n = draw(session), 0.0
one, cycle = Input(spindle_on=1, dt_s=0.001, axis=Vec3(0, 0, -1)), Cycle()
for n in range(5000):
    if n == 2500:  # the pedal
        burr.diameter_mm = 3.0
        call("session_set_tool", session, byref(burr))
    one.tip_mm = Vec3(0.5 * (low[0] + high[0]), 0.75 * low[1] + 0.25 * high[1], high[2] + 2.0 - 0.004 * n)
    if library.spinaltap_session_step(session, byref(one), byref(cycle)) != 0:
        sys.exit(1)
    max_n = max(max_n, cycle.thrust_n)  # cycle.force_n is what the device gives
    if n % 33 == 0:
        blocks += draw(session)
events = library.spinaltap_session_event_count(session)
print(f"{cycle.time_s:.1f} s, {max_n:.2f} N at most, {blocks} blocks of surface drawn, {events} events")
library.spinaltap_session_free(session)
