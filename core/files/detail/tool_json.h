#pragma once

#include "core/files/json_file.h"
#include "core/tool/drill_path.h"

namespace spinaltap {

/// A bit, a screw and a path as plan files hold them; docs/plan-file.md.
Json to_json(const DrillBit& bit);
Json to_json(const ScrewHead& head);
Json to_json(const ScrewThread& thread);
Json to_json(const PedicleScrew& screw);
Json to_json(const DrillPath& path);
/// {"ct": hash, "level": name}, without what is not known.
Json to_json(const BoneIdentity& bone);

/// Read what to_json() made. Throw Error that names the file and the key at fault; do not check the path.
DrillBit read_bit(const Json& json, const std::filesystem::path& file);
/// The profile of an outline's places, checked.
DrillBit read_outline(const Json& places, const std::filesystem::path& file);
ScrewHead read_screw_head(const Json& json, const std::filesystem::path& file);
ScrewThread read_screw_thread(const Json& json, const std::filesystem::path& file);
PedicleScrew read_screw(const Json& json, const std::filesystem::path& file);
DrillPath read_path(const Json& json, const std::filesystem::path& file);
BoneIdentity read_bone_identity(const Json& json, const std::filesystem::path& file);

}  // namespace spinaltap
