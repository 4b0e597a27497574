// Water at rest on triangle meshes in 3D, along no axis: in a bowl, over a slope of 30 degrees, in a box tilted by 17
// degrees. The meshes are about as fine as the particles, so that every kind of wall integral takes part
// (docs/decisions/0014-fine-walls.md).

#include "bench/cases/tank.h"
#include "tests/accuracy/measure.h"

#include <Eigen/Geometry>
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <functional>
#include <numbers>

namespace smelt {
namespace {

constexpr double degrees = std::numbers::pi / 180.0;
constexpr double depth = 0.5;  ///< scale of the pressure, of the sound speed [m]; about how deep the pools are

/// [s] from the start: particles have moved off the lattice to where they rest. They are crowded where sites were moved
/// off the walls, and spread for seconds; the pressure is too low meanwhile.
constexpr double formed = 6.0;

/// What holds the water: y is up.
struct Vessel {
  std::string name;
  std::vector<Simplex<3>> facets;
  std::function<double(const Vec3&)> distance;  ///< from the wall, positive in the water [m]
  std::function<Vec3(const Vec3&)> normal;      ///< of the wall nearest to a place, into the water
  Box<3> bounds;                                ///< of the water [m]
  double fill = depth;                          ///< sites up to this height are filled [m]
  Box<3> period = {Vec3::Zero(), Vec3::Zero()};
};

/// A parallelogram of triangles with edges of about `edge`, facing a x b.
void add_plane(std::vector<Simplex<3>>& facets, const Vec3& corner, const Vec3& a, const Vec3& b, double edge) {
  const int n = std::max(1, static_cast<int>(a.norm() / edge)), m = std::max(1, static_cast<int>(b.norm() / edge));
  const auto at = [&](int i, int j) { return Vec3(corner + i * a / n + j * b / m); };
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < m; ++j) {
      facets.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
      facets.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
    }
}

/// Half-spaces that the water lies in front of: points p with (p - point).normal > 0.
struct HalfSpace {
  Vec3 point, normal;
};

void set_half_spaces(Vessel& vessel, const std::vector<HalfSpace>& walls) {
  vessel.distance = [=](const Vec3& x) {
    double least = std::numeric_limits<double>::infinity();
    for (const HalfSpace& w : walls) least = std::min(least, (x - w.point).dot(w.normal));
    return least;
  };
  vessel.normal = [=](const Vec3& x) {
    const auto nearest = std::min_element(walls.begin(), walls.end(), [&](const HalfSpace& a, const HalfSpace& b) {
      return (x - a.point).dot(a.normal) < (x - b.point).dot(b.normal);
    });
    return nearest->normal;
  };
}

/// A slope of 30 degrees that ends at an upright wall; it repeats along z.
Vessel slope(double spacing) {
  Vessel v{"30 degree slope", {}, {}, {}, {Vec3(0.0, 0.0, 0.0), Vec3(0.9, depth, 0.0)}};
  const double wide = 6.0 * spacing, far = 6.0 * spacing, rise = std::tan(30.0 * degrees);
  v.period.upper[2] = wide;
  v.bounds.upper[2] = wide;
  const Vec3 up(-std::sin(30.0 * degrees), std::cos(30.0 * degrees), 0.0);
  const Vec3 across(0.0, 0.0, wide + 2.0 * far);
  // From x = -0.1 down there to beyond the water's end; the wall at x = 0 is where the water is deepest.
  add_plane(v.facets, Vec3(0.0, 0.0, -far), across, Vec3(1.4, 1.4 * rise, 0.0), 0.7 * spacing);
  add_plane(v.facets, Vec3(0.0, 2.0 * depth, -far), across, Vec3(0.0, -2.0 * depth, 0.0), 0.7 * spacing);
  set_half_spaces(v, {{Vec3::Zero(), up}, {Vec3::Zero(), Vec3::UnitX()}});
  return v;
}

/// A box turned by 17 degrees about z, and by 25 about y to lie along no axis.
Vessel tilted_box(double spacing) {
  Vessel v{"box tilted by 17 degrees", {}, {}, {}, {Vec3::Constant(-0.7), Vec3::Constant(0.7)}};
  const Mat3 turn =
      (Eigen::AngleAxisd(25.0 * degrees, Vec3::UnitY()) * Eigen::AngleAxisd(17.0 * degrees, Vec3::UnitZ()))
          .toRotationMatrix();
  const double a = 0.55, b = 0.4, tall = 1.0;
  const Vec3 x = turn.col(0), y = turn.col(1), z = turn.col(2), corner = -0.5 * a * x - 0.5 * b * z;
  std::vector<HalfSpace> walls{{corner, y}, {corner, x}, {corner, z}, {corner + a * x, -x}, {corner + b * z, -z}};
  add_plane(v.facets, corner, b * z, a * x, 0.7 * spacing);
  add_plane(v.facets, corner, tall * y, b * z, 0.7 * spacing);
  add_plane(v.facets, corner, a * x, tall * y, 0.7 * spacing);
  add_plane(v.facets, corner + a * x, b * z, tall * y, 0.7 * spacing);
  add_plane(v.facets, corner + b * z, tall * y, a * x, 0.7 * spacing);
  set_half_spaces(v, walls);
  v.fill = 0.45;
  return v;
}

Vessel bowl(double spacing) {
  constexpr double radius = 0.5;
  Vessel v{"bowl", {}, {}, {}, {Vec3(-radius, 0.0, -radius), Vec3(radius, radius, radius)}};
  const Vec3 centre(0.0, radius, 0.0);
  const int n_rings = static_cast<int>(0.6 * std::numbers::pi * radius / (0.7 * spacing)), n = 4 * n_rings;
  const auto at = [&](int i, int k) {
    const double polar = 0.6 * std::numbers::pi * i / n_rings, azimuth = 2.0 * std::numbers::pi * k / n;
    return Vec3(centre + radius * Vec3(std::sin(polar) * std::cos(azimuth), -std::cos(polar),
                                       std::sin(polar) * std::sin(azimuth)));
  };
  for (int i = 0; i < n_rings; ++i)
    for (int k = 0; k < n; ++k) {
      if (i > 0) v.facets.push_back({at(i, k), at(i + 1, k), at(i, k + 1)});
      v.facets.push_back({at(i + 1, k), at(i + 1, k + 1), at(i, k + 1)});
    }
  v.distance = [=](const Vec3& x) { return radius - (x - centre).norm(); };
  v.normal = [=](const Vec3& x) { return Vec3((centre - x).normalized()); };
  v.fill = 0.4;
  return v;
}

/// All sites in the vessel up to its filling, those nearer to the wall than half a spacing moved that far off. The
/// level follows from their volume.
Particles<3> fill(const Vessel& v, double spacing, double& level) {
  std::vector<Vec3> sites;
  Box<3> box = v.bounds;
  for (int a = 0; a < 3; ++a) box.lower[a] = std::floor(box.lower[a] / spacing + 1e-9) * spacing;
  const Eigen::Array3i n = ((box.upper - box.lower) / spacing).array().round().cast<int>();
  for (int k = 0; k < n[2]; ++k)
    for (int j = 0; j < n[1]; ++j)
      for (int i = 0; i < n[0]; ++i) {
        Vec3 x = box.lower + spacing * (Vec3(i, j, k) + Vec3::Constant(0.5));
        if (x[1] > v.fill || v.distance(x) < 0.0) continue;
        for (int pass = 0; pass < 4; ++pass)
          if (const double away = v.distance(x); away < 0.5 * spacing) x += (0.5 * spacing - away) * v.normal(x);
        sites.push_back(x);
      }
  // Cells five times as fine, lowest first, until they hold as much.
  std::vector<double> heights;
  const double fine = 0.2 * spacing;
  for (double z = box.lower[2] + 0.5 * fine; z < box.upper[2]; z += fine)
    for (double y = box.lower[1] + 0.5 * fine; y < box.upper[1] + 2.0 * spacing; y += fine)
      for (double x = box.lower[0] + 0.5 * fine; x < box.upper[0] + 2.0 * spacing; x += fine)
        if (v.distance(Vec3(x, y, z)) > 0.0) heights.push_back(y);
  const std::size_t needed = 125 * sites.size();
  CHECK_LT(needed, heights.size());
  std::nth_element(heights.begin(), heights.begin() + static_cast<std::ptrdiff_t>(needed), heights.end());
  level = heights[needed] + 0.5 * fine;
  Particles<3> particles;
  const double c = 10.0 * std::sqrt(2.0 * gravity * depth);
  for (const Vec3& x : sites)
    add_particle<3>(particles, x, Vec3::Zero(),
                    density_at_pressure(PressureLaw::linear, c, water_density * gravity * std::max(0.0, level - x[1])));
  return particles;
}

SolverParameters<3> pool_parameters(const Vessel& v, double spacing) {
  auto parameters = make_parameters<3>(spacing, 10.0 * std::sqrt(2.0 * gravity * depth));
  parameters.smoothing_length = 1.3 * spacing;
  parameters.gravity = Vec3(0.0, -gravity, 0.0);
  parameters.artificial_viscosity = 0.2;
  parameters.density_diffusion = 0.5;
  parameters.hourglass_control = 1.0;
  parameters.courant = 0.4;
  parameters.period = v.period;
  return parameters;
}

Colliders<3> make_mesh_wall(const Vessel& v, double slip) {
  Obstacle<3> wall;
  wall.facets = v.facets;
  wall.wall = true;
  wall.response.friction = slip;
  Colliders<3> colliders;
  colliders.add(std::move(wall));
  return colliders;
}

/// The pressure's excess [Pa] at a point of the wall, as gauge_excess (tank.h) in 2D.
double gauge_excess(const Solver<3, float>& solver, double level, const Vec3& point) {
  const auto& p = solver.particles();
  const double reach = 2.0 * solver.parameters().smoothing_length;
  double sum = 0.0, weights = 0.0;
  for (std::size_t i = 0; i < p.size(); ++i) {
    const double q = (p.position[i] - point).norm() / reach;
    if (q >= 1.0) continue;
    const double weight = std::pow(1.0 - q, 4) * (1.0 + 4.0 * q);
    sum += weight * (linear_pressure(solver.parameters().sound_speed, water_density, p.density[i]) -
                     water_density * gravity * (level - p.position[i][1]));
    weights += weight;
  }
  return weights > 0.0 ? sum / weights : std::numeric_limits<double>::quiet_NaN();
}

/// Errors along the wetted wall, two spacings below the level and more, of the water's depth; not a number where no
/// particle is near.
std::vector<double> pressure_errors(const Solver<3, float>& solver, const Vessel& v, double level, double spacing) {
  double lowest = level;
  for (const Vec3& x : solver.particles().position) lowest = std::min(lowest, x[1]);
  const double scale = water_density * gravity * (level - lowest + 0.5 * spacing);
  std::vector<double> errors;
  for (std::size_t f = 0; f < v.facets.size(); f += 3) {
    const Vec3& point = v.facets[f][0];
    if (point[1] > level - 2.0 * spacing || v.distance(point) < -1e-9) continue;
    if (!v.period.empty() && v.period.upper[2] > 0.0 &&
        (point[2] < 2.0 * spacing || point[2] > v.period.upper[2] - 2.0 * spacing))
      continue;
    errors.push_back(gauge_excess(solver, level, point) / scale);
  }
  return errors;
}

/// Of the sizes of `errors`, times `scale`; not a number where one of them is none.
double largest(const std::vector<double>& errors, double scale = 1.0) {
  double worst = 0.0;
  for (const double e : errors)
    if (!std::isnan(worst) && !(scale * std::abs(e) <= worst)) worst = scale * std::abs(e);
  return worst;
}

void test_pool(Vessel (*make)(double), int n_deep) {
  const double duration = full_run() ? 10.0 : 6.5;
  const double spacing = depth / n_deep;
  const Vessel v = make(spacing);
  const auto parameters = pool_parameters(v, spacing);
  double level = 0.0;
  Particles<3> particles = fill(v, spacing, level);
  const std::size_t n = particles.size();

  // As a viscous fluid first, whose pressure at rest is the same, to where the particles find their places along the
  // wall.
  {
    Solver<3, float> oil(parameters, {newtonian_material(water_density, 0.02 * water_density)}, make_mesh_wall(v, 0.0),
                         std::move(particles));
    oil.prepare();
    advance_by(oil, 2.0);
    particles = oil.particles();
    particles.stress.clear();
    particles.viscosity.clear();
    for (Vec3& x : particles.velocity) x.setZero();
  }
  std::vector<Vec3> start(n);
  for (std::size_t i = 0; i < n; ++i) start[static_cast<std::size_t>(particles.id[i])] = particles.position[i];
  Solver<3, float> water(parameters, {inviscid_material(water_density)}, make_mesh_wall(v, 1.0), std::move(particles));
  water.prepare();
  double worst = 0.0, speed = 0.0, drift = 0.0, deepest = 0.0;
  std::vector<double> summed;
  int n_samples = 0;
  constexpr double interval = 0.1;
  for (int k = 1; k * interval < duration + 0.5 * interval; ++k) {
    advance_by(water, interval, (k - 1) * interval);
    if (k * interval < formed - 0.5 * interval) continue;
    const std::vector<double> errors = pressure_errors(water, v, level, spacing);
    const double now = largest(errors);
    if (!std::isnan(worst) && !(now <= worst)) worst = now;
    summed.resize(errors.size(), 0.0);
    for (std::size_t p = 0; p < errors.size(); ++p) summed[p] += errors[p];
    ++n_samples;
  }
  const auto& p = water.particles();
  for (std::size_t i = 0; i < n; ++i) {
    speed = std::max(speed, p.velocity[i].norm());
    Vec3 way = p.position[i] - start[static_cast<std::size_t>(p.id[i])];
    if (v.period.upper[2] > 0.0) way[2] = std::remainder(way[2], v.period.upper[2]);
    drift += way.squaredNorm();
    deepest = std::max(deepest, -v.distance(p.position[i]));
  }
  const std::string problem = fmt::format("pool on a mesh in 3D; {}", v.name);
  const std::string resolution = fmt::format("{} particles; {} triangles; {:g} s", n, v.facets.size(), duration);
  report_row({problem, "pressure on the wall / rho g H; mean from 6 s on; max over the wall", resolution,
              largest(summed, 1.0 / n_samples), 0.03});
  report_row({problem, "the same; max at any moment", resolution, worst, 0.03});
  report_row({problem, "fastest particle at the end [m/s]", resolution, speed, 0.1});
  report_row({problem, "drift of particles [spacings]; rms", resolution,
              std::sqrt(drift / static_cast<double>(n)) / spacing, 1.0});
  report_row({problem, "way of a centre behind the wall [spacings]", resolution, deepest / spacing, 0.0});
}

TEST(MeshPool, Slope) {
  test_pool(slope, 24);
}
TEST(MeshPool, TiltedBox) {
  if (!full_run()) GTEST_SKIP() << "takes long";
  test_pool(tilted_box, 20);
}
TEST(MeshPool, Bowl) {
  test_pool(bowl, full_run() ? 20 : 12);
}

}  // namespace
}  // namespace smelt
