#include "mesh/decimate.h"

#include <OpenMesh/Tools/Decimater/DecimaterT.hh>
#include <OpenMesh/Tools/Decimater/ModAspectRatioT.hh>
#include <OpenMesh/Tools/Decimater/ModHausdorffT.hh>
#include <OpenMesh/Tools/Decimater/ModNormalFlippingT.hh>
#include <OpenMesh/Tools/Decimater/ModQuadricT.hh>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "core/base/error.h"
#include "mesh/detail/half_edge_mesh.h"
#include "mesh/mesh_distance.h"
#include "mesh/mesh_quality.h"
#include "mesh/self_intersections.h"

namespace spinaltap {
namespace {

namespace decimater = OpenMesh::Decimater;
using detail::HalfEdgeMesh;

TriangleMesh from_half_edges(const HalfEdgeMesh& mesh) {
  TriangleMesh result;
  result.vertices_mm.reserve(mesh.n_vertices());
  for (const auto vertex : mesh.vertices()) {
    const auto& p = mesh.point(vertex);
    result.vertices_mm.emplace_back(p[0], p[1], p[2]);
  }
  result.triangles.reserve(mesh.n_faces());
  for (const auto face : mesh.faces()) {
    std::array<std::uint32_t, 3> corners{};
    std::size_t n = 0;
    for (const auto vertex : mesh.fv_range(face)) corners[n++] = static_cast<std::uint32_t>(vertex.idx());
    result.triangles.push_back(corners);
  }
  return result;
}

double distance_to_segment(const HalfEdgeMesh::Point& p, const HalfEdgeMesh::Point& a, const HalfEdgeMesh::Point& b) {
  const HalfEdgeMesh::Point along = b - a;
  const float length = along.sqrnorm();
  const float share = length > 0.0F ? std::clamp(((p - a) | along) / length, 0.0F, 1.0F) : 0.0F;
  return static_cast<double>((a + share * along - p).norm());
}

/// Lets a vertex on a crease go along it only, and one where creases meet or end not at all. What was on a crease stays
/// within a distance of it.
template <class Mesh>
class ModCrease : public decimater::ModBaseT<Mesh> {
 public:
  using Handle = decimater::ModHandleT<ModCrease>;
  using Base = decimater::ModBaseT<Mesh>;
  using CollapseInfo = typename Base::CollapseInfo;
  using Points = std::vector<typename Mesh::Point>;

  explicit ModCrease(Mesh& mesh) : Base(mesh, true) {
    mesh.add_property(is_on_crease_);
    mesh.add_property(passed_);
  }
  ~ModCrease() override {
    Base::mesh().remove_property(is_on_crease_);
    Base::mesh().remove_property(passed_);
  }
  ModCrease(const ModCrease&) = delete;
  ModCrease& operator=(const ModCrease&) = delete;

  void set_tolerance(double mm) { tolerance_mm_ = mm; }
  const std::string& name() const override {
    static const std::string kName = "Crease";
    return kName;
  }

  void initialize() override {
    for (std::size_t n = 0; n < Base::mesh().n_vertices(); ++n) {
      Base::mesh().property(is_on_crease_, OpenMesh::VertexHandle(static_cast<int>(n))) = false;
    }
    for (std::size_t n = 0; n < Base::mesh().n_edges(); ++n) {
      const OpenMesh::EdgeHandle edge(static_cast<int>(n));
      if (!is_crease(edge)) continue;
      for (const unsigned side : {0U, 1U}) {
        const OpenMesh::HalfedgeHandle half = Base::mesh().halfedge_handle(edge, side);
        Base::mesh().property(is_on_crease_, Base::mesh().to_vertex_handle(half)) = true;
      }
    }
  }

  float collapse_priority(const CollapseInfo& collapse) override {
    if (!Base::mesh().property(is_on_crease_, collapse.v0)) return Base::LEGAL_COLLAPSE;
    if (!find_crease(collapse)) return Base::ILLEGAL_COLLAPSE;
    const auto& begin = Base::mesh().point(before_);
    for (const auto& p : moved_) {
      if (distance_to_segment(p, begin, collapse.p1) > tolerance_mm_) return Base::ILLEGAL_COLLAPSE;
    }
    return Base::LEGAL_COLLAPSE;
  }

  void preprocess_collapse(const CollapseInfo& collapse) override {
    moved_.clear();
    if (Base::mesh().property(is_on_crease_, collapse.v0)) find_crease(collapse);
  }

  void postprocess_collapse(const CollapseInfo& collapse) override {
    if (moved_.empty()) return;
    const OpenMesh::HalfedgeHandle joined(Base::mesh().find_halfedge(before_, collapse.v1).idx());
    if (joined.is_valid()) Base::mesh().property(passed_, Base::mesh().edge_handle(joined)) = moved_;
  }

 private:
  bool is_crease(OpenMesh::EdgeHandle edge) {
    constexpr double kSmallestTurn = 0.5;  // rad
    return std::abs(static_cast<double>(Base::mesh().calc_dihedral_angle(edge))) > kSmallestTurn;
  }

