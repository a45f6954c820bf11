/* What both programs of this folder drill: a hand's poses out of a text file, with a change of tools half way. */
#ifndef SPINALTAP_TESTS_HAND_H
#define SPINALTAP_TESTS_HAND_H

#include <stdio.h>

#define HAND_SPACING_MM 0.3
#define HAND_BURR_MM 2.0
#define HAND_BURR_LENGTH_MM 40.0

typedef struct hand_pose {
  double dt_s, tip_mm[3], axis[3];
  int spindle_on;
} hand_pose;

/* 1: another pose, as a line of the file has it: dt_s, tip, axis, spindle. */
static int next_pose(FILE* file, hand_pose* pose) {
  return fscanf(file, "%lf %lf %lf %lf %lf %lf %lf %d", &pose->dt_s, &pose->tip_mm[0], &pose->tip_mm[1],
                &pose->tip_mm[2], &pose->axis[0], &pose->axis[1], &pose->axis[2], &pose->spindle_on) == 8;
}

#endif
