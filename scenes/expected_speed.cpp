#include "scenes/expected_speed.h"

#include "core/sph/stress_update.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <span>
#include <utility>

namespace smelt {

namespace {

/// A material in a layer that runs down a slope, or off its own pile where that is steeper.
struct Layer {
  const Material& material;
  double gravity;  ///< [m/s^2]
  double fastest;  ///< beyond a thousand times this it does not matter how fast [m/s]
  double slope;    ///< its sine
  double width;    ///< of the pile: as thick as this it is as steep as can be [m]

  FlowCurve curve() const {
    return material.heat ? flow_curve_at(material.rheology, 1.0, material.heat->hot)
                         : flow_curve_at(material.rheology, 0.0);
  }

  /// Of its surface [m/s].
  double speed(double thickness) const {
    const FlowCurve c = curve();
    if (c.yield_stress == 0.0 && c.consistency == 0.0) return std::numeric_limits<double>::infinity();
    const double stress = material.density * gravity * std::max(slope, std::min(1.0, thickness / width)) * thickness,
                 fastest_rate = 1e3 * fastest / thickness;
    // The spring takes next to nothing: it keeps the rate finite.
    return relaxed_shear_rate(c, stress / fastest_rate, stress, 0.0) * thickness * c.index / (c.index + 1.0);
  }

  /// At which it carries `flux` [m^2/s], up to `limit` [m]: its mean speed is (n + 1)/(2 n + 1) of the surface's.
  double thickness(double flux, double limit) const {
    const double n = curve().index;
    double thin = 1e-9 * limit, thick = limit;
    for (int bisection = 0; bisection < 100; ++bisection) {
      const double middle = std::sqrt(thin * thick);
      ((n + 1.0) / (2.0 * n + 1.0) * speed(middle) * middle < flux ? thin : thick) = middle;
    }
    return thick;
  }
};

/// The sine of the steepest slope that fluid may run down: all but a hundredth of what faces up (by area) is no
/// steeper. Where fluid is removed it runs down nothing. 1 where there is no ground.
double steepest_slope(const Colliders<3>& colliders, std::span<const Outflow<3>> outflows, const Vec3& down) {
  constexpr double steeper = 0.01;
  std::vector<std::pair<double, double>> slopes;  // sine and area
  double area = 0.0;
  for (const auto& placed : colliders.placed())
    for (const Simplex<3>& facet : placed.bvh.simplices()) {
      const Vec3 doubled = (facet[1] - facet[0]).cross(facet[2] - facet[0]);
      // What lies face down holds nothing; a sheet has no face.
      const Vec3 normal = placed.begin.rotation * doubled.normalized();
      if (placed.obstacle.closed && normal.dot(down) > 1e-6) continue;
      const Vec3 centre = placed.begin.to_world((facet[0] + facet[1] + facet[2]) / 3.0);
      if (std::any_of(outflows.begin(), outflows.end(), [&](const auto& o) { return o.removes(centre); })) continue;
      slopes.emplace_back(normal.cross(down).norm(), 0.5 * doubled.norm());
      area += slopes.back().second;
    }
  std::sort(slopes.begin(), slopes.end());
  double left = steeper * area;
  while (!slopes.empty() && slopes.back().second < left) {
    left -= slopes.back().second;
    slopes.pop_back();
  }
  return slopes.empty() ? 1.0 : slopes.back().first;
}

/// How far `x` can fall until it is on an obstacle, up to `limit` [m].
double fall_from(const Colliders<3>& colliders, const Vec3& x, const Vec3& down, double limit, double spacing) {
  double way = 0.0;
  while (way < limit) {
    const double clearance = colliders.clearance(x + way * down, 100.0 * spacing);
    if (clearance <= 0.6 * spacing) return way;
    way += std::max(0.1 * spacing, clearance - 0.5 * spacing);
  }
  return limit;
}

/// The farthest fall of what is lowest in any column of the bodies' particles [m].
double fall_of_bodies(const SimulationSetup& setup, const Colliders<3>& colliders, const Vec3& down, double limit) {
  const Vec3 across = down.unitOrthogonal(), aside = down.cross(across);
  std::map<std::pair<long, long>, Vec3> lowest;
  for (const Vec3& x : setup.particles.position) {
    const auto column =
        std::pair(std::lround(x.dot(across) / setup.spacing), std::lround(x.dot(aside) / setup.spacing));
    const auto [place, is_new] = lowest.emplace(column, x);
    if (!is_new && x.dot(down) > place->second.dot(down)) place->second = x;
  }
  double fall = 0.0;
  for (const auto& [column, x] : lowest) fall = std::max(fall, fall_from(colliders, x, down, limit, setup.spacing));
  return fall;
}

}  // namespace

ExpectedSpeed expect_speed(const SimulationSetup& setup) {
  const SolverParameters<3>& p = setup.parameters;
  const double g = p.gravity.norm(), free_fall = setup.expected_speed - setup.fastest_start,
               drop = free_fall * free_fall / (2.0 * g);
  if (!(free_fall > 0.0)) return {setup.expected_speed, "that of the fastest start"};
  const Vec3 down = p.gravity / g;
  Colliders<3> colliders = build_colliders(setup);
  colliders.place_at(0.0);
  ExpectedSpeed largest;
  const auto consider = [&](double speed, const std::string& reason) {
    if (speed > largest.speed) largest = {speed, reason};
  };
  const auto consider_layer = [&](const Layer& layer, double thickness, double fall) {
    consider(std::hypot(setup.fastest_start, std::sqrt(2.0 * g * fall)),
             fmt::format("of a fall of {:.3g} m, from where it starts to what is below", fall));
    consider(layer.speed(thickness), fmt::format("of \"{}\" in a layer {:.3g} m thick down the steepest that it meets",
                                                 layer.material.name, thickness));
    consider(std::sqrt(g * thickness), fmt::format("with which \"{}\" is compressed by its own weight, {:.3g} m deep",
                                                   layer.material.name, thickness));
  };
  if (setup.particles.size() > 0) {
    const double height = setup.body_bounds.extent().dot(down.cwiseAbs()),
                 fall = fall_of_bodies(setup, colliders, down, drop);
    std::vector<bool> present(setup.materials.size(), setup.particles.material.empty());
    for (const std::uint8_t m : setup.particles.material) present[m] = true;
    for (std::size_t m = 0; m < present.size(); ++m)
      if (present[m]) consider_layer({setup.materials[m], g, free_fall, 1.0, height}, height, fall);
  }
  const double slope = p.emitters.empty() ? 1.0 : steepest_slope(colliders, p.outflows, down);
  for (const Emitter<3>& e : p.emitters) {
    const Layer layer{setup.materials[e.material], g, free_fall, slope, 2.0 * e.radius};
    const double thickness = layer.thickness(e.flow_rate / layer.width, std::max(drop, 2.0 * e.radius));
    consider_layer(layer, thickness, fall_from(colliders, e.position, down, drop, setup.spacing));
  }
  if (largest.speed < setup.expected_speed) return largest;
  return {setup.expected_speed, fmt::format("of a fall through the whole scene, {:.3g} m", drop)};
}

}  // namespace smelt
