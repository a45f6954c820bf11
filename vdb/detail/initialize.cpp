#include "vdb/detail/initialize.h"

#include <openvdb/openvdb.h>

namespace spinaltap {

void initialize_openvdb() { openvdb::initialize(); }

}  // namespace spinaltap
