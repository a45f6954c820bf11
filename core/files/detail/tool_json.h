#pragma once

#include "core/files/json_file.h"
#include "core/drill/drill_path.h"

namespace spinaltap {

/// A bit and a screw as plan files hold them; docs/plan-file.md.
Json to_json(const DrillBit& bit);
Json to_json(const PedicleScrew& screw);

/// Read what to_json() made. Throw Error that names the file and the key at fault.
DrillBit read_bit(const Json& json, const std::filesystem::path& file);
PedicleScrew read_screw(const Json& json, const std::filesystem::path& file);

}  // namespace spinaltap
