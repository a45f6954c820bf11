/* tool_change BONE: a thousand cycles a second of a burr in a hand, without a planned path, through the C interface;
 * a pedal changes the burr, and a renderer takes the surface. The "hand" here goes straight down from above the bone.
 */
#include <spinaltap/spinaltap_c.h>
#include <stdio.h>
#include <stdlib.h>

static spinaltap_error error = {.struct_bytes = sizeof(spinaltap_error)};

/* A call that may fail. */
static void must(spinaltap_code code) {
  if (code == SPINALTAP_OK) return;
  fprintf(stderr, "%s\n", error.text);
  exit(2);
}

/* Thirty times a second: what changed goes to the renderer, a mesh a block. */
static uint32_t draw(spinaltap_session* session) {
  spinaltap_surface* changes = NULL;
  must(spinaltap_session_surface(session, 0, &changes, &error));
  const uint32_t count = spinaltap_surface_block_count(changes);
  for (uint32_t n = 0; n < count; ++n) {
    spinaltap_block block = {.struct_bytes = sizeof block};
    spinaltap_surface_block(changes, n, &block);
    float* vertices_mm = malloc(sizeof(float) * 3 * (block.vertex_count + 1));
    uint16_t* triangles = malloc(sizeof(uint16_t) * 3 * (block.triangle_count + 1));
    spinaltap_surface_copy(changes, n, vertices_mm, NULL, triangles);
    /* Hand them over, as block[0], block[1], block[2]; no vertices: take that mesh away. */
    free(vertices_mm);
    free(triangles);
  }
  spinaltap_surface_free(changes);
  return count;
}

int main(int count, char** arguments) {
  if (count != 2) return 2;
  spinaltap_bone* bone = NULL;
  must(spinaltap_bone_load(arguments[1], &bone, &error));
  double low_mm[3], high_mm[3];
  must(spinaltap_bone_bounds(bone, low_mm, high_mm, &error));
  spinaltap_session_options options = {.struct_bytes = sizeof options};
  spinaltap_session_options_default(&options);
  options.spacing_mm = 0.2;
  options.has_clearances = 0; /* with them: depths, and how near the canal is */
  spinaltap_session* session = NULL;
  must(spinaltap_session_new((const spinaltap_bone* const*)&bone, 1, NULL, &options, &session, &error));
  spinaltap_bone_free(bone); /* the session has what it needs */
  char chosen[120];
  spinaltap_session_chosen(session, chosen, sizeof chosen);
  printf("%s\n", chosen);

  spinaltap_tool burr = {.struct_bytes = sizeof burr};
  spinaltap_tool_default(&burr);
  burr.shape = SPINALTAP_ROUND_BURR;
  burr.diameter_mm = 4.0;
  burr.shank_diameter_mm = 2.5;
  must(spinaltap_session_set_tool(session, &burr, &error));
  uint32_t blocks = draw(session);
  spinaltap_input input = {.struct_bytes = sizeof input, .spindle_on = 1, .dt_s = 0.001, .axis = {0, 0, -1}};
  spinaltap_cycle cycle = {.struct_bytes = sizeof cycle};
  double most_n = 0.0;
  for (int n = 0; n < 5000; ++n) {
    if (n == 2500) { /* the pedal */
      burr.diameter_mm = 3.0;
      must(spinaltap_session_set_tool(session, &burr, &error));
    }
    input.tip_mm[0] = 0.5 * (low_mm[0] + high_mm[0]);
    input.tip_mm[1] = 0.75 * low_mm[1] + 0.25 * high_mm[1]; /* above the vertebra's body */
    input.tip_mm[2] = high_mm[2] + 2.0 - 0.004 * n;
    if (spinaltap_session_step(session, &input, &cycle) != SPINALTAP_OK) return 1;
    if (cycle.thrust_n > most_n) most_n = cycle.thrust_n; /* cycle.force_n is what the device gives */
    if (n % 33 == 0) blocks += draw(session);
  }
  printf("%.1f s, %.2f N at most, %u blocks of surface drawn, %u events\n", cycle.time_s, most_n, blocks,
         spinaltap_session_event_count(session));
  spinaltap_session_free(session);
  return 0;
}
