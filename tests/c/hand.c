/* hand BONE PLAN POSES RECORD: the C interface from C. Checks what it rejects, drills the poses into a record, and
 * prints the record's hash, counts of events and surface blocks. Ends with 1 where something is not as it should be. */
#include <spinaltap/spinaltap_c.h>
#include <stdlib.h>
#include <string.h>

#include "hand.h"

#define EXPECT(what)                                                      \
  do {                                                                    \
    if (!(what)) {                                                        \
      fprintf(stderr, "%s:%d: expected %s\n", __FILE__, __LINE__, #what); \
      return 1;                                                           \
    }                                                                     \
  } while (0)

static int check_rejections(const spinaltap_bone* bone) {
  spinaltap_error error = {.struct_bytes = sizeof error};
  spinaltap_bone* none = NULL;
  EXPECT(spinaltap_bone_load("no/such/bone.vdb", &none, &error) == SPINALTAP_FILE);
  EXPECT(error.code == SPINALTAP_FILE && strstr(error.text, "no such file") != NULL && none == NULL);
  EXPECT(spinaltap_bone_load(NULL, &none, &error) == SPINALTAP_INPUT);
  EXPECT(spinaltap_bone_load("no/such/bone.vdb", &none, NULL) == SPINALTAP_FILE);
  /* A caller with room for a short text only. */
  spinaltap_error small = {.struct_bytes = 16};
  memset(small.text, 'x', sizeof small.text);
  EXPECT(spinaltap_bone_load("no/such/bone.vdb", &none, &small) == SPINALTAP_FILE);
  EXPECT(strlen(small.text) == 7 && small.text[8] == 'x');

  spinaltap_session* session = NULL;
  EXPECT(spinaltap_session_new(NULL, 1, NULL, NULL, &session, &error) == SPINALTAP_INPUT && session == NULL);
  spinaltap_path beside = {.struct_bytes = sizeof beside, .entry_mm = {900, 0, 0}, .target_mm = {900, 0, 40}};
  beside.tool.struct_bytes = sizeof beside.tool;
  spinaltap_tool_default(&beside.tool);
  EXPECT(beside.tool.diameter_mm == 3.0);
  EXPECT(spinaltap_session_new(&bone, 1, &beside, NULL, &session, &error) == SPINALTAP_GEOMETRY);
  beside.tool.diameter_mm = -1.0;
  EXPECT(spinaltap_session_new(&bone, 1, &beside, NULL, &session, &error) == SPINALTAP_INPUT);
  spinaltap_input unsized = {0};
  EXPECT(spinaltap_session_step(NULL, &unsized, NULL) == SPINALTAP_INPUT);
  EXPECT(strcmp(spinaltap_event_name(0), "contact") == 0 && strcmp(spinaltap_event_name(99), "") == 0);
  spinaltap_bone_free(NULL);
  spinaltap_session_free(NULL);
  spinaltap_surface_free(NULL);
  return 0;
}

static int32_t cancel(void* user, const char* stage, double fraction) {
  *(int*)user += stage != NULL && fraction >= 0.0;
  return 1;
}

static int drill(spinaltap_session* session, FILE* poses, size_t count) {
  spinaltap_input input = {.struct_bytes = sizeof input};
  spinaltap_cycle cycle = {.struct_bytes = sizeof cycle};
  spinaltap_error error = {.struct_bytes = sizeof error};
  hand_pose pose;
  for (size_t n = 0; next_pose(poses, &pose); ++n) {
    if (n == count / 2) {
      spinaltap_tool burr = {.struct_bytes = sizeof burr};
      spinaltap_tool_default(&burr);
      burr.shape = SPINALTAP_ROUND_BURR;
      burr.diameter_mm = HAND_BURR_MM;
      burr.length_mm = HAND_BURR_LENGTH_MM;
      burr.tip_length_mm = HAND_BURR_MM / 2;
      EXPECT(spinaltap_session_set_tool(session, &burr, &error) == SPINALTAP_OK);
    }
    input.dt_s = pose.dt_s;
    input.spindle_on = pose.spindle_on;
    memcpy(input.tip_mm, pose.tip_mm, sizeof input.tip_mm);
    memcpy(input.axis, pose.axis, sizeof input.axis);
    EXPECT(spinaltap_session_step(session, &input, &cycle) == SPINALTAP_OK);
    EXPECT(cycle.index == n);
  }
  return 0;
}

int main(int count, char** arguments) {
  if (count != 5) return 2;
  spinaltap_error error = {.struct_bytes = sizeof error};
  EXPECT(spinaltap_c_version() == SPINALTAP_C_VERSION);
  spinaltap_bone* bone = NULL;
  EXPECT(spinaltap_bone_load(arguments[1], &bone, &error) == SPINALTAP_OK);
  if (check_rejections(bone) != 0) return 1;
  spinaltap_path path = {.struct_bytes = sizeof path};
  EXPECT(spinaltap_path_read(arguments[2], 0, &path, &error) == SPINALTAP_OK);
  EXPECT(spinaltap_path_read(arguments[2], 99, &path, &error) == SPINALTAP_INPUT);
  spinaltap_session_options options = {.struct_bytes = sizeof options};
  spinaltap_session_options_default(&options);
  EXPECT(options.rpm == 1250.0 && options.has_clearances == 1);
  spinaltap_session* session = NULL;
  int calls = 0;
  options.progress = cancel;
  options.user = &calls;
  const spinaltap_bone* bones[] = {bone};
  EXPECT(spinaltap_session_new(bones, 1, &path, &options, &session, &error) == SPINALTAP_CANCELLED && calls > 0);
  options.progress = NULL;
  options.has_clearances = 0;
  options.spacing_mm = HAND_SPACING_MM;
  EXPECT(spinaltap_session_new(bones, 1, NULL, &options, &session, &error) == SPINALTAP_OK);
  char chosen[80];
  EXPECT(spinaltap_session_chosen(session, chosen, sizeof chosen) == SPINALTAP_OK);
  EXPECT(strcmp(chosen, "voxels of 0.3 mm of the whole bone, for no path") == 0);
  spinaltap_bone_free(bone); /* the session keeps it */

  spinaltap_surface* surface = NULL;
  EXPECT(spinaltap_session_surface(session, 0, &surface, &error) == SPINALTAP_OK);
  const uint32_t all = spinaltap_surface_block_count(surface);
  EXPECT(all > 0);
  spinaltap_surface_free(surface);
  EXPECT(spinaltap_session_surface(session, 1, &surface, &error) == SPINALTAP_INPUT);

  FILE* poses = fopen(arguments[3], "r");
  EXPECT(poses != NULL);
  size_t lines = 0;
  hand_pose pose;
  while (next_pose(poses, &pose)) ++lines;
  rewind(poses);
  EXPECT(spinaltap_session_record(session, arguments[4], &error) == SPINALTAP_OK);
  if (drill(session, poses, lines) != 0) return 1;
  fclose(poses);
  EXPECT(spinaltap_session_end_record(session, &error) == SPINALTAP_OK);

  spinaltap_event events[64];
  events[0].struct_bytes = sizeof events[0];
  uint32_t found = 0;
  EXPECT(spinaltap_session_events(session, 0, events, 64, &found) == SPINALTAP_OK);
  EXPECT(found == spinaltap_session_event_count(session) && found >= 2);
  int changes = 0;
  for (uint32_t n = 0; n < found; ++n) changes += strcmp(spinaltap_event_name(events[n].kind), "tool change") == 0;
  EXPECT(changes == 1);

  EXPECT(spinaltap_session_surface(session, 0, &surface, &error) == SPINALTAP_OK);
  const uint32_t changed = spinaltap_surface_block_count(surface);
  EXPECT(changed > 0 && changed < all);
  size_t walls = 0;
  for (uint32_t n = 0; n < changed; ++n) {
    spinaltap_block block = {.struct_bytes = sizeof block};
    EXPECT(spinaltap_surface_block(surface, n, &block) == SPINALTAP_OK);
    float* vertices = malloc(3 * sizeof(float) * (block.vertex_count + 1));
    float* normals = malloc(3 * sizeof(float) * (block.vertex_count + 1));
    uint16_t* triangles = malloc(3 * sizeof(uint16_t) * (block.triangle_count + 1));
    EXPECT(spinaltap_surface_copy(surface, n, vertices, normals, triangles) == SPINALTAP_OK);
    for (uint32_t k = 0; k < 3 * block.triangle_count; ++k) EXPECT(triangles[k] < block.vertex_count);
    for (uint32_t k = 0; k < block.vertex_count; ++k) {
      const float* of = normals + 3 * k;
      const float square = of[0] * of[0] + of[1] * of[1] + of[2] * of[2];
      EXPECT(square > 0.99F && square < 1.01F);
    }
    walls += block.triangle_count - block.wall_begin;
    free(vertices);
    free(normals);
    free(triangles);
  }
  EXPECT(walls > 0);
  spinaltap_surface_free(surface);

  EXPECT(spinaltap_bone_load(arguments[1], &bone, &error) == SPINALTAP_OK);
  const spinaltap_bone* again[] = {bone};
  int32_t is_same = 0, was_undone = 0;
  EXPECT(spinaltap_record_replay(arguments[4], again, 1, &is_same, &error) == SPINALTAP_OK && is_same == 1);
  EXPECT(spinaltap_session_undo(session, &was_undone, &error) == SPINALTAP_OK && was_undone == 1);
  EXPECT(spinaltap_session_undo(session, &was_undone, &error) == SPINALTAP_OK && was_undone == 0);
  char hash[17];
  EXPECT(spinaltap_record_hash(arguments[4], hash, &error) == SPINALTAP_OK);
  printf("%s\n", hash);
  spinaltap_session_free(session);
  spinaltap_bone_free(bone);
  return 0;
}
