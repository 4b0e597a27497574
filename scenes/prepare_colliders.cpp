#include "scenes/prepare_colliders.h"

#include "core/error.h"
#include "core/geometry/inside.h"
#include "core/geometry/orientation.h"
#include "core/geometry/simplex_bvh.h"
#include "scenes/collider_motion.h"

#include <algorithm>
#include <cmath>

namespace smelt {

namespace {

/// Puts the line of the scene file that names collider `k` before every warning from `first` on.
void say_where(const Scene& scene, std::size_t k, std::size_t first, std::vector<std::string>& warnings) {
  const std::string where = scene.places.find(fmt::format("collider.{}.mesh", k)).text;
  for (std::size_t w = first; w < warnings.size(); ++w) warnings[w] = fmt::format("{}: {}", where, warnings[w]);
}

/// One particle of all of them, in words.
std::string place_of(const Vec3& x) {
  return fmt::format("({:.4g}, {:.4g}, {:.4g}) m", x[0], x[1], x[2]);
}

std::string size_of(const Box3& bounds) {
  const Vec3 e = bounds.extent();
  return fmt::format("{:.3g} x {:.3g} x {:.3g} m", e[0], e[1], e[2]);
}

/// A thousand times too large or too small is millimetres for metres, or the other way round.
void warn_about_size(const Scene& scene, const std::string& name, const Box3& bounds, double spacing,
                     SimulationSetup& setup) {
  // Vents are small beside the ground that they stand on: the pile of what they pour is what will meet it.
  const bool poured = setup.particles.size() == 0;
  double fluid = poured ? 0.0 : setup.body_bounds.extent().maxCoeff();
  if (poured)
    for (const EmitterSettings& e : scene.emitters) fluid = std::max(fluid, pile_size(scene, e));
  const double size = bounds.extent().maxCoeff();
  const std::string beside = poured ? fmt::format("what is poured, a cube of {:.3g} m", fluid)
                                    : fmt::format("bodies of {}", size_of(setup.body_bounds));
  constexpr double suspicious = 900.0;
  if (size > suspicious * fluid)
    setup.warnings.push_back(
        fmt::format("{}: the collider is enormous, {}, beside {}; if it was made in millimetres, set scale = 0.001",
                    name, size_of(bounds), beside));
  else if (size < fluid / suspicious || size < spacing)
    setup.warnings.push_back(fmt::format(
        "{}: the collider is tiny, {}, beside {} and particles {:.3g} m apart; if it was made in other units, set "
        "scale, for instance to 1000",
        name, size_of(bounds), beside, spacing));
}

/// Which particles lie inside a closed mesh.
std::vector<bool> find_inside(const TriangleMesh& mesh, const std::vector<Vec3>& particles) {
  std::vector<bool> inside(particles.size(), false);
  const Box3 bounds = compute_bounds(mesh);
  const InsideTest test(mesh, bounds.extent().maxCoeff() / 100.0);
  std::vector<Crossing> crossings;
  for (std::size_t i = 0; i < particles.size(); ++i) inside[i] = test.contains(particles[i], crossings);
  return inside;
}

/// Whether the closed mesh holds all of some body. Throws where it holds most of one.
bool is_container(const Scene& scene, const std::string& name, const std::vector<bool>& inside,
                  const std::vector<std::size_t>& first) {
  bool container = false;
  for (std::size_t k = 0; k + 1 < first.size(); ++k) {
    const auto begin = inside.begin() + static_cast<std::ptrdiff_t>(first[k]),
               end = inside.begin() + static_cast<std::ptrdiff_t>(first[k + 1]);
    const auto n_in = std::count(begin, end, true), n = end - begin;
    if (n > 0 && n_in == n) container = true;
    if (2 * n_in > n && n_in < n)
      fail(
          "{}: {} of the {} particles of the body {} start inside this closed collider and the rest outside; a vessel "
          "must hold all of a body, a solid should hold none of it: move or scale one of them",
          name, n_in, n, scene.bodies[k].mesh);
  }
  return container;
}

/// Drops particles, with the volume they stood for, and numbers the others anew.
void leave_out(const std::vector<bool>& which, SimulationSetup& setup) {
  const auto n = setup.particles.size();
  for_each_array(setup.particles, [&](auto& values) {
    if (values.empty()) return;
    std::size_t kept = 0;
    for (std::size_t i = 0; i < n; ++i)
      if (!which[i]) values[kept++] = values[i];
    values.resize(kept);
  });
  const auto left = setup.particles.size();
  setup.body_volume *= static_cast<double>(left) / static_cast<double>(n);
  for (std::size_t i = 0; i < left; ++i) setup.particles.id[i] = static_cast<std::int32_t>(i);
}

/// What particles a sheet stands between: it is crossed on the way of a spacing along some axis from one to where
/// another must be.
void warn_about_cuts(const std::string& name, const TriangleMesh& mesh, double spacing, SimulationSetup& setup) {
  if (setup.particles.size() == 0) return;
  std::vector<Simplex<3>> facets;
  for (const auto& t : mesh.triangles)
    facets.push_back({mesh.vertices[t[0]], mesh.vertices[t[1]], mesh.vertices[t[2]]});
  const SimplexBvh<3> bvh(std::move(facets));
  // Particles by the cell of their lattice, to know where another one is.
  const auto cell_of = [&](const Vec3& x) {
    const Eigen::Array3i c = (x / spacing).array().floor().cast<int>();
    return std::array<int, 3>{c[0], c[1], c[2]};
  };
  std::vector<std::array<int, 3>> cells;
  for (const Vec3& x : setup.particles.position) cells.push_back(cell_of(x));
  std::sort(cells.begin(), cells.end());
  std::size_t n_cut = 0;
  Vec3 where = Vec3::Zero();
  const double reach = 1.01 * spacing;
  for (const Vec3& x : setup.particles.position) {
    if (bvh.distance(x, reach) >= reach) continue;
    bool cut = false;
    for (int way = 0; way < 6 && !cut; ++way) {
      Vec3 step = Vec3::Zero();
      step[way / 2] = way % 2 ? -spacing : spacing;
      if (!std::binary_search(cells.begin(), cells.end(), cell_of(x + step))) continue;
      cut = bvh.first_contact(x, step, 1e-3 * spacing).has_value();
    }
    if (cut && n_cut++ == 0) where = x;
  }
  if (n_cut > 0)
    setup.warnings.push_back(fmt::format(
        "{}: the collider cuts through a body, between {} particles and their neighbours, first at {}; what starts "
        "behind it stays there: move one of them unless that is meant",
        name, n_cut, place_of(where)));
}

void prepare_collider(const Scene& scene, std::size_t k, double spacing, std::vector<std::size_t>& first,
                      SimulationSetup& setup) {
  const std::string& name = scene.colliders[k].mesh;
  const Motion<3>& motion = setup.obstacles[k].motion;
  const TriangleMesh mesh =
      motion.still() ? setup.colliders[k] : moved(setup.colliders[k], pose_at(motion, 0.0));  // where it starts
  warn_about_size(scene, name, compute_bounds(mesh), spacing, setup);

  const MeshTopology topology = compute_topology(mesh);
  if (!topology.closed()) {
    const std::size_t n_faults =
        topology.n_boundary_edges + topology.n_nonmanifold_edges + topology.n_misoriented_edges;
    // A terrain is open on purpose. A body with a few holes was meant to be closed.
    if (static_cast<double>(n_faults) < 0.05 * static_cast<double>(mesh.triangles.size()) ||
        topology.n_boundary_edges == 0)
      setup.warnings.push_back(fmt::format(
          "{}: the collider is not quite closed ({} open edges, {} with more than two faces, {} between faces wound "
          "against each other): taken for a sheet with two sides, not for a solid",
          name, topology.n_boundary_edges, topology.n_nonmanifold_edges, topology.n_misoriented_edges));
    else if (topology.n_nonmanifold_edges > 0 && scene.colliders[k].wall)
      setup.warnings.push_back(fmt::format(
          "{}: the collider branches (edges with more than two faces: {}): near them pressure and shear may come from "
          "the wrong side; make its parts colliders of their own",
          name, topology.n_nonmanifold_edges));
    // A sheet has two sides, and fluid stays on that which it starts on: looking up, it is the ground of what is above.
    if (compute_vector_area(mesh)[1] < 0.0)
      for (auto& t : setup.colliders[k].triangles) std::swap(t[1], t[2]);
    return warn_about_cuts(name, mesh, spacing, setup);
  }

  const std::vector<bool> inside = find_inside(mesh, setup.particles.position);
  if (is_container(scene, name, inside, first)) return warn_about_cuts(name, mesh, spacing, setup);
  setup.obstacles[k].closed = true;
  if (compute_volume(mesh) < 0.0) {
    for (auto& t : setup.colliders[k].triangles) std::swap(t[1], t[2]);
    setup.warnings.push_back(fmt::format(
        "{}: the collider's faces are wound inward and no body is in it: turned outward, so that it is solid inside",
        name));
  }
  const auto n_inside = static_cast<std::size_t>(std::count(inside.begin(), inside.end(), true));
  if (n_inside == 0) return;
  std::vector<std::size_t> left(first.size(), 0);
  for (std::size_t b = 0; b + 1 < first.size(); ++b) {
    const auto begin = inside.begin() + static_cast<std::ptrdiff_t>(first[b]),
               end = inside.begin() + static_cast<std::ptrdiff_t>(first[b + 1]);
    left[b + 1] = left[b] + static_cast<std::size_t>(std::count(begin, end, false));
  }
  setup.warnings.push_back(fmt::format(
      "{}: {} of {} particles would start inside this solid collider, first at {}: left out, with their volume", name,
      n_inside, setup.particles.size(),
      place_of(setup.particles.position[static_cast<std::size_t>(std::find(inside.begin(), inside.end(), true) -
                                                                 inside.begin())])));
  leave_out(inside, setup);
  first = left;
}

}  // namespace

void wind_collider(const Scene& scene, std::size_t k, TriangleMesh& mesh, std::vector<std::string>& warnings) {
  const std::string& name = scene.colliders[k].mesh;
  const std::size_t n_warnings = warnings.size(), n_faces = mesh.triangles.size();
  const Orientation found = orient(mesh);
  if (found.n_dropped > 0)
    warnings.push_back(
        fmt::format("{}: {} of the collider's {} faces lie on others: left out", name, found.n_dropped, n_faces));
  if (found.n_turned > 0)
    warnings.push_back(
        fmt::format("{}: {} of the collider's {} faces were wound against their neighbours: turned round", name,
                    found.n_turned, mesh.triangles.size()));
  if (!found.orientable && scene.colliders[k].wall)
    warnings.push_back(fmt::format(
        "{}: the collider's faces cannot be wound alike, it has one side only (as a Moebius strip): pressure and shear "
        "along it are wrong; mend the mesh, or set wall = false",
        name));
  say_where(scene, k, n_warnings, warnings);
}

void prepare_colliders(const Scene& scene, const std::vector<std::size_t>& first, SimulationSetup& setup) {
  const auto n = setup.particles.size();
  const double spacing = n > 0 ? std::cbrt(setup.body_volume / static_cast<double>(n)) : *scene.particles.spacing;
  std::vector<std::size_t> now = first;
  for (std::size_t k = 0; k < setup.colliders.size(); ++k) {
    if (scene.colliders[k].mesh == "ground") continue;
    const std::size_t n_warnings = setup.warnings.size();
    blame(scene.places, fmt::format("collider.{}.mesh", k), [&] { prepare_collider(scene, k, spacing, now, setup); });
    say_where(scene, k, n_warnings, setup.warnings);
  }
}

}  // namespace smelt
