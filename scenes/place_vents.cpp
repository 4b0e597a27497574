#include "scenes/place_vents.h"

#include "core/error.h"
#include "core/geometry/inside.h"
#include "core/sph/kernel.h"
#include "scenes/collider_motion.h"

#include <algorithm>
#include <memory>
#include <optional>

namespace smelt {

namespace {

/// What lies above a place: a collider where it stands at the start.
class GroundLookup {
 public:
  /// A plane at a height.
  explicit GroundLookup(double height) : height_(height) {}

  /// Lookups will be about `spacing` apart.
  GroundLookup(const TriangleMesh& mesh, double spacing) : turned_(std::make_unique<TriangleMesh>(mesh)) {
    for (Vec3& x : turned_->vertices) x = turned(x);
    lines_.emplace(*turned_, spacing);
  }

  /// Height of the surface under which `p` lies, if it does: the next one above it faces up.
  std::optional<double> above(const Vec3& p) const {
    if (!lines_) return height_ > p[1] ? std::optional(height_) : std::nullopt;
    thread_local std::vector<Crossing> crossings;
    lines_->intersect(turned(p)[1], turned(p)[2], crossings);
    const auto next = std::find_if(crossings.begin(), crossings.end(), [&](const Crossing& c) { return c.x > p[1]; });
    if (next == crossings.end() || next->winding > 0) return std::nullopt;
    return next->x;
  }

 private:
  /// An even permutation with y first: InsideTest looks along x.
  static Vec3 turned(const Vec3& x) { return {x[1], x[2], x[0]}; }

