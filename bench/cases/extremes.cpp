#include "bench/cases/extremes.h"

#include "bench/cases/set_up.h"
#include "core/error.h"

#include <Eigen/Geometry>

#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

namespace smelt::extremes {

namespace {

constexpr double density = 1000.0, spacing = 0.05;

/// All terms on, free of walls.
SolverParameters<3> all_terms(double courant) {
  auto parameters = make_parameters<3>(spacing, 20.0);
  parameters.gravity = Vec3(0.0, -9.81, 0.0);
  parameters.shear_wave_speed = 20.0;
  parameters.artificial_viscosity = 0.3;
  parameters.xsph = 0.3;
  parameters.hourglass_control = 1.0;
  parameters.courant = courant;
  return parameters;
}

Material soft_material(double jump = 1000.0) {
  return viscoplastic_material(density, 100.0, 50.0, 0.5, jump);
}

/// Spins and stretches: v = (4 x - 6 y, 6 x - 4 y, 0) in 1/s, far beyond what the yield stress of soft_material holds.
void set_in_motion(Particles<3>& p) {
  for (std::size_t i = 0; i < p.size(); ++i) {
    const Vec3& x = p.position[i];
    p.velocity[i] = Vec3(4.0 * x[0] - 6.0 * x[1], 6.0 * x[0] - 4.0 * x[1], 0.0);
  }
}

Particles<3> moving_block(int edge) {
  const Vec3 half = Vec3::Constant(0.5 * edge * spacing);
  Particles<3> p = make_block<3>({-half, half}, spacing, density, 0.1);
  set_in_motion(p);
  return p;
}

HardScene make_scene(const SolverParameters<3>& parameters, Particles<3> particles, double duration) {
  return {{parameters, {soft_material()}, {}, std::move(particles)}, duration};
}

HardScene two_that_meet(double courant) {
  Particles<3> pair;
  add_particle<3>(pair, Vec3(0.0, 0.0, 0.0), Vec3(0.5, 0.1, 0.0), density);
  add_particle<3>(pair, Vec3(1e-9, 0.0, 0.0), Vec3(-0.5, 0.0, 0.0), density);
  return make_scene(all_terms(courant), std::move(pair), 0.3);
}

HardScene two_within_a_block(double courant) {
  Particles<3> block = moving_block(6);
  const Vec3 middle = block.position[100];
  add_particle<3>(block, middle + Vec3(1e-9, 0.0, 0.0), block.velocity[100] + Vec3(-1.0, 0.0, 0.0), density);
  return make_scene(all_terms(courant), std::move(block), 0.3);
}

HardScene viscosity_jumps(bool relaxed, double courant) {
  Particles<3> p = moving_block(6);
  for (const Vec3& x : p.position) p.material.push_back(x[0] < 0.0 ? 0 : 1);
  auto parameters = all_terms(courant);
  if (!relaxed) parameters.shear_wave_speed = 0.0;
  // The stress without memory limits the step to a sixtieth of what sound allows: a shorter run.
  const double duration = relaxed ? 0.3 : 0.1;
  constexpr double thin = 1e-2;
  return {{parameters, {newtonian_material(density, thin), newtonian_material(density, 1e6 * thin)}, {}, std::move(p)},
          duration};
}

HardScene thread(double courant) {
  Particles<3> p;
  for (int i = 0; i < 40; ++i) {
    const double phase = 2.0 * std::numbers::pi * i / 20.0;
    add_particle<3>(p, Vec3(i * spacing, 0.0, 0.0), Vec3(0.3 * std::cos(phase), std::sin(phase), 0.5 * std::cos(phase)),
                    density);
  }
  return make_scene(all_terms(courant), std::move(p), 0.5);
}

HardScene drop(int n, double courant) {
  Particles<3> p;
  const Vec3 corners[5] = {Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(0, 0, 1), Vec3(1, 1, 0)};
  for (int i = 0; i < n; ++i) add_particle<3>(p, spacing * corners[i], Vec3(0.1, 1.0, 0.0), density);
  for (std::size_t i = 0; i < p.size(); ++i)
    p.velocity[i] += Vec3(0.0, 0.0, 3.0).cross(p.position[i]) - 1.5 * p.position[i];
  return make_scene(all_terms(courant), std::move(p), 0.5);
}

HardScene hot_beside_cold(double courant) {
  Particles<3> p = moving_block(6);
  for (const Vec3& x : p.position) p.temperature.push_back(x[0] < 0.0 ? 1.0 : 5000.0);
  Material m = soft_material();
  m.rheology.jump_number = ThermalRange{1e5, 1.0};
  m.heat = HeatProperties{10.0, 300.0, 400.0};  // conduction, not sound, limits the step
  return {{all_terms(courant), {m}, {}, std::move(p)}, 0.1};
}

}  // namespace

HardScene block_with_jump(double jump, bool relaxed, double courant) {
  auto parameters = all_terms(courant);
  if (!relaxed) parameters.shear_wave_speed = 0.0;
  return {{parameters, {soft_material(jump)}, {}, moving_block(6)}, 0.3};
}

HardScene creeping_block(double jump, bool relaxed, double courant) {
  auto parameters = all_terms(courant);
  parameters.gravity = Vec3::Zero();
  if (!relaxed) parameters.shear_wave_speed = 0.0;
  Particles<3> p = moving_block(6);
  for (Vec3& v : p.velocity) v *= 1e-4;
  return {{parameters, {soft_material(jump)}, {}, std::move(p)}, std::numeric_limits<double>::infinity()};
}

const std::vector<double>& jumps() {
  static const std::vector<double> values{1.0, 10.0, 1e2, 1e3, 1e4, 1e5};
  return values;
}

std::string name_of_block(double jump) {
  return fmt::format("block with J = {:g}", jump);
}

std::vector<HardCase> hard_cases() {
  std::vector<HardCase> cases{
      {"two particles 1e-9 m apart that meet at 1 m/s", two_that_meet},
      {"two particles 1e-9 m apart within a block", two_within_a_block},
      {"viscosity jumps 10^6-fold; relaxed stress", [](double courant) { return viscosity_jumps(true, courant); }},
      {"viscosity jumps 10^6-fold; stress at once", [](double courant) { return viscosity_jumps(false, courant); }},
      {"thread one particle thick", thread},
      {"1 K beside 5000 K", hot_beside_cold}};
  for (const double jump : jumps())
    cases.push_back({name_of_block(jump), [jump](double courant) { return block_with_jump(jump, true, courant); }});
  for (const int n : {1, 2, 5})
    cases.push_back({fmt::format("drop of {}", n), [n](double courant) { return drop(n, courant); }});
  return cases;
}

HardScene make_hard_scene(const std::string& name, double courant) {
  for (const HardCase& hard : hard_cases())
    if (hard.name == name) return hard.make(courant);
  throw InternalError(fmt::format("there is no hard case \"{}\"", name));
}

}  // namespace smelt::extremes
