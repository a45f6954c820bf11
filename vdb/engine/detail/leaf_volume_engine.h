#pragma once

#include <cstdint>
#include <vector>

#include "core/engine/volume_engine.h"
#include "vdb/engine/detail/move_certificates.h"
#include "vdb/engine/detail/point_leaves.h"
#include "vdb/engine/detail/tool_bounds.h"

namespace spinaltap::detail {

/// The leaf engine of one volume: see make_leaf_engine.
class LeafVolumeEngine final : public VolumeEngine {
 public:
  LeafVolumeEngine(PointVolume& volume, const DrillBit& bit, const Material& material);

  std::size_t memory_bytes() const override;
  const PointLeaves& leaves() const { return leaves_; }

 protected:
  void remove(const SweptBit& bit, Removal& removal) noexcept override;

 private:
  enum class Sharing { no, yes };

  /// Puts the cells of a leaf that must be looked at on the list; none where the whole leaf lies outside.
  void list_cells(std::size_t leaf, const SweptBounds& tool) noexcept;
  /// Removes what the bit reached of a cell, and certifies it anew.
  template <Sharing sharing>
  void look(std::size_t cell, const SweptBounds& tool, Removal& removal) noexcept;
  template <Sharing sharing>
  void kill_point(PointLeaves::Cell& cell, std::size_t place, Removal& removal) noexcept;
  /// Drops what is empty, and certifies the leaf anew.
  void finish_leaf(std::size_t leaf) noexcept;

  ToolBounds bounds_;
  PointLeaves leaves_;
  MoveCertificates cell_certificates_;
  MoveCertificates leaf_certificates_;
  std::vector<float> cell_left_mm_;  ///< of certificates, in this step
  std::vector<float> leaf_left_mm_;
  std::vector<std::uint8_t> are_cells_stale_;  ///< per leaf: it was passed over as a whole since they were checked
  std::vector<std::uint32_t> due_leaves_;
  std::vector<std::uint32_t> due_cells_;
  std::size_t due_leaf_count_ = 0;
  std::size_t due_cell_count_ = 0;
};

}  // namespace spinaltap::detail