  double height_ = 0.0;
  std::unique_ptr<TriangleMesh> turned_;
  std::optional<InsideTest> lines_;
};

std::vector<GroundLookup> find_grounds(const Scene& scene, const SimulationSetup& setup) {
  std::vector<GroundLookup> grounds;
  for (std::size_t k = 0; k < setup.colliders.size(); ++k) {
    const Motion<3>& motion = setup.obstacles[k].motion;
    if (scene.colliders[k].mesh == "ground")
      grounds.emplace_back(scene.colliders[k].ground_height);
    else if (motion.still())
      grounds.emplace_back(setup.colliders[k], setup.spacing);
    else
      grounds.emplace_back(moved(setup.colliders[k], pose_at(motion, 0.0)), setup.spacing);
  }
  return grounds;
}

/// Places of the duct: the layers of sites from its entry to its end.
std::vector<Vec3> duct_sites(const Emitter<3>& emitter, const EmitterLayers<3>& layers, double spacing) {
  std::vector<Vec3> places;
  for (double s = 0.0; s <= layers.depth + 0.5 * spacing; s += spacing)
    for (const Vec3& site : layers.sites) places.push_back(emitter.position + site + s * emitter.direction);
  return places;
}

/// Whether a particle at `x` would be among those that the vent drives, from its root to the end of its duct.
bool in_duct(const Emitter<3>& emitter, const EmitterLayers<3>& layers, const Vec3& x, double spacing) {
  const double along = (x - emitter.position).dot(emitter.direction);
  const double across = (x - emitter.position - along * emitter.direction).norm();
  return along > -layers.root - 0.5 * spacing && along < layers.depth && across < emitter.radius + 0.5 * spacing;
}

/// What is poured in would land on top of a body's particles.
void refuse_bodies_in_duct(const Emitter<3>& emitter, const EmitterLayers<3>& layers, const SimulationSetup& setup) {
  for (const Vec3& x : setup.particles.position)
    if (in_duct(emitter, layers, x, setup.spacing))
      fail(
          "a body fills the vent at ({:.4g}, {:.4g}, {:.4g}) m; move one of them, the vent reaches {:.3g} m along its "
          "direction and {:.3g} m back",
          x[0], x[1], x[2], layers.depth, layers.root);
}

void refuse_vent_in_ground(const Scene& scene, const std::vector<GroundLookup>& grounds,
                           const std::vector<Vec3>& places) {
  for (std::size_t k = 0; k < grounds.size(); ++k) {
    double deepest = 0.0, surface = 0.0;
    Vec3 where = Vec3::Zero();
    for (const Vec3& x : places) {
      const auto above = grounds[k].above(x);
      if (!above || !(*above - x[1] > deepest)) continue;
      deepest = *above - x[1];
      surface = *above;
      where = x;
    }
    if (deepest > 0.0)
      fail(
          "the vent is in collider {} (\"{}\"): at x = {:.4g}, z = {:.4g} it is at y = {:.6g} m, and the ground there "
          "at {:.6g} m; raise it by {:.3g} m, or take the collider's upper faces away if it is a container; a roof "
          "over a vent needs a thickness",
          k, scene.colliders[k].mesh, where[0], where[2], where[1], surface, deepest);
  }
}

/// How far behind the entry every site that has ground behind it is in that: on ground as steep as 45 degrees the
/// search goes far enough.
double find_root(const std::vector<GroundLookup>& grounds, const Emitter<3>& emitter, const EmitterLayers<3>& layers,
                 double spacing) {
  double root = 0.0;
  for (const Vec3& site : layers.sites) {
    const auto buried = [&](double back) {
      const Vec3 x = emitter.position + site - back * emitter.direction;
      return std::any_of(grounds.begin(), grounds.end(), [&](const GroundLookup& g) { return g.above(x).has_value(); });
    };
    for (double back = 0.0; back <= 2.0 * emitter.radius; back += spacing) {
      if (!buried(back)) continue;
      root = std::max(root, back + spacing);
      break;
    }
  }
  return root;
}

/// Two that pour at the same time into one place.
void refuse_shared_ducts(const Scene& scene, const std::vector<Emitter<3>>& emitters,
                         const std::vector<EmitterLayers<3>>& layers, double spacing) {
  for (std::size_t b = 1; b < emitters.size(); ++b)
    for (std::size_t a = 0; a < b; ++a) {
      if (emitters[a].end <= emitters[b].start || emitters[b].end <= emitters[a].start) continue;
      const std::vector<Vec3> places = duct_sites(emitters[b], layers[b], spacing);
      const auto shared = std::find_if(places.begin(), places.end(),
                                       [&](const Vec3& x) { return in_duct(emitters[a], layers[a], x, spacing); });
      if (shared == places.end()) continue;
      blame(scene.places, fmt::format("emitter.{}.position_m", b), [&] {
        fail(
            "the vent pours into that of emitter {} at ({:.4g}, {:.4g}, {:.4g}) m while both are open; move one of "
            "them, or let one end before the other starts",
            a, (*shared)[0], (*shared)[1], (*shared)[2]);
      });
    }
}

}  // namespace

void place_vents(const Scene& scene, SimulationSetup& setup) {
  SolverParameters<3>& p = setup.parameters;
  if (p.emitters.empty()) return;
  const std::vector<GroundLookup> grounds = find_grounds(scene, setup);
  std::vector<EmitterLayers<3>> all_layers;
  for (std::size_t e = 0; e < p.emitters.size(); ++e) {
    Emitter<3>& emitter = p.emitters[e];
    const std::string path = fmt::format("emitter.{}", e);
    const auto cut = [&] {
      return compute_emitter_layers<3>(emitter, p.particle_volume, kernel_kappa(p.kernel) * p.smoothing_length);
    };
    EmitterLayers<3> layers = blame(scene.places, path, cut);
    blame(scene.places, path + ".position_m",
          [&] { refuse_vent_in_ground(scene, grounds, duct_sites(emitter, layers, setup.spacing)); });
    emitter.root = find_root(grounds, emitter, layers, setup.spacing);
    layers = cut();
    blame(scene.places, path + ".position_m", [&] { refuse_bodies_in_duct(emitter, layers, setup); });
    all_layers.push_back(std::move(layers));
  }
  refuse_shared_ducts(scene, p.emitters, all_layers, setup.spacing);
}

}  // namespace smelt
