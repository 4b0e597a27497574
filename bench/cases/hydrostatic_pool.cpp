#include "bench/cases/hydrostatic_pool.h"

#include "bench/cases/cpu_clock.h"
#include "bench/cases/tank.h"

#include <cmath>
#include <numbers>
#include <utility>

namespace smelt::hydrostatic_pool {

namespace {

SolverParameters<2> pool_parameters(const Pool& pool) {
  auto parameters = make_water_parameters(pool.spacing(), depth, 0.2);
  parameters.gravity = -gravity * pool.up;
  parameters.hourglass_control = 1.0;
  parameters.density_diffusion = 0.3;
  return parameters;
}

void add_water(Pool& pool, const Vec<2>& x) {
  const double c = pool_parameters(pool).sound_speed;
  const double pressure = water_density * gravity * (pool.level - x.dot(pool.up));
  add_particle<2>(pool.particles, x, Vec<2>::Zero(), density_at_pressure(PressureLaw::linear, c, pressure));
}

void measure_pressure(const Solver<2, double>& solver, const Pool& pool, Seen& seen) {
  const double scale = water_density * gravity * depth, spacing = pool.spacing();
  for (std::size_t k = 1; k < pool.wall.size(); ++k) {
    const Vec<2> step = (pool.wall[k] - pool.wall[k - 1]).normalized() * spacing;
    const double length = (pool.wall[k] - pool.wall[k - 1]).norm();
    for (int i = 0; i * spacing <= length; ++i) {
      const Vec<2> point = pool.wall[k - 1] + i * step;
      if (point.dot(pool.up) > pool.level - 2.0 * spacing) continue;
      const double error = std::abs(gauge_excess(solver, pool.level, point)) / scale;
      if (!std::isnan(seen.gauge) && !(error <= seen.gauge)) seen.gauge = error;  // a NaN, of a dry gauge, stays one
    }
  }
  const auto& p = solver.particles();
  for (std::size_t i = 0; i < p.size(); ++i) {
    const double pressure = linear_pressure(solver.parameters().sound_speed, water_density, p.density[i]);
    const double error =
        std::abs(pressure - water_density * gravity * (pool.level - p.position[i].dot(pool.up))) / scale;
    seen.particle = std::max(seen.particle, error);
  }
}

/// Pressure of the flat pool's particles over their height.
Profile profile_of(const Pool& pool, const Particles<2>& p) {
  const double c = pool_parameters(pool).sound_speed;
  Profile profile;
  for (std::size_t i = 0; i < p.size(); i += 1 + p.size() / 600)
    profile.computed.add(p.position[i].dot(pool.up), linear_pressure(c, water_density, p.density[i]));
  for (const double y : {0.0, pool.level}) profile.reference.add(y, water_density * gravity * (pool.level - y));
  return profile;
}

Measurement run_case(std::size_t method, double n) {
  const int n_deep = static_cast<int>(n);
  const CpuClock clock;
  const Pool pool = method == 2 ? slope_pool(n_deep) : box_pool("box", method == 0 ? 0.0 : 17.0, n_deep);
  const Seen seen = rest(pool, 2.5);
  return {.error = seen.gauge,
          .cpu_seconds = clock.seconds(),
          .n_particles = seen.particles.size(),
          .profile = profile_of(pool, seen.particles)};
}

}  // namespace

Pool box_pool(const std::string& name, double degrees, int n_deep) {
  const double angle = degrees * std::numbers::pi / 180.0, height = 3.0 * depth;
  Pool pool{name, n_deep, {Vec<2>(width, height), Vec<2>(width, 0.0), Vec<2>(0.0, 0.0), Vec<2>(0.0, height)}};
  pool.up = Vec<2>(std::sin(angle), std::cos(angle));
  pool.level = Vec<2>(0.5 * width, depth).dot(pool.up);
  const double spacing = pool.spacing();
  for (int j = 0; j < 3 * n_deep; ++j)
    for (int i = 0; i < 2 * n_deep; ++i) {
      const Vec<2> x(spacing * (i + 0.5), spacing * (j + 0.5));
      if (x.dot(pool.up) < pool.level) add_water(pool, x);
    }
  return pool;
}

Pool slope_pool(int n_deep) {
  const double angle = std::numbers::pi / 6.0, run = 1.0 / std::tan(angle);
  const Vec<2> normal(std::sin(angle), std::cos(angle));
  Pool pool{
      "30 degree slope",
      n_deep,
      {Vec<2>(width, 2.0 * depth), Vec<2>(width, 0.0), Vec<2>(0.0, 0.0), Vec<2>(-2.0 * depth * run, 2.0 * depth)}};
  const double spacing = pool.spacing();
  std::vector<Vec<2>> sites;
  for (int j = 0; j < n_deep; ++j)
    for (int i = -static_cast<int>(std::ceil(n_deep * run)); i < 2 * n_deep; ++i) {
      Vec<2> x(spacing * (i + 0.5), spacing * (j + 0.5));
      const double distance = x.dot(normal);
      if (distance < 0.0) continue;
      if (distance < 0.5 * spacing) x += (0.5 * spacing - distance) * normal;
      sites.push_back(x);
    }
  const double volume = static_cast<double>(sites.size()) * spacing * spacing;
  pool.level = (std::sqrt(width * width + 2.0 * run * volume) - width) / run;  // width level + run level^2/2 = volume
  for (const Vec<2>& x : sites) add_water(pool, x);
  pool.settling = 2.0;
  return pool;
}

Seen rest(const Pool& pool, double duration) {
  const auto parameters = pool_parameters(pool);
  Particles<2> particles = pool.particles;
  if (pool.settling > 0.0) {
    Obstacle<2> sticky = make_wall(pool.wall);
    sticky.response.friction = 0.0;
    Colliders<2> colliders;
    colliders.add(sticky);
    Solver<2, double> oil(parameters, {newtonian_material(water_density, 0.02 * water_density)}, std::move(colliders),
                          particles);
    oil.prepare();
    advance_by(oil, pool.settling);
    particles = oil.particles();
    particles.stress.clear();
    particles.viscosity.clear();
    for (Vec<2>& v : particles.velocity) v.setZero();
  }
  std::vector<Vec<2>> start(particles.size());
  for (std::size_t i = 0; i < particles.size(); ++i)
    start[static_cast<std::size_t>(particles.id[i])] = particles.position[i];

  Seen seen;
  Solver<2, double> water(parameters, {inviscid_material(water_density)}, make_colliders({pool.wall}),
                          std::move(particles));
  water.prepare();
  constexpr double interval = 0.1;
  for (int k = 1; k * interval < duration + 0.5 * interval; ++k) {
    advance_by(water, interval, (k - 1) * interval);
    if (k * interval > formed - 0.5 * interval) measure_pressure(water, pool, seen);
  }
  const auto& p = water.particles();
  for (std::size_t i = 0; i < p.size(); ++i) {
    seen.speed = std::max(seen.speed, p.velocity[i].norm());
    seen.drift += (p.position[i] - start[static_cast<std::size_t>(p.id[i])]).squaredNorm();
  }
  seen.drift = std::sqrt(seen.drift / static_cast<double>(p.size())) / pool.spacing();
  seen.particles = p;
  return seen;
}

Case make_case() {
  return {
      .name = "hydrostatic_pool",
      .title = "Hydrostatic pool",
      .measures =
          "The pressure that gauges along the wetted walls of a pool at rest show from 2 to 2.5 s, the worst of them, "
          "against rho g depth: over a flat floor with corners, in a tilted box, and over a slope of 30 degrees.",
      .good = "Within 3 % of the pressure at the bottom.",
      .good_errors = {0.03},
      .error_label = "pressure on walls: largest error / rho g depth",
      .resolution_label = "particles deep",
      .profile_x = "height [m]",
      .profile_y = "pressure of particles [Pa]",
      .methods = {"flat floor", "tilted by 17 degrees", "slope of 30 degrees"},
      .quick = {8, 12, 16, 24},
      .full = {12, 16, 24, 32, 48},
      .run = run_case};
}

}  // namespace smelt::hydrostatic_pool
