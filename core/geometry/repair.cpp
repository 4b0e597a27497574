#include "core/geometry/repair.h"

#include "core/error.h"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Polygon_mesh_processing/border.h>
#include <CGAL/Polygon_mesh_processing/connected_components.h>
#include <CGAL/Polygon_mesh_processing/orient_polygon_soup.h>
#include <CGAL/Polygon_mesh_processing/orientation.h>
#include <CGAL/Polygon_mesh_processing/polygon_mesh_to_polygon_soup.h>
#include <CGAL/Polygon_mesh_processing/polygon_soup_to_polygon_mesh.h>
#include <CGAL/Polygon_mesh_processing/self_intersections.h>
#include <CGAL/Polygon_mesh_processing/triangulate_hole.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/alpha_wrap_3.h>
#include <Eigen/Eigenvalues>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace smelt {
namespace {

namespace PMP = CGAL::Polygon_mesh_processing;
using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using CgalMesh = CGAL::Surface_mesh<Kernel::Point_3>;

struct Soup {
  std::vector<Kernel::Point_3> points;
  std::vector<std::array<std::size_t, 3>> faces;
};

Soup to_soup(const TriangleMesh& mesh) {
  Soup soup;
  soup.points.reserve(mesh.vertices.size());
  for (const Vec3& v : mesh.vertices) soup.points.emplace_back(v.x(), v.y(), v.z());
  for (const auto& t : mesh.triangles)
    if (t[0] != t[1] && t[1] != t[2] && t[2] != t[0]) soup.faces.push_back({t[0], t[1], t[2]});
  return soup;
}

/// As a half-edge mesh: neighbours are wound alike, and vertices and edges shared by too many faces are split.
CgalMesh to_cgal(const TriangleMesh& mesh) {
  Soup soup = to_soup(mesh);
  if (!PMP::is_polygon_soup_a_polygon_mesh(soup.faces)) PMP::orient_polygon_soup(soup.points, soup.faces);
  CgalMesh cgal;
  PMP::polygon_soup_to_polygon_mesh(soup.points, soup.faces, cgal);
  return cgal;
}

TriangleMesh from_cgal(const CgalMesh& cgal) {
  TriangleMesh mesh;
  std::vector<std::uint32_t> index(cgal.number_of_vertices() + cgal.number_of_removed_vertices());
  for (const auto v : cgal.vertices()) {
    index[v] = static_cast<std::uint32_t>(mesh.vertices.size());
    const Kernel::Point_3& p = cgal.point(v);
    mesh.vertices.emplace_back(p.x(), p.y(), p.z());
  }
  for (const auto f : cgal.faces()) {
    std::array<std::uint32_t, 3> t{};
    std::size_t k = 0;
    for (const auto v : cgal.vertices_around_face(cgal.halfedge(f))) t[k++] = index[v];
    mesh.triangles.push_back(t);
  }
  return mesh;
}

std::array<Kernel::Point_3, 3> corners_of(const CgalMesh& mesh, CgalMesh::Face_index face) {
  const auto h = mesh.halfedge(face);
  return {mesh.point(mesh.target(h)), mesh.point(mesh.target(mesh.next(h))), mesh.point(mesh.source(h))};
}

/// Whether two faces meet elsewhere than at the corners they share by position. To CGAL a shared corner is one vertex,
/// so it takes copies of a split vertex for an intersection.
bool faces_intersect(const CgalMesh& mesh, CgalMesh::Face_index f, CgalMesh::Face_index g) {
  auto a = corners_of(mesh, f), b = corners_of(mesh, g);
  // Shared corners to the front, in the same order.
  std::size_t n_shared = 0;
  for (std::size_t k = 0; k < 3; ++k)
    if (const auto it = std::find(b.begin() + static_cast<std::ptrdiff_t>(n_shared), b.end(), a[k]); it != b.end()) {
      std::swap(a[k], a[n_shared]);
      std::iter_swap(b.begin() + static_cast<std::ptrdiff_t>(n_shared), it);
      ++n_shared;
    }
  const Kernel::Triangle_3 face_a(a[0], a[1], a[2]), face_b(b[0], b[1], b[2]);
  switch (n_shared) {
    case 0:
      return CGAL::do_intersect(face_a, face_b);
    case 1:
      return CGAL::do_intersect(Kernel::Segment_3(a[1], a[2]), face_b) ||
             CGAL::do_intersect(Kernel::Segment_3(b[1], b[2]), face_a);
    case 2:
      return CGAL::coplanar(a[0], a[1], a[2], b[2]) &&
             CGAL::coplanar_orientation(a[0], a[1], a[2], b[2]) == CGAL::POSITIVE;
    default:
      return true;
  }
}

std::size_t count_self_intersections(const CgalMesh& mesh) {
  std::vector<std::pair<CgalMesh::Face_index, CgalMesh::Face_index>> pairs;
  PMP::self_intersections<CGAL::Sequential_tag>(mesh, std::back_inserter(pairs));
  return static_cast<std::size_t>(std::count_if(pairs.begin(), pairs.end(), [&](const auto& pair) {
    return pair.first == pair.second || faces_intersect(mesh, pair.first, pair.second);
  }));
}

/// Thickness of the vertices about their best plane, as a fraction of their width.
double relative_thickness(const TriangleMesh& mesh) {
  Vec3 mean = Vec3::Zero();
  for (const Vec3& v : mesh.vertices) mean += v;
  mean /= static_cast<double>(mesh.vertices.size());
  Mat3 covariance = Mat3::Zero();
  for (const Vec3& v : mesh.vertices) covariance += (v - mean) * (v - mean).transpose();
  const Eigen::SelfAdjointEigenSolver<Mat3> solver(covariance, Eigen::EigenvaluesOnly);
  return std::sqrt(std::max(0.0, solver.eigenvalues()[0]) / solver.eigenvalues()[2]);
}

/// Refuses a closed surface none of whose parts holds any volume. Parts wound against one another do not cancel.
void check_volume(CgalMesh& mesh) {
  auto part_of = mesh.add_property_map<CgalMesh::Face_index, std::size_t>("f:part", 0).first;
  std::vector<double> six_volumes(PMP::connected_components(mesh, part_of), 0.0);
  double reach = 0.0;
  for (const auto f : mesh.faces()) {
    const auto [a, b, c] = corners_of(mesh, f);
    const Kernel::Point_3& origin = mesh.point(*mesh.vertices().begin());
    six_volumes[part_of[f]] += CGAL::determinant(a - origin, b - origin, c - origin);
    reach = std::max(reach, CGAL::squared_distance(origin, a));
  }
  mesh.remove_property_map(part_of);
  const bool solid = std::any_of(six_volumes.begin(), six_volumes.end(),
                                 [&](double v) { return std::abs(v) > 1e-12 * std::pow(reach, 1.5); });
  if (!solid) fail("the mesh is closed but bounds no volume (a sheet folded onto itself?); give it a thickness");
}

/// "1 hole", "3 holes".
std::string counted(std::size_t n, std::string_view noun) {
  return fmt::format("{} {}{}", n, noun, n == 1 ? "" : "s");
}

/// What is wrong with the mesh, in words; empty where nothing is.
std::string describe_faults(const MeshReport& report) {
  std::string text;
  const auto add = [&](std::size_t n, std::string_view noun) {
    if (n > 0) text += (text.empty() ? "" : ", ") + counted(n, noun);
  };
  add(report.topology.n_boundary_edges, "boundary edge");
  add(report.topology.n_nonmanifold_edges, "non-manifold edge");
  add(report.topology.n_misoriented_edges, "misoriented edge");
  add(report.topology.n_degenerate_faces, "degenerate face");
  add(report.n_self_intersections, "self-intersecting face pair");
  return text;
}

/// Fills each hole that can be and says so.
std::string fill_holes(CgalMesh& mesh) {
  std::vector<CgalMesh::Halfedge_index> borders;
  PMP::extract_boundary_cycles(mesh, std::back_inserter(borders));
  std::size_t n_faces = 0;
  for (const auto border : borders) {
    std::vector<CgalMesh::Face_index> faces;
    PMP::triangulate_hole(mesh, border, std::back_inserter(faces));
    n_faces += faces.size();
  }
  return fmt::format("{} filled with {}", counted(borders.size(), "hole"), counted(n_faces, "face"));
}

/// The wrap follows the input at a distance of up to spacing/20, which thickens a body by as much: little beside the
/// half particle that seeding decides about anyway, while smaller offsets cost ever more faces.
constexpr double offset_in_spacings = 0.05;

/// A wrap that crept in through a gap is a shell about as thick as the offset: volume / area is half its thickness. A
/// sheet thinner than one spacing cannot hold particles either.
bool is_shell(const TriangleMesh& mesh, double spacing) {
  return compute_volume(mesh) < 0.5 * spacing * compute_area(mesh);
}

struct Wrapped {
  TriangleMesh mesh;
  double bridged = 0.0;  ///< gaps up to this width [m]
};

Wrapped wrap(const CgalMesh& mesh, double spacing) {
  Soup soup;
  PMP::polygon_mesh_to_polygon_soup(mesh, soup.points, soup.faces);
  CGAL::Bbox_3 box;
  for (const auto& p : soup.points) box += p.bbox();
  const double diagonal = std::hypot(box.x_span(), box.y_span(), box.z_span());
  for (double alpha = 2.0 * spacing; alpha < 2.0 * diagonal; alpha *= 2.0) {
    CgalMesh wrapped;
    CGAL::alpha_wrap_3(soup.points, soup.faces, 0.5 * alpha, offset_in_spacings * spacing, wrapped);
    Wrapped result{from_cgal(wrapped), alpha};
    if (!is_shell(result.mesh, spacing)) return result;
  }
  fail(
      "the mesh could not be closed: whatever gaps are bridged, it bounds no body thicker than the particle spacing of "
      "{:.4g} m; close its "
      "holes in a modelling program, or use a smaller spacing",
      spacing);
}

}  // namespace

