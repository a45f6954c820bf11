#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/base/geometry.h"
#include "mesh/detail/collapsed_part.h"
#include "mesh/detail/triangle_fans.h"

namespace spinaltap::detail {

/// One part of a surface while its edges are collapsed and turned: what may be done, and doing it.
///
/// A vertex goes into a neighbour that stays where it is. Allowed is what keeps the surface manifold, turns no triangle
/// far, makes no thin triangle where there was none, leaves creases where they are, and keeps every vertex that went
/// within its tolerance of the triangles that take its place.
class EdgeCollapser {
 public:
  using Triangle = TriangleFans::Triangle;

  /// Vertices of the border stay, as do those that `is_kept`. All but `part` must outlive it.
  EdgeCollapser(const FineSurface& fine, PassedVertices& next, const CollapsedPart& part,
                const std::vector<std::uint8_t>& is_kept);

  std::size_t vertex_count() const { return at_mm_.size(); }
  std::size_t triangle_count() const { return triangles_.size(); }
  bool is_gone(std::uint32_t vertex) const { return fans_.of(vertex).empty(); }
  bool is_dead(std::uint32_t triangle) const { return triangles_[triangle][0] == kNoVertex; }
  bool stays(std::uint32_t vertex) const { return stays_[vertex] != 0; }
  const Triangle& corners(std::uint32_t triangle) const { return triangles_[triangle]; }
  const Vec3& at_mm(std::uint32_t vertex) const { return at_mm_[vertex]; }
  double tolerance_mm(std::uint32_t vertex) const {
    return static_cast<double>(fine_.tolerance_mm[originals_[vertex]]);
  }
  const TriangleFans& fans() const { return fans_; }
  /// The vertices that share an edge with one, in the order of its triangles.
  void find_ring(std::uint32_t vertex, std::vector<std::uint32_t>& ring);
  /// Cosine of a triangle's smallest angle.
  double angle_cosine(std::uint32_t triangle) const;

  /// Whether creases allow it; quick.
  bool follows_crease(std::uint32_t from, std::uint32_t to) const;

  struct Limits {
    /// Triangles may not come out with a smaller angle than one of this cosine...
    double angle_cosine = 1.0;
    /// ...but where the smallest around gets larger, by at least this.
    double gain = 0.0;
    bool keeps_creases = true;
  };
  /// Collapses if that is allowed. Vertices that it changed the triangles of are the ring of `to` then.
  bool collapse(std::uint32_t from, std::uint32_t to, const Limits& limits);
  /// Turns the edge between two triangles if that is allowed and makes the smallest angle of both larger.
  bool flip(std::uint32_t a, std::uint32_t b, const Limits& limits);

  /// Moves a vertex if that is allowed and makes the smallest angle around it larger. Where it came from counts as a
  /// vertex that went from then on.
  bool move(std::uint32_t vertex, const Vec3& to_mm, const Limits& limits);
  /// Mean length of the edges at a vertex.
  double mean_edge_mm(std::uint32_t vertex);

  /// What is left; vertices that moved are as they were in it...
  CollapsedPart part() const;
  /// ...and where they are now here: of each vertex of part().
  std::vector<Eigen::Vector3f> positions_mm() const;

 private:
  /// A triangle that takes the place of others, and what of the vertices that went it takes over.
  struct NewTriangle {
    std::uint32_t index = 0;
    Vec3 a, b, c;
    Vec3 normal;  ///< unit
  };
  struct Moved {
    std::uint32_t vertex;  ///< of the fine surface
    std::uint32_t new_triangle;
  };

  Vec3 fine_mm(std::uint32_t original) const { return fine_.mesh.vertices_mm[original].cast<double>() - origin_mm_; }
  std::uint32_t local(std::uint32_t original) const;
  bool keeps_manifold(std::uint32_t from, std::uint32_t to);
  bool keeps_shape(std::uint32_t from, std::uint32_t to, const Limits& limits);
  Vec3 area_normal(std::uint32_t triangle) const;
  Vec3 normals_of(std::span<const std::uint32_t> triangles, std::span<const std::uint32_t> others = {}) const;
  bool keeps_facing() const;
  bool keeps_turns(const Limits& limits, double before) const;
  bool keeps_crease(std::uint32_t from, std::uint32_t to);
  bool take_over(std::uint32_t vertex, std::size_t& hint);
  bool take_over_chains(std::span<const std::uint32_t> triangles, std::size_t& hint);
  void hand_over();
  void move_crease(std::uint32_t from, std::uint32_t to);
  void end_creases_at(std::uint32_t vertex);
  bool add_new(std::uint32_t index, const Vec3& a, const Vec3& b, const Vec3& c);

  const FineSurface& fine_;
  PassedVertices& next_;
  std::vector<std::uint32_t> originals_;
  std::vector<Triangle> triangles_;  ///< dead: corners kNoVertex
  std::vector<CreaseVertex> creases_;
  std::vector<std::uint32_t> passed_;
  Vec3 origin_mm_;  ///< near to all: places are seen from here
  std::vector<Vec3> at_mm_;
  TriangleFans fans_;
  std::vector<std::uint8_t> stays_, is_border_, has_moved_;

  // Of the step that is looked at.
  std::vector<std::uint32_t> mark_;
  std::uint32_t marks_ = 0;
  std::vector<std::uint32_t> ring_, other_ring_, old_, moving_, dying_;
  std::vector<NewTriangle> new_;
  std::vector<Moved> moved_;
};

}  // namespace spinaltap::detail
