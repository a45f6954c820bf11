/* SpinalTap for C, and for what calls C: C#, Unity, Unreal, Python's ctypes, Rust, Julia. Link libspinaltap.so
 * (spinaltap::shared). docs/c-interface.md is the guide.
 *
 * Functions that may fail return a spinaltap_code; the words are in `error`, which may be null. No exception comes out
 * of any. Handles are opaque: what made one, its *_free() lets go of it; null is let go of without a word. A session
 * keeps the bones that it needs: free yours when you like. Any number of threads may use a bone at once; a session, and
 * a surface, one at a time.
 *
 * Each struct begins with its size in bytes: set it before a call, of an array in its first, so that a program that was
 * built against an older header goes on. What a struct has beyond that size is not touched.
 *
 * Positions and directions are patient LPS, right-handed: x to the patient's left, y to the back, z to the head. mm, s,
 * N, N mm. Texts are UTF-8 and end in 0. */
#ifndef SPINALTAP_C_H
#define SPINALTAP_C_H

#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

#define SPINALTAP_C_VERSION 1u
/* Of the library that is loaded: what is there in version 1 stays in all that follow. */
uint32_t spinaltap_c_version(void);

/* What came of a call: 0, or what the error is about (ErrorKind of core/base/error.h). */
typedef int32_t spinaltap_code;
enum {
  SPINALTAP_OK = 0,
  SPINALTAP_INPUT = 1,       /* a value, an option or a file's content is not as expected */
  SPINALTAP_GEOMETRY = 2,    /* a place, a path or a tool does not fit the bone */
  SPINALTAP_FILE = 3,        /* a file is missing, or cannot be opened */
  SPINALTAP_DISK = 4,        /* something cannot be written */
  SPINALTAP_UNSUPPORTED = 5, /* understood, but not handled */
  SPINALTAP_CANCELLED = 6,
  SPINALTAP_INTERNAL = 7 /* a mistake in this library, or no memory is left */
};

typedef struct spinaltap_error {
  uint32_t struct_bytes;
  spinaltap_code code;
  char text[1024]; /* one line: what was expected, what was found; cut short where it is longer */
} spinaltap_error;

/* ---- Bones ---- */
typedef struct spinaltap_bone spinaltap_bone;

/* A bone.vdb. */
spinaltap_code spinaltap_bone_load(const char* file, spinaltap_bone** bone, spinaltap_error* error);
/* A vertebra to try things on, with the data files of the library: spinaltap_set_data_folder(). Its left pedicle's path
 * in `path`, which may be null. */
struct spinaltap_path;
spinaltap_code spinaltap_bone_phantom(double voxel_mm, spinaltap_bone** bone, struct spinaltap_path* path,
                                      spinaltap_error* error);
void spinaltap_bone_free(spinaltap_bone* bone);
/* The box of its surface: its corners. */
spinaltap_code spinaltap_bone_bounds(const spinaltap_bone* bone, double low_mm[3], double high_mm[3],
                                     spinaltap_error* error);
/* Where the shipped files (materials, anatomy) are: share/spinaltap of an installed package. For all of the program. */
spinaltap_code spinaltap_set_data_folder(const char* folder, spinaltap_error* error);

/* ---- Tools and paths ---- */
enum {
  SPINALTAP_DRILL = 0, /* a cylinder with a conical tip */
  SPINALTAP_ROUND_BURR = 1,
  SPINALTAP_CONICAL_BURR = 2,
  SPINALTAP_TAPERED_SCREW = 3,
  SPINALTAP_PLATE = 5 /* a saw's blade, an osteotome */
};

typedef struct spinaltap_tool {
  uint32_t struct_bytes;
  int32_t shape;
  double diameter_mm; /* where it is widest; of a plate its width */
  double length_mm;   /* from the base to the tip, tip included */
  double tip_length_mm;
  double tip_diameter_mm;   /* of a drill its chisel edge */
  double shank_diameter_mm; /* of burrs, behind the head; 0: as wide as the head */
  double thickness_mm;      /* of a plate; 0 of others, as the next */
  double stroke_mm;
} spinaltap_tool;

/* The usual drill of 3 mm: set struct_bytes first. */
void spinaltap_tool_default(spinaltap_tool* tool);

