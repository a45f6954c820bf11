#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

#include "core/ct/ct_volume.h"
#include "core/ct/level.h"
#include "core/rbf/fit_surface.h"
#include "core/segment/warning_metadata.h"

namespace spinaltap {

/// The mask of a bone and how it was found, in words.
struct MaskStage {
  BoneMask mask;
  std::string method;
  Level level = Level::kNone;               ///< where it is known
  std::optional<LevelWarnings> warnings{};  ///< what speaks against the mask; nothing where nothing looked at it
  std::string level_source{};               ///< how the level is known, in words; empty: it is not, or was found
};

/// A folder of finished stages, so that a bake that was stopped goes on where it was, and one with other options for
/// its last stages does not begin anew. Files appear whole or not at all, under names that hold the stage's key: a hash
/// of everything that it depends on. A damaged file counts as none. Masks are label maps, fits are .rbf files; nothing
/// in them or in their names comes from a CT's header but its grid.
class BakeCache {
 public:
  /// An empty name: keeps and finds nothing. The folder is made when the first stage is kept.
  explicit BakeCache(std::filesystem::path folder) : folder_(std::move(folder)) {}

  std::optional<MaskStage> find_mask(const std::string& key, const GridGeometry& geometry) const;
  void keep_mask(const std::string& key, const MaskStage& stage) const;

  std::optional<SurfaceFit> find_fit(const std::string& key) const;
  void keep_fit(const std::string& key, const SurfaceFit& fit) const;

  /// Removes stages until no more than `max_bytes` are kept, and those that nobody has looked for in `max_days`: the
  /// least lately found first. Files that are not stages stay. For caches that many bakes share.
  void prune(std::uint64_t max_bytes, int max_days) const;

  /// Removes the files that were kept here, and the folder when nothing else is in it.
  void remove() const;

 private:
  std::filesystem::path file(const char* stage, const std::string& key, const char* ending) const;

  std::filesystem::path folder_;
};

}  // namespace spinaltap
