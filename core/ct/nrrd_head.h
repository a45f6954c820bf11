#pragma once

#include <string>

#include "core/ct/grid_geometry.h"

namespace spinaltap {

/// The head of an NRRD volume of one number a voxel, little endian, patient LPS, mm
/// (teem.sourceforge.net/nrrd/format.html). `type` is a name of the format's, such as "float"; `encoding` raw or gzip.
/// Further lines may follow; an empty one ends it.
std::string nrrd_head(const GridGeometry& geometry, const std::string& type, const std::string& encoding);

}  // namespace spinaltap