typedef struct spinaltap_path {
  uint32_t struct_bytes;
  int32_t reserved;
  double entry_mm[3]; /* on the bone's surface */
  double target_mm[3];
  spinaltap_tool tool; /* its struct_bytes too */
} spinaltap_path;

/* Path `index`, from 0, of a plan.json; straight ones with a tool of a shape above, else SPINALTAP_UNSUPPORTED. */
spinaltap_code spinaltap_path_read(const char* plan_file, uint32_t index, spinaltap_path* path, spinaltap_error* error);

/* ---- Sessions ---- */
typedef struct spinaltap_session spinaltap_session;

/* Called now and then from the thread that waits or from others; another value than 0 cancels. `fraction`: 0 to 1. */
typedef int32_t (*spinaltap_progress)(void* user, const char* stage, double fraction);

typedef struct spinaltap_session_options {
  uint32_t struct_bytes;
  int32_t has_clearances; /* look for the walls, which takes seconds: 1 */
  int32_t follows_path;   /* 0 of a milling: no states, breakthroughs or plunges; 1 */
  int32_t has_device;     /* a hand at a haptic device moves the tool: 0 */
  int32_t uses_voxels;    /* where points along the path would do: 0 */
  int32_t stop_on_breach; /* 0 */
  double spacing_mm;      /* of voxels or points: 0.1 */
  double radius_mm;       /* of the cylinder of points: 3 */
  double lead_in_mm;      /* of it, before the entry: 3 */
  double rpm;             /* of the spindle: 1250 */
  double stop_thrust_n;   /* infinite: never */
  double stop_clearance_mm;
  spinaltap_progress progress; /* null */
  void* user;                  /* handed to it */
} spinaltap_session_options;

/* The values above: set struct_bytes first. */
void spinaltap_session_options_default(spinaltap_session_options* options);

/* `path` null: any tool anywhere, in voxels; the tool is that of spinaltap_tool_default() until set_tool(). Depths are
 * then those of the tip below the bone's surface, and clearances the canal's alone. `options` null: the defaults. */
spinaltap_code spinaltap_session_new(const spinaltap_bone* const* bones, uint32_t bone_count,
                                     const spinaltap_path* path, const spinaltap_session_options* options,
                                     spinaltap_session** session, spinaltap_error* error);
void spinaltap_session_free(spinaltap_session* session);
/* What it drills, and why, cut short where `bytes` are too few. */
spinaltap_code spinaltap_session_chosen(const spinaltap_session* session, char* text, uint32_t bytes);

typedef struct spinaltap_input {
  uint32_t struct_bytes;
  int32_t spindle_on;
  double dt_s;      /* since the last input */
  double tip_mm[3]; /* where the tool has come to, straight from where it was */
  double axis[3];   /* unit, from the base to the tip */
  double side[3];   /* of a plate: unit, across the axis, along its width; zeros: not said */
} spinaltap_input;

typedef struct spinaltap_cycle {
  uint32_t struct_bytes;
  int32_t state; /* 0 initial, 1 outer cortical, 2 cancellous, 3 transitional, 4 inner cortical */
  uint64_t index;
  double time_s;
  double depth_mm;   /* of the tip along the path, 0 at the entry; without one below the bone's surface */
  double force_n[3]; /* all that the operator feels: give this to a device */
  double thrust_n, torque_n_mm, feed_mm_per_turn, tip_density_g_cm3;
  double lateral_n[3], contact_n[3];
  double clearance_outer_mm, clearance_canal_mm; /* negative: a breach; infinite: no such wall near */
  double inside_mm, ahead_mm;                    /* of the tip: to the bone's surface, and along the axis out of it */
  uint64_t removed;                              /* points or voxels */
  double removed_mm3;
  double tip_mm[3], axis[3]; /* where the tool is */
} spinaltap_cycle;

/* One cycle. `cycle` may be null. Poses that make no sense do nothing but leave an event, and are no errors. Without a
 * record it allocates and locks nothing. */
