/* A haptic device's plug-in, whole: SpinalTap loads it at run time. The device here is a mass of 0.3 kg on a hand's
 * spring that is pushed forwards at 2 mm/s; yours would call its maker's library in these six functions.
 *
 *   cc -shared -fPIC -I PREFIX/include device_plugin.c -o device_plugin.so */
#include <spinaltap/core/session/device/device_plugin.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef struct pushed_mass {
  double at_mm[3], mm_s[3], force_n[3];
  double time_s;
} pushed_mass;

static const double kPeriodS = 0.001, kMass = 0.3e-3 /* N s2/mm */, kHandN_mm = 0.3, kHandNS_mm = 0.01;
static const double kOwnNS_mm = 0.002, kPushMmS = 2.0;

static void* open_device(const char* options, char* why, uint32_t why_size) {
  pushed_mass* device;
  if (options[0] != '\0' && strcmp(options, "push") != 0) {
    snprintf(why, why_size, "expected the option push or none, found %s", options);
    return NULL;
  }
  device = calloc(1, sizeof *device);
  if (device == NULL) snprintf(why, why_size, "no memory");
  return device;
}

static void close_device(void* device) { free(device); }

static void describe(void* device, spinaltap_device_limits* limits) {
  (void)device;
  limits->rate_hz = 1.0 / kPeriodS;
  limits->max_force_n = 10.0;
  limits->max_stiffness_n_mm = 2.0;
  limits->mass_kg = 0.3;
  limits->damping_n_s_mm = kOwnNS_mm;
  limits->position_step_mm = 0.01;
}

/* Called once a period: the mass moves on by one. A real device reads its encoders here. */
static int32_t read_device(void* of, spinaltap_device_sample* sample) {
  pushed_mass* device = of;
  int n;
  memset(sample, 0, sizeof *sample);
  device->time_s += kPeriodS;
  for (n = 0; n < 3; ++n) {
    const double wanted_mm = n == 2 ? kPushMmS * device->time_s : 0.0;
    const double push_n = kHandN_mm * (wanted_mm - device->at_mm[n]) + device->force_n[n];
    device->mm_s[n] = (kMass * device->mm_s[n] + kPeriodS * push_n) /
                      (kMass + kPeriodS * (kHandNS_mm + kOwnNS_mm) + kPeriodS * kPeriodS * kHandN_mm);
    device->at_mm[n] += kPeriodS * device->mm_s[n];
    sample->tip_mm[n] = device->at_mm[n];
  }
  sample->axis[2] = 1.0;
  sample->buttons = 1;
  sample->time_s = device->time_s;
  return 1;
}

static int32_t give(void* of, const double force_n[3], const double torque_n_mm[3]) {
  pushed_mass* device = of;
  (void)torque_n_mm;
  memcpy(device->force_n, force_n, sizeof device->force_n);
  return 1;
}

const spinaltap_device_plugin_table* spinaltap_device_plugin(void) {
  static const spinaltap_device_plugin_table table = {
      SPINALTAP_DEVICE_ABI, "pushed mass", open_device, close_device, describe, read_device, give};
  return &table;
}
