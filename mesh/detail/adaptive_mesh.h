#pragma once

#include <OpenMesh/Core/Mesh/TriMesh_ArrayKernelT.hh>

#include <cstddef>
#include <span>
#include <vector>

#include "core/base/triangle_mesh.h"
#include "mesh/detail/sizing_field.h"
#include "mesh/detail/zero_set.h"

namespace spinaltap::detail {

struct AdaptiveTraits : OpenMesh::DefaultTraits {
  using Point = OpenMesh::Vec3d;
  using Normal = OpenMesh::Vec3d;
  VertexAttributes(OpenMesh::Attributes::Status);
  HalfedgeAttributes(OpenMesh::Attributes::Status | OpenMesh::Attributes::PrevHalfedge);
  EdgeAttributes(OpenMesh::Attributes::Status);
  FaceAttributes(OpenMesh::Attributes::Status);
  VertexTraits {
    Vec3 surface_normal = Vec3::Zero();  ///< of the zero set, unit, outward
    double length_mm = 0.0;              ///< wanted length of edges here
  };
};

/// A closed triangle mesh on a zero set, and the steps that change it: Botsch & Kobbelt 2004 with the sizing of Dunyach
/// et al. 2013. Each step is rejected where it would change the topology or turn a triangle against its corners'
/// normals.
class AdaptiveMesh {
 public:
  using Mesh = OpenMesh::TriMesh_ArrayKernelT<AdaptiveTraits>;
  using Vertex = OpenMesh::VertexHandle;
  using Halfedge = OpenMesh::HalfedgeHandle;
  using Edge = OpenMesh::EdgeHandle;
  using Face = OpenMesh::FaceHandle;

  /// `start` must be closed and manifold, its vertices on the zero set, one for each point of `sizing`.
  /// Throws Error when it is not.
  AdaptiveMesh(const TriangleMesh& start, std::span<const ZeroSet::Place> places, const SizingField& sizing,
               const ZeroSet& zero_set);

  std::size_t split_long_edges();
  std::size_t collapse_short_edges();
  /// Turns edges where that brings valences nearer to six, or enlarges the smaller of two angles.
  std::size_t flip_edges();
  /// Moves vertices within the tangent plane towards the middle of their triangles, and onto the zero set again.
  void relax();
  /// Works on triangles with an angle below `wanted_rad` until there are none or nothing helps; returns how many stay.
  std::size_t improve_angles(double wanted_rad);
  /// Takes the wanted lengths from the sizing field again.
  void update_lengths();
  /// Frees the memory of what was removed.
  void compact() { mesh_.garbage_collection(); }

  const Mesh& mesh() const { return mesh_; }
  TriangleMesh triangles() const;

 private:
  Vec3 at(Vertex v) const { return Eigen::Map<const Vec3>(mesh_.point(v).data()); }
  void place(Vertex v, const Vec3& p_mm) { mesh_.set_point(v, {p_mm.x(), p_mm.y(), p_mm.z()}); }
  Vertex add_vertex(const Vec3& p_mm) { return Vertex(mesh_.add_vertex({p_mm.x(), p_mm.y(), p_mm.z()}).idx()); }
  const Vec3& normal(Vertex v) const { return mesh_.data(v).surface_normal; }
  double wanted_mm(Vertex a, Vertex b) const { return std::min(mesh_.data(a).length_mm, mesh_.data(b).length_mm); }
  double corner_agreement(Vertex a, Vertex b, Vertex c) const;
  double angle_cosine(Vertex a, Vertex b, Vertex c) const;
  double face_angle_cosine(Face f) const;
  double face_agreement(Face f) const;

  /// What the triangles around a vertex, or some of them, are like: the worst of each.
  struct Worst {
    double angle_cosine = 0.0;
    double agreement = 1.0;
  };
  Worst ring_worst(Vertex v) const;
  Worst ring_worst_if(Vertex v, const Vec3& moved_mm, const Vec3& new_normal) const;

  struct Collapse {
    bool allowed = false;
    Worst before;
    Worst after;
    double longest_share = 0.0;  ///< longest new edge over what is wanted there
  };
  Collapse look_at_collapse(Halfedge h) const;

  struct Flip {
    bool allowed = false;
    Worst before;
    Worst after;
    double new_length_share = 0.0;
  };
  Flip look_at_flip(Edge e) const;
  bool brings_valences_nearer_to_six(Edge e) const;

  bool improve_face(Face f);
  bool improve_by_flip(Face f);
  bool improve_by_collapse(Face f);
  bool improve_by_split(Face f);
  bool improve_by_move(Vertex v);
  void split_edge(Edge e);

  Mesh mesh_;
  const SizingField& sizing_;
  const ZeroSet& zero_set_;
};

}  // namespace spinaltap::detail