spinaltap_code spinaltap_session_step(spinaltap_session* session, const spinaltap_input* input, spinaltap_cycle* cycle);
/* The last one; before the first, zeros. */
spinaltap_code spinaltap_session_last(const spinaltap_session* session, spinaltap_cycle* cycle);
/* The stop rules ask to stop: 1. */
int32_t spinaltap_session_is_stopped(const spinaltap_session* session);

/* Another tool from the next cycle on, which has come from nowhere. Not in the haptic thread: it allocates. */
spinaltap_code spinaltap_session_set_tool(spinaltap_session* session, const spinaltap_tool* tool,
                                          spinaltap_error* error);
/* What is drilled from here on is another hole. Ends a record. */
spinaltap_code spinaltap_session_end_hole(spinaltap_session* session, spinaltap_error* error);
/* Puts the bone back to before this hole, or the last one. `was_undone`, which may be null: 0 where nothing was
 * drilled.
 */
spinaltap_code spinaltap_session_undo(spinaltap_session* session, int32_t* was_undone, spinaltap_error* error);
/* Writes the first bone without all holes: a bone.vdb. */
spinaltap_code spinaltap_session_save_drilled(spinaltap_session* session, const char* file, spinaltap_error* error);

/* ---- Events ---- */
typedef struct spinaltap_event {
  uint32_t struct_bytes;
  int32_t kind; /* core/session/session_event.h; spinaltap_event_name() */
  uint64_t cycle;
  double time_s, depth_mm, place_mm[3];
  double value; /* of events that go on it may still grow */
} spinaltap_event;

/* "contact", "canal breach", ...; empty where there is none of that number. */
const char* spinaltap_event_name(int32_t kind);
/* How many there are, in the order in which they began: up to 4,096. */
uint32_t spinaltap_session_event_count(const spinaltap_session* session);
/* From number `first` on into `events`, at most `capacity`; how many in `count`. */
spinaltap_code spinaltap_session_events(const spinaltap_session* session, uint32_t first, spinaltap_event* events,
                                        uint32_t capacity, uint32_t* count);

/* ---- The remaining bone's surface ---- */
/* Blocks that changed since the last call, the first time all: keep a mesh for each, by its three numbers. Any thread
 * may read it while the session goes on. */
typedef struct spinaltap_surface spinaltap_surface;

typedef struct spinaltap_block {
  uint32_t struct_bytes;
  int32_t block[3];
  uint32_t vertex_count;   /* 0: no surface is left: take the block's mesh away */
  uint32_t triangle_count; /* outward: counter-clockwise as seen from outside */
  uint32_t wall_begin;     /* triangles from here on are drilled walls */
} spinaltap_block;

spinaltap_code spinaltap_session_surface(spinaltap_session* session, uint32_t bone, spinaltap_surface** changes,
                                         spinaltap_error* error);
uint32_t spinaltap_surface_block_count(const spinaltap_surface* surface);
spinaltap_code spinaltap_surface_block(const spinaltap_surface* surface, uint32_t number, spinaltap_block* block);
/* Into buffers of yours: 3 numbers a vertex, a normal, a triangle. Any of them may be null. */
spinaltap_code spinaltap_surface_copy(const spinaltap_surface* surface, uint32_t number, float* vertices_mm,
                                      float* normals, uint16_t* triangles);
void spinaltap_surface_free(spinaltap_surface* surface);

/* ---- Records ---- */
/* From here on each cycle goes to an HDF5 file, which must not be there. Before the first cycle. */
spinaltap_code spinaltap_session_record(spinaltap_session* session, const char* file, spinaltap_error* error);
/* Writes what is left, and marks the record as whole. */
spinaltap_code spinaltap_session_end_record(spinaltap_session* session, spinaltap_error* error);
/* A fingerprint of a record's cycles, events and tools: of the same drilling the same, whatever recorded it. */
spinaltap_code spinaltap_record_hash(const char* file, char hash[17], spinaltap_error* error);
/* Runs a record again; 1 in `is_same` where every bit is, else 0, and in `error` the first difference with the code
 * SPINALTAP_OK. */
spinaltap_code spinaltap_record_replay(const char* file, const spinaltap_bone* const* bones, uint32_t bone_count,
                                       int32_t* is_same, spinaltap_error* error);

#ifdef __cplusplus
}
#endif

#endif
