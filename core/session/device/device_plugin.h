/* A haptic device's plug-in: a shared library that exports spinaltap_device_plugin(), in C, so that any compiler's will
 * do. SpinalTap loads it at run time; no vendor's library is needed to build either. docs/simulators.md has a guide,
 * and apps/examples/device_plugin.c is a whole one.
 *
 * All functions are called from one thread at a time, and wait for nothing but open() and close(). Coordinates are the
 * device's own: right-handed; mm, N, N mm, s, kg, rad. */
#ifndef SPINALTAP_DEVICE_PLUGIN_H
#define SPINALTAP_DEVICE_PLUGIN_H

#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

#define SPINALTAP_DEVICE_ABI 1u
/* The name of the function that a plug-in exports. */
#define SPINALTAP_DEVICE_SYMBOL "spinaltap_device_plugin"

/* What a device says of itself, as DeviceLimits has it. */
typedef struct spinaltap_device_limits {
  double rate_hz; /* of poses and forces */
  double delay_s; /* from a pose to the force that answers it at the handle, beyond one period */
  double max_force_n;
  double max_stiffness_n_mm;
  double mass_kg;          /* that moves, at the handle */
  double damping_n_s_mm;   /* of its own, at the handle: above 0 */
  double friction_n;       /* dry */
  double position_step_mm; /* of its encoders; 0: finer than matters */
  int32_t senses_turn;     /* 0 or 1 */
  int32_t gives_torque;    /* 0 or 1; what follows counts with it only */
  double max_torque_n_mm;
  double max_stiffness_n_mm_rad;
  double inertia_kg_mm2;
  double damping_n_mm_s_rad;
  double angle_step_rad;
} spinaltap_device_limits;

/* Where the device is. */
typedef struct spinaltap_device_sample {
  double tip_mm[3];
  double axis[3];   /* unit, from the base to the tip */
  double side[3];   /* unit, across the axis; zeros: not said */
  uint32_t buttons; /* pressed: a bit each */
  double time_s;    /* by the device's clock: another for each new sample */
} spinaltap_device_sample;

typedef struct spinaltap_device_plugin_table {
  uint32_t abi;     /* SPINALTAP_DEVICE_ABI */
  const char* name; /* of the device, for people */
  /* Opens the device that `options` says (the plug-in's own words, may be empty). Returns 0 where that fails, and then
   * writes why, in words, into `why`, which holds `why_size` characters. Else a handle that the others get. */
  void* (*open)(const char* options, char* why, uint32_t why_size);
  void (*close)(void* device);
  void (*describe)(void* device, spinaltap_device_limits* limits);
  /* 1: a new sample; 0: none since the last; below 0: the device is gone. */
  int32_t (*read)(void* device, spinaltap_device_sample* sample);
  /* From now on, N and N mm about the tip of the last sample. 1: taken; 0 or below: not. */
  int32_t (*give)(void* device, const double force_n[3], const double torque_n_mm[3]);
} spinaltap_device_plugin_table;

/* What a plug-in exports. The table stays its own. */
typedef const spinaltap_device_plugin_table* (*spinaltap_device_plugin_function)(void);

#ifdef __cplusplus
}
#endif

#endif
