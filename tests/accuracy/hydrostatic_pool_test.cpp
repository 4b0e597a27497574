// Water at rest for ten seconds over a flat floor with its corners, in a tilted box and over a slope: p = rho g (level
// - y).

#include "tests/accuracy/measure.h"
#include "tests/accuracy/tank.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <numbers>

namespace smelt {
namespace {

constexpr double depth = 0.5, width = 1.0;
constexpr int n_deep = 24;
constexpr double spacing = depth / n_deep;
constexpr double bar = 0.03;
constexpr double formed = 2.0;  ///< [s] from the start: particles have moved off the lattice to where they rest

/// A tank filled with particles at rest under the pressure of what is above them.
struct Pool {
  std::string name;
  std::vector<Vec<2>> wall;
  Vec<2> up = Vec<2>(0.0, 1.0);
  double level = depth;  ///< along `up`
  Particles<2> particles = {};
  double settling = 0.0;  ///< [s] as a viscous fluid, whose pressure at rest is the same
};

SolverParameters<2> pool_parameters(const Pool& pool) {
  auto parameters = make_water_parameters(spacing, depth, 0.2);
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

/// Gravity is turned by `degrees` over a box.
Pool box_pool(const std::string& name, double degrees) {
  const double angle = degrees * std::numbers::pi / 180.0, height = 3.0 * depth;
  Pool pool{name, {Vec<2>(width, height), Vec<2>(width, 0.0), Vec<2>(0.0, 0.0), Vec<2>(0.0, height)}};
  pool.up = Vec<2>(std::sin(angle), std::cos(angle));
  pool.level = Vec<2>(0.5 * width, depth).dot(pool.up);
  for (int j = 0; j < 3 * n_deep; ++j)
    for (int i = 0; i < 2 * n_deep; ++i) {
      const Vec<2> x(spacing * (i + 0.5), spacing * (j + 0.5));
      if (x.dot(pool.up) < pool.level) add_water(pool, x);
    }
  return pool;
}

/// A flat floor that ends in a slope of 30 degrees. All sites in front of the slope are filled, so that the volume is
/// right, and those nearer than half a spacing are moved that far off; the level follows from the volume. A lattice
/// that starts farther off has gaps to sink into, and sloshes for longer than the test runs.
Pool slope_pool() {
  const double angle = std::numbers::pi / 6.0, run = 1.0 / std::tan(angle);
  const Vec<2> normal(std::sin(angle), std::cos(angle));
  Pool pool{
      "30 degree slope",
      {Vec<2>(width, 2.0 * depth), Vec<2>(width, 0.0), Vec<2>(0.0, 0.0), Vec<2>(-2.0 * depth * run, 2.0 * depth)}};
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

/// What a pool at rest should not show; shares of rho g depth, spacings, m/s.
struct Seen {
  double gauge = 0.0;     ///< largest error of pressure along the wetted wall, all times after `formed`
  double particle = 0.0;  ///< of a single particle
  double speed = 0.0;     ///< fastest particle at the end
  double drift = 0.0;     ///< root mean square way of the particles
};

void measure_pressure(const Solver<2, double>& solver, const Pool& pool, Seen& seen) {
  const double scale = water_density * gravity * depth;
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
  seen.drift = std::sqrt(seen.drift / static_cast<double>(p.size())) / spacing;
  return seen;
}

void test_pool(const Pool& pool) {
  const double duration = full_run() ? 10.0 : 2.5;
  const Seen seen = rest(pool, duration);
  const std::string problem = fmt::format("hydrostatic pool; {}", pool.name);
  const std::string resolution = fmt::format("{} deep; {:g} s", n_deep, duration);
  report_row({problem, "pressure on the wall / rho g H; max after 2 s", resolution, seen.gauge, bar});
  report_row({problem, "pressure of one particle / rho g H; max after 2 s", resolution, seen.particle});
  report_row({problem, "fastest particle at the end [m/s]", resolution, seen.speed});
  report_row({problem, "drift of particles [spacings]; rms", resolution, seen.drift});
}

TEST(HydrostaticPool, FlatFloorAndCorners) {
  test_pool(box_pool("flat floor", 0.0));
}
TEST(HydrostaticPool, TiltedBox) {
  test_pool(box_pool("box tilted by 17 degrees", 17.0));
}
TEST(HydrostaticPool, Slope) {
  test_pool(slope_pool());
}

}  // namespace
}  // namespace smelt
