// Garland & Heckbert 1997, "Surface simplification using quadric error metrics", as OpenMesh has it; Klein, Liebich &
// Strasser 1996, "Mesh reduction with error control": of every vertex that went the nearest triangle is known.

#include "mesh/detail/collapse_edges.h"

#include <OpenMesh/Tools/Decimater/DecimaterT.hh>
#include <OpenMesh/Tools/Decimater/ModAspectRatioT.hh>
#include <OpenMesh/Tools/Decimater/ModNormalFlippingT.hh>
#include <OpenMesh/Tools/Decimater/ModQuadricT.hh>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "core/base/geometry.h"
#include "mesh/detail/half_edge_mesh.h"
#include "mesh/detail/triangle_shape.h"

namespace spinaltap::detail {
namespace {

namespace decimater = OpenMesh::Decimater;

Vec3 vec(const HalfEdgeMesh::Point& p) {
  return {static_cast<double>(p[0]), static_cast<double>(p[1]), static_cast<double>(p[2])};
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
    if (joins_borders(collapse)) return Base::ILLEGAL_COLLAPSE;
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
  /// Whether there would be a new edge from border to border, which another part of the mesh may have, too.
  bool joins_borders(const CollapseInfo& collapse) {
    Mesh& mesh = Base::mesh();
    if (!mesh.is_boundary(collapse.v1)) return false;
    for (const auto& neighbour : mesh.vv_range(collapse.v0)) {
      const OpenMesh::VertexHandle other(neighbour.idx());
      if (other != collapse.v1 && mesh.is_boundary(other) && !mesh.find_halfedge(collapse.v1, other).is_valid()) {
        return true;
      }
    }
    return false;
  }

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

/// Keeps every vertex that went within a distance of a triangle near it.
template <class Mesh>
class ModWithin : public decimater::ModBaseT<Mesh> {
 public:
  using Handle = decimater::ModHandleT<ModWithin>;
  using Base = decimater::ModBaseT<Mesh>;
  using CollapseInfo = typename Base::CollapseInfo;
  using Places = std::vector<Eigen::Vector3f>;

  explicit ModWithin(Mesh& mesh) : Base(mesh, true) { mesh.add_property(passed_); }
  ~ModWithin() override { Base::mesh().remove_property(passed_); }
  ModWithin(const ModWithin&) = delete;
  ModWithin& operator=(const ModWithin&) = delete;

  void set_tolerance(double mm) { squared_mm2_ = mm * mm; }
  Places& passed(OpenMesh::FaceHandle face) { return Base::mesh().property(passed_, face); }
  const std::string& name() const override {
    static const std::string kName = "Within";
    return kName;
  }

  float collapse_priority(const CollapseInfo& collapse) override {
    Mesh& mesh = Base::mesh();
    fan_.clear();
    for (const auto& face : mesh.vf_range(collapse.v0)) {
      if (face != collapse.fl && face != collapse.fr) fan_.push_back(corners(face, collapse.v0, collapse.p1));
    }
    std::size_t nearest = 0;
    const auto is_within = [&](const Vec3& p_mm) {
      for (std::size_t n = 0; n < fan_.size(); ++n) {
        const std::size_t tried = (nearest + n) % fan_.size();  // neighbours lie near the same triangle
        const auto& [a, b, c] = fan_[tried];
        if (squared_distance(p_mm, a, b, c) <= squared_mm2_) {
          nearest = tried;
          return true;
        }
      }
      return false;
    };
    if (!is_within(vec(collapse.p0))) return Base::ILLEGAL_COLLAPSE;
    for (const auto& face : mesh.vf_range(collapse.v0)) {
      for (const Eigen::Vector3f& p : passed(OpenMesh::FaceHandle(face.idx()))) {
        if (!is_within(p.cast<double>())) return Base::ILLEGAL_COLLAPSE;
      }
    }
    return Base::LEGAL_COLLAPSE;
  }

  void preprocess_collapse(const CollapseInfo& collapse) override {
    moved_.assign(1, Eigen::Vector3f(collapse.p0[0], collapse.p0[1], collapse.p0[2]));
    for (const auto& face : Base::mesh().vf_range(collapse.v0)) {
      Places& places = passed(OpenMesh::FaceHandle(face.idx()));
      moved_.insert(moved_.end(), places.begin(), places.end());
      places.clear();
    }
  }

  void postprocess_collapse(const CollapseInfo& collapse) override {
    for (const Eigen::Vector3f& p : moved_) {
      OpenMesh::FaceHandle nearest;
      double nearest_mm2 = std::numeric_limits<double>::infinity();
      for (const auto& each : Base::mesh().vf_range(collapse.v1)) {
        const OpenMesh::FaceHandle face(each.idx());
        const auto [a, b, c] = corners(face, OpenMesh::VertexHandle(), {});
        const double distance_mm2 = squared_distance(p.cast<double>(), a, b, c);
        if (distance_mm2 < nearest_mm2) {
          nearest_mm2 = distance_mm2;
          nearest = face;
        }
      }
      if (nearest.is_valid()) passed(nearest).push_back(p);
    }
  }

 private:
  std::array<Vec3, 3> corners(OpenMesh::FaceHandle face, OpenMesh::VertexHandle moved,
                              const typename Mesh::Point& to) const {
    std::array<Vec3, 3> result;
    std::size_t n = 0;
    const Mesh& mesh = const_cast<ModWithin*>(this)->Base::mesh();
    for (auto vertex = mesh.cfv_iter(face); vertex.is_valid(); ++vertex) {
      result[n++] = vec(*vertex == moved ? to : mesh.point(*vertex));
    }
    return result;
  }

  double squared_mm2_ = 0.0;
  OpenMesh::FPropHandleT<Places> passed_;
  std::vector<std::array<Vec3, 3>> fan_;
  Places moved_;
};

}  // namespace

bool collapse_edges(CollapsedMesh& surface, const std::vector<std::uint8_t>& is_kept, const CollapseOptions& options) {
  constexpr float kLargestTurnDeg = 45.0F;  // of a triangle's normal by one collapse
  HalfEdgeResult edges = to_half_edges(surface.mesh);
  if (edges.rejected_faces != 0) return false;
  HalfEdgeMesh& mesh = edges.mesh;
  mesh.request_vertex_status();
  mesh.request_edge_status();
  mesh.request_halfedge_status();
  mesh.request_face_status();
  mesh.request_face_normals();
  mesh.update_face_normals();
  OpenMesh::VPropHandleT<std::uint32_t> original;
  mesh.add_property(original);
  for (const auto vertex : mesh.vertices()) {
    const auto n = static_cast<std::size_t>(vertex.idx());
    mesh.property(original, vertex) = surface.originals[n];
    mesh.status(vertex).set_locked(is_kept[n] != 0 || mesh.is_boundary(vertex));
  }

  // Quick checks before slow ones: all must agree.
  decimater::DecimaterT<HalfEdgeMesh> collapser(mesh);
  decimater::ModQuadricT<HalfEdgeMesh>::Handle quadric;
  decimater::ModNormalFlippingT<HalfEdgeMesh>::Handle turn;
  decimater::ModAspectRatioT<HalfEdgeMesh>::Handle shape;
  ModCrease<HalfEdgeMesh>::Handle crease;
  ModWithin<HalfEdgeMesh>::Handle within;
  collapser.add(quadric);
  collapser.add(shape);
  collapser.add(turn);
  collapser.add(crease);
  collapser.add(within);
  collapser.module(quadric).unset_max_err();  // it only says which collapse comes first
  collapser.module(crease).set_tolerance(options.crease_tolerance_mm);
  collapser.module(within).set_tolerance(options.tolerance_mm);
  collapser.module(turn).set_max_normal_deviation(kLargestTurnDeg);
  collapser.module(shape).set_aspect_ratio(15.0F);
  if (!surface.passed_mm.empty()) {
    for (const auto face : mesh.faces()) {
      collapser.module(within).passed(face) = surface.passed_mm[static_cast<std::size_t>(face.idx())];
    }
  }
  collapser.initialize();
  collapser.decimate();
  mesh.garbage_collection();

  surface = {};
  for (const auto vertex : mesh.vertices()) {
    const auto& p = mesh.point(vertex);
    surface.mesh.vertices_mm.emplace_back(p[0], p[1], p[2]);
    surface.originals.push_back(mesh.property(original, vertex));
  }
  for (const auto face : mesh.faces()) {
    std::array<std::uint32_t, 3> corners{};
    std::size_t n = 0;
    for (const auto vertex : mesh.fv_range(face)) corners[n++] = static_cast<std::uint32_t>(vertex.idx());
    surface.mesh.triangles.push_back(corners);
    surface.passed_mm.push_back(std::move(collapser.module(within).passed(face)));
  }
  return true;
}

}  // namespace spinaltap::detail
