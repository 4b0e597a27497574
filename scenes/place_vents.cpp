#include "scenes/place_vents.h"

#include "core/error.h"
#include "core/sph/kernel.h"

#include <optional>

namespace smelt {

namespace {

/// Where the vertical line through (x, z) meets a triangle [m], and whether it faces up.
struct VerticalHit {
  double y;
  bool faces_up;
};

std::optional<VerticalHit> meet(const Vec3& a, const Vec3& b, const Vec3& c, double x, double z) {
  const auto cross = [&](const Vec3& p, const Vec3& q) { return (q[0] - p[0]) * (z - p[2]) - (q[2] - p[2]) * (x - p[0]); };
  const double wa = cross(b, c), wb = cross(c, a), wc = cross(a, b), sum = wa + wb + wc;
  if (sum == 0.0 || wa * sum < 0.0 || wb * sum < 0.0 || wc * sum < 0.0) return std::nullopt;
  // In the x-z plane, seen from above, what faces up runs the other way round than in a right-handed plane.
  return VerticalHit{(wa * a[1] + wb * b[1] + wc * c[1]) / sum, sum < 0.0};
}

/// Height of the surface under which `p` lies, if it does: the next one above it faces up.
std::optional<double> ground_above(const TriangleMesh& mesh, const Vec3& p) {
  std::optional<VerticalHit> next;
  for (const auto& t : mesh.triangles) {
    const auto hit = meet(mesh.vertices[t[0]], mesh.vertices[t[1]], mesh.vertices[t[2]], p[0], p[2]);
    if (hit && hit->y > p[1] && (!next || hit->y < next->y)) next = hit;
  }
  if (!next || !next->faces_up) return std::nullopt;
  return next->y;
}

/// Places of the duct: the layers of sites from its entry to its end.
std::vector<Vec3> duct_sites(const Emitter<3>& emitter, const EmitterLayers<3>& layers, double spacing) {
  std::vector<Vec3> places;
  for (double s = 0.0; s <= layers.depth + 0.5 * spacing; s += spacing)
    for (const Vec3& site : layers.sites) places.push_back(emitter.position + site + s * emitter.direction);
  return places;
}

/// What is poured in would land on top of a body's particles.
void refuse_bodies_in_duct(const Emitter<3>& emitter, const EmitterLayers<3>& layers, const SimulationSetup& setup) {
  for (const Vec3& x : setup.particles.position) {
    const double along = (x - emitter.position).dot(emitter.direction);
    const double across = (x - emitter.position - along * emitter.direction).norm();
    if (along > -0.5 * setup.spacing && along < layers.depth && across < emitter.radius + 0.5 * setup.spacing)
      fail("a body fills the vent at ({:.4g}, {:.4g}, {:.4g}) m; move one of them, the vent reaches {:.3g} m along its direction", x[0], x[1], x[2], layers.depth);
  }
}

/// Height of the ground that `x` is under, or nothing.
std::optional<double> ground_over(const Scene& scene, const SimulationSetup& setup, std::size_t collider, const Vec3& x) {
  if (scene.colliders[collider].mesh != "ground") return ground_above(setup.colliders[collider], x);
  const double ground = scene.colliders[collider].ground_height;
  return ground > x[1] ? std::optional(ground) : std::nullopt;
}

void refuse_vent_in_ground(const Scene& scene, const SimulationSetup& setup, const std::vector<Vec3>& places) {
  for (std::size_t k = 0; k < setup.colliders.size(); ++k) {
    double deepest = 0.0, surface = 0.0;
    Vec3 where = Vec3::Zero();
    for (const Vec3& x : places) {
      const auto above = ground_over(scene, setup, k, x);
      if (!above || !(*above - x[1] > deepest)) continue;
      deepest = *above - x[1];
      surface = *above;
      where = x;
    }
    if (deepest > 0.0)
      fail("the vent is in collider {} (\"{}\"): at x = {:.4g}, z = {:.4g} it is at y = {:.6g} m, and the ground there at {:.6g} m; "
           "raise it by {:.3g} m, or take the collider's upper faces away if it is a container",
           k, scene.colliders[k].mesh, where[0], where[2], where[1], surface, deepest);
  }
}

/// How far behind the entry every site that has ground behind it is in that: on ground as steep as 45 degrees the search goes far enough.
double find_root(const Scene& scene, const SimulationSetup& setup, const Emitter<3>& emitter, const EmitterLayers<3>& layers) {
  double root = 0.0;
  for (const Vec3& site : layers.sites) {
    const auto buried = [&](double back) {
      for (std::size_t k = 0; k < setup.colliders.size(); ++k)
        if (ground_over(scene, setup, k, emitter.position + site - back * emitter.direction)) return true;
      return false;
    };
    for (double back = 0.0; back <= 2.0 * emitter.radius; back += setup.spacing) {
      if (!buried(back)) continue;
      root = std::max(root, back + setup.spacing);
      break;
    }
  }
  return root;
}

}  // namespace

void place_vents(const Scene& scene, SimulationSetup& setup) {
  const SolverParameters<3>& p = setup.parameters;
  for (std::size_t e = 0; e < p.emitters.size(); ++e) {
    const std::string path = fmt::format("emitter.{}", e);
    const auto layers = blame(scene.places, path, [&] {
      return compute_emitter_layers<3>(p.emitters[e], p.particle_volume, kernel_kappa(p.kernel) * p.smoothing_length);
    });
    blame(scene.places, path + ".position_m", [&] {
      refuse_bodies_in_duct(p.emitters[e], layers, setup);
      refuse_vent_in_ground(scene, setup, duct_sites(p.emitters[e], layers, setup.spacing));
    });
    setup.parameters.emitters[e].root = find_root(scene, setup, p.emitters[e], layers);
  }
}

}  // namespace smelt
