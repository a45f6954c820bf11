#pragma once

#include "core/files/json_file.h"
#include "mesh/mesh_quality.h"

namespace spinaltap {

/// Prints the figures of a mesh and gives them as JSON.
Json report_mesh(const MeshQuality& quality);

}  // namespace spinaltap
