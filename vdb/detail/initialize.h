#pragma once

namespace spinaltap {

/// Registers OpenVDB's grid types. Every function of vdb/ that needs it calls it; more calls cost nothing.
void initialize_openvdb();

}  // namespace spinaltap