void validate_surface(const TriangleMesh& mesh) {
  if (mesh.triangles.empty())
    fail("the mesh has no triangles ({} vertices); a body needs a closed surface, a collider any",
         mesh.vertices.size());
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v)
    if (const Vec3& p = mesh.vertices[v]; !p.allFinite())
      fail("vertex {} of the mesh is ({}, {}, {}); coordinates must be finite numbers", v + 1, p.x(), p.y(), p.z());
  for (std::size_t f = 0; f < mesh.triangles.size(); ++f)
    for (const std::uint32_t v : mesh.triangles[f])
      if (v >= mesh.vertices.size())
        fail("face {} of the mesh refers to vertex {}; there are {}", f + 1, std::size_t{v} + 1, mesh.vertices.size());

  const double width = compute_bounds(mesh).extent().norm();
  if (!(compute_area(mesh) > 1e-12 * width * width))
    fail("the mesh has no area ({}, all degenerate); a body needs a closed surface, a collider any",
         counted(mesh.triangles.size(), "face"));
}

void validate_mesh(const TriangleMesh& mesh) {
  validate_surface(mesh);
  if (relative_thickness(mesh) < 1e-6)
    fail("the mesh is flat: all its vertices lie in one plane, so it bounds no volume; give it a thickness");
}