  /// Where the crease that the collapse goes along comes from, and the places that its two edges, which become one,
  /// stand for; false where it does not go along a crease.
  bool find_crease(const CollapseInfo& collapse) {
    moved_.clear();
    const OpenMesh::EdgeHandle along = Base::mesh().edge_handle(collapse.v0v1);
    if (!is_crease(along)) return false;
    OpenMesh::EdgeHandle other;
    int creases = 0;
    for (const auto& each : Base::mesh().voh_range(collapse.v0)) {
      const OpenMesh::HalfedgeHandle out(each.idx());
      const OpenMesh::EdgeHandle edge = Base::mesh().edge_handle(out);
      if (!is_crease(edge)) continue;
      ++creases;
      if (edge == along) continue;
      other = edge;
      before_ = Base::mesh().to_vertex_handle(out);
    }
    if (creases != 2) return false;
    for (const auto edge : {along, other}) {
      const Points& passed = Base::mesh().property(passed_, edge);
      moved_.insert(moved_.end(), passed.begin(), passed.end());
    }
    moved_.push_back(collapse.p0);
    return true;
  }

  double tolerance_mm_ = 0.0;
  OpenMesh::VPropHandleT<bool> is_on_crease_;
  OpenMesh::EPropHandleT<Points> passed_;  ///< places on the crease that an edge stands for
  OpenMesh::VertexHandle before_;
  Points moved_;
};

/// Collapses all it may.
TriangleMesh collapsed(HalfEdgeMesh mesh, double tolerance_mm) {
  constexpr float kLargestTurnDeg = 45.0F;  // of a triangle's normal by one collapse
  decimater::DecimaterT<HalfEdgeMesh> collapser(mesh);
  decimater::ModQuadricT<HalfEdgeMesh>::Handle quadric;
  decimater::ModHausdorffT<HalfEdgeMesh>::Handle distance;
  decimater::ModNormalFlippingT<HalfEdgeMesh>::Handle turn;
  ModCrease<HalfEdgeMesh>::Handle crease;
  collapser.add(quadric);
  collapser.add(crease);
  collapser.add(distance);
  collapser.add(turn);
  collapser.module(quadric).unset_max_err();  // it only says which collapse comes first
  collapser.module(crease).set_tolerance(tolerance_mm);
  collapser.module(distance).set_tolerance(static_cast<float>(tolerance_mm));
  collapser.module(turn).set_max_normal_deviation(kLargestTurnDeg);
  decimater::ModAspectRatioT<HalfEdgeMesh>::Handle shape;
  collapser.add(shape);
  collapser.module(shape).set_aspect_ratio(15.0F);
  collapser.initialize();
  collapser.decimate();
  mesh.garbage_collection();
  return from_half_edges(mesh);
}

std::vector<Vec3> vertices_of(const TriangleMesh& mesh) {
  std::vector<Vec3> points_mm;
  points_mm.reserve(mesh.vertices_mm.size());
  for (const Eigen::Vector3f& p : mesh.vertices_mm) points_mm.push_back(p.cast<double>());
  return points_mm;
}

}  // namespace

TriangleMesh decimate(const TriangleMesh& mesh, double max_error_mm, RemeshReport* report, const Progress& progress) {
  constexpr std::size_t kMaxRounds = 5;
  constexpr double kFirst = 0.8;  // between vertices the mesh lies further off
  constexpr double kSmaller = 0.7;
  if (!(max_error_mm > 0.0)) fail("decimating: expected an error above 0 mm, found ", max_error_mm);
  const detail::SilencedOutput silenced;
  detail::HalfEdgeResult edges = detail::to_half_edges(mesh);
  const MeshQuality quality = measure_mesh(mesh);
  if (mesh.triangles.empty() || !quality.closed() || edges.rejected_faces != 0) {
    fail("decimating: expected a mesh that is closed and manifold");
  }
  edges.mesh.request_vertex_status();
  edges.mesh.request_edge_status();
  edges.mesh.request_halfedge_status();
  edges.mesh.request_face_status();
  edges.mesh.request_face_normals();
  edges.mesh.update_face_normals();
  const std::vector<Vec3> surface_mm = vertices_of(mesh);
  TriangleMesh result;
  RemeshReport found;
  double tolerance_mm = kFirst * max_error_mm;
  for (found.rounds = 1; found.rounds <= kMaxRounds; ++found.rounds, tolerance_mm *= kSmaller) {
    progress.report("decimating", static_cast<double>(found.rounds - 1) / static_cast<double>(kMaxRounds));
    result = collapsed(edges.mesh, tolerance_mm);
    found.to_surface = surface_to_mesh(detail::places_of_triangles_mm(result), mesh);
    found.from_surface = surface_to_mesh(surface_mm, result);
    found.reached = found.to_surface.max_mm <= max_error_mm && found.from_surface.max_mm <= max_error_mm;
    if (found.reached || found.rounds == kMaxRounds) break;
  }
  progress.report("decimating", 1.0);
  found.smallest_angle_deg = measure_mesh(result).smallest_angle_deg;
  found.self_intersections = self_intersections(result).size();
  if (report != nullptr) *report = found;
  return result;
}

}  // namespace spinaltap
