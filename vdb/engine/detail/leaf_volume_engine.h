#pragma once

#include <cstdint>
#include <vector>

#include "core/engine/volume_engine.h"
#include "vdb/engine/detail/certificate_tree.h"
#include "vdb/engine/detail/point_leaves.h"
#include "vdb/engine/detail/tool_bounds.h"

namespace spinaltap::detail {

/// The leaf engine of one volume: see make_leaf_engine.
class LeafVolumeEngine final : public VolumeEngine {
 public:
  LeafVolumeEngine(PointVolume& volume, const DrillBit& bit, const Material& material);

  std::size_t memory_bytes() const override;
  const PointLeaves& leaves() const { return leaves_; }
  /// Of the tree's nodes, those that have occupied points.
  std::size_t node_count() const { return tree_.top_count(); }

 protected:
  void remove(const SweptBit& bit, Removal& removal) noexcept override;

 private:
  enum class Sharing { no, yes };

  /// Removes what the bit reached of a cell, and certifies it anew.
  template <Sharing sharing>
  void look(std::size_t cell, const SweptBounds& tool, Removal& removal) noexcept;
  template <Sharing sharing>
  void kill_point(PointLeaves::Cell& cell, std::size_t place, Removal& removal) noexcept;

  ToolBounds bounds_;
  PointLeaves leaves_;
  CertificateTree tree_;  ///< of cells, leaves, nodes
};

}  // namespace spinaltap::detail