RepairedMesh repair(const TriangleMesh& mesh, double spacing) {
  CHECK_GT(spacing, 0.0);
  validate_mesh(mesh);

  // Look.
  RepairedMesh result{mesh, {}};
  MeshReport& report = result.report;
  report.topology = compute_topology(mesh);
  CgalMesh cgal = to_cgal(mesh);
  if (report.topology.n_boundary_edges == 0) check_volume(cgal);
  report.n_self_intersections = count_self_intersections(cgal);
  report.self_intersects = report.n_self_intersections > 0;
  const std::string faults = describe_faults(report);
  const double volume_as_given = compute_volume(mesh);
  const auto finish = [&](std::string what) {
    report.repaired = true;
    report.description = faults.empty() ? std::move(what) : faults + ": " + what;
    return result;
  };

  // Closed and simple: at most the winding is wrong.
  if (faults.empty()) {
    if (PMP::does_bound_a_volume(cgal) && volume_as_given > 0.0) {
      report.description =
          fmt::format("closed, {}, volume {:.6g} m^3", counted(mesh.triangles.size(), "face"), volume_as_given);
      return result;
    }
    PMP::orient_to_bound_a_volume(cgal);
    result.mesh = from_cgal(cgal);
    return finish(fmt::format("faces wound inward: turned outward, volume {:.6g} m^3", compute_volume(result.mesh)));
  }

  // Dropping, turning and adding faces may be enough; it leaves every vertex in its place.
  std::vector<std::string> done;
  if (report.topology.n_degenerate_faces > 0) done.push_back("degenerate faces dropped");
  if (report.topology.n_nonmanifold_edges > 0) done.push_back("faces taken apart at non-manifold edges");
  if (report.topology.n_misoriented_edges > 0) done.push_back("faces turned");
  if (!CGAL::is_closed(cgal)) done.push_back(fill_holes(cgal));
  if (CGAL::is_closed(cgal) && count_self_intersections(cgal) == 0) {
    PMP::orient_to_bound_a_volume(cgal);
    result.mesh = from_cgal(cgal);
    return finish(fmt::format("{}; volume {:.6g} m^3", fmt::join(done, ", "), compute_volume(result.mesh)));
  }

  // The rest is wrapped, holes filled as far as they could be.
  Wrapped wrapped = wrap(cgal, spacing);
  result.mesh = std::move(wrapped.mesh);
  return finish(
      fmt::format("wrapped in {} at {:.3g} m from the surface, bridging gaps up to {:.3g} m; volume {:.6g} m^3",
                  counted(result.mesh.triangles.size(), "face"), offset_in_spacings * spacing, wrapped.bridged,
                  compute_volume(result.mesh)));
}

}  // namespace smelt
