/* A device's plug-in that is not what SpinalTap expects: of another version, without a function, or none at all. */
#include <spinaltap/core/session/device/device_plugin.h>

#ifdef OTHER_VERSION
static const spinaltap_device_plugin_table table = {SPINALTAP_DEVICE_ABI + 1u, "of another time", 0, 0, 0, 0, 0};
const spinaltap_device_plugin_table* spinaltap_device_plugin(void) { return &table; }
#elif defined(LACKS_FUNCTIONS)
static const spinaltap_device_plugin_table table = {SPINALTAP_DEVICE_ABI, "half done", 0, 0, 0, 0, 0};
const spinaltap_device_plugin_table* spinaltap_device_plugin(void) { return &table; }
#else
int something_else(void);
int something_else(void) { return 1; }
#endif
