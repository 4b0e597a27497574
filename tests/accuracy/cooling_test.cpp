// Bodies that lose heat: a slab by convection, a slab and a half space to the ground, a drop by radiation; and where
// the energy goes.

#include "bench/cases/tank.h"
#include "tests/accuracy/measure.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <vector>

namespace smelt {
namespace {

constexpr double pi = std::numbers::pi;
constexpr double diffusivity = 1.0, density = 1000.0, hot = 400.0, cold = 300.0;

Material warm_material(double specific_heat) {
  Material m = inviscid_material(density);
  m.heat = HeatProperties{diffusivity, 100.0, 200.0};  // liquid all through
  m.heat->specific_heat = specific_heat;
  return m;
}

/// A slab of thickness 1 m, hot, at rest, six particles wide and repeating sideways.
struct Slab {
  Particles<2> particles;
  SolverParameters<2> parameters;
  double width = 0.0;
};
Slab make_slab(double spacing, double jitter) {
  Slab slab;
  slab.width = 6.0 * spacing;
  Box<2> box;
  box.lower = Vec<2>::Zero();
  box.upper = Vec<2>(slab.width, 1.0);
  slab.particles = make_block<2>(box, spacing, density, jitter);
  slab.particles.temperature.assign(slab.particles.size(), hot);
  slab.parameters = make_parameters<2>(spacing, 1e-3);
  slab.parameters.period.lower = Vec<2>(0.0, 0.0);
  slab.parameters.period.upper = Vec<2>(slab.width, -1.0);
  return slab;
}

Colliders<2> make_floor(double temperature) {
  Obstacle<2> floor = make_wall({Vec<2>(2.0, 0.0), Vec<2>(-1.0, 0.0)});
  floor.temperature = temperature;
  Colliders<2> colliders;
  colliders.add(std::move(floor));
  return colliders;
}

/// Largest difference from `exact(height)`, of temperatures 0 cold to 1 hot.
template <typename Exact>
double profile_error(const Solver<2, double>& solver, const Exact& exact) {
  double worst = 0.0;
  const auto& p = solver.particles();
  for (std::size_t i = 0; i < p.size(); ++i)
    worst = std::max(worst, std::abs((p.temperature[i] - cold) / (hot - cold) - exact(p.position[i][1])));
  return worst;
}

/// Root of z tan z = Bi in ((n - 1) pi, (n - 1/2) pi), by bisection.
double biot_root(double biot, int n) {
  double lower = (n - 1) * pi, upper = (n - 0.5) * pi;
  for (int k = 0; k < 200; ++k) {
    const double z = 0.5 * (lower + upper);
    (z * std::tan(z) < biot ? lower : upper) = z;
  }
  return 0.5 * (lower + upper);
}

/// A slab of half width L that convects from both faces after Fo = k t/L^2, at y/L from its middle: the eigenfunction
/// series.
double convecting_slab(double biot, double fourier, double y) {
  double sum = 0.0;
  for (int n = 1; n <= 60; ++n) {
    const double z = biot_root(biot, n);
    sum += 4.0 * std::sin(z) / (2.0 * z + std::sin(2.0 * z)) * std::exp(-z * z * fourier) * std::cos(z * y);
  }
  return sum;
}

double convecting_error(double spacing, double biot, double jitter, double& lost_error) {
  Slab slab = make_slab(spacing, jitter);
  const double specific_heat = 2.0;
  const double conductivity = density * specific_heat * diffusivity;
  slab.parameters.ambient = Ambient{cold, biot * conductivity / 0.5};
  Solver<2, double> solver(slab.parameters, {warm_material(specific_heat)}, {}, std::move(slab.particles));
  solver.prepare();
  double time = 0.0, worst = 0.0;
  for (const double fourier : {0.1, 0.3, 1.0}) {
    const double until = fourier * 0.25;
    advance_by(solver, until - time, time);
    time = until;
    worst = std::max(worst,
                     profile_error(solver, [&](double y) { return convecting_slab(biot, fourier, (y - 0.5) / 0.5); }));
  }
  double mean = 0.0;
  for (const double t : solver.particles().temperature) mean += t / static_cast<double>(solver.particles().size());
  const double held = density * specific_heat * slab.width;
  lost_error = std::abs(solver.heat_ledger().convected / (held * (hot - mean)) - 1.0);
  return worst;
}

TEST(Cooling, SlabThatConvects) {
  const double finest = full_run() ? 1.0 / 80.0 : 1.0 / 40.0;
  for (const double biot : {0.3, 3.0}) {
    std::vector<double> spacing, error;
    double lost = 0.0;
    for (const double coarser : {2.0, 1.0}) {
      spacing.push_back(coarser * finest);
      error.push_back(convecting_error(spacing.back(), biot, 0.0, lost));
    }
    const std::string problem = fmt::format("cooling slab; convection with Bi = {}", biot);
    const std::string resolution = fmt::format("{:.0f} across", 1.0 / finest);
    report_row({.problem = problem,
                .quantity = "temperature / first difference; max; Fo 0.1 to 1",
                .resolution = resolution,
                .error = error.back(),
                .bar = 0.02,
                .order = convergence_order(spacing, error)});
    report_row({.problem = problem,
                .quantity = "energy convected / enthalpy lost - 1",
                .resolution = resolution,
                .error = lost,
                .bar = 1e-6});
    double unused = 0.0;
    report_row({.problem = problem,
                .quantity = "temperature / first difference; max; Fo 0.1 to 1 (jitter 0.1)",
                .resolution = resolution,
                .error = convecting_error(finest, biot, 0.1, unused),
                .bar = 0.02});
  }
}

/// A slab of thickness 1 on a floor at the cold temperature, its top insulated: the series in odd quarter waves.
double slab_on_ground(double time, double y) {
  double sum = 0.0;
  for (int n = 0; n < 100; ++n) {
    const double z = (n + 0.5) * pi;
    sum += 2.0 / z * std::exp(-z * z * diffusivity * time) * std::sin(z * y);
  }
  return sum;
}

double ground_error(double spacing, double jitter, double& lost_error) {
  Slab slab = make_slab(spacing, jitter);
  const double specific_heat = 2.0;
  Solver<2, double> solver(slab.parameters, {warm_material(specific_heat)}, make_floor(cold),
                           std::move(slab.particles));
  solver.prepare();
  double time = 0.0, worst = 0.0;
  for (const double until : {0.01, 0.05, 0.2, 0.5}) {
    advance_by(solver, until - time, time);
    time = until;
    // Until 0.05 the top has not felt it: the half space's error function.
    worst =
        std::max(worst, profile_error(solver, [&](double y) {
                   return time < 0.03 ? std::erf(y / (2.0 * std::sqrt(diffusivity * time))) : slab_on_ground(time, y);
                 }));
  }
  double mean = 0.0;
  for (const double t : solver.particles().temperature) mean += t / static_cast<double>(solver.particles().size());
  lost_error = std::abs(solver.heat_ledger().to_walls / (density * specific_heat * slab.width * (hot - mean)) - 1.0);
  return worst;
}

TEST(Cooling, IntoTheGround) {
  const double finest = full_run() ? 1.0 / 80.0 : 1.0 / 40.0;
  std::vector<double> spacing, error;
  double lost = 0.0;
  for (const double coarser : {2.0, 1.0}) {
    spacing.push_back(coarser * finest);
    error.push_back(ground_error(spacing.back(), 0.0, lost));
  }
  const std::string problem = "cooling slab on cold ground";
  const std::string resolution = fmt::format("{:.0f} across", 1.0 / finest);
  report_row({.problem = problem,
              .quantity = "temperature / first difference; max; k t 0.01 to 0.5 thickness^2",
              .resolution = resolution,
              .error = error.back(),
              .bar = 0.02,
              .order = convergence_order(spacing, error)});
  report_row({.problem = problem,
              .quantity = "energy to the wall / enthalpy lost - 1",
              .resolution = resolution,
              .error = lost,
              .bar = 1e-6});
  double unused = 0.0;
  report_row({.problem = problem,
              .quantity = "temperature / first difference; max (jitter 0.1)",
              .resolution = resolution,
              .error = ground_error(finest, 0.1, unused),
              .bar = 0.02});
}

/// Time in which a lumped body, per area and heat capacity, cools by radiation alone from `from` to `to` [K] towards
/// `ambient`:
///   e sigma A/(m c) t = [ln((T + Ta)/(T - Ta)) + 2 atan(T/Ta)]/(4 Ta^3) between them.
double radiation_time(double rate, double ambient, double from, double to) {
  const auto primitive = [&](double t) {
    return (std::log((t + ambient) / (t - ambient)) + 2.0 * std::atan(t / ambient)) / (4.0 * std::pow(ambient, 3));
  };
  return (primitive(to) - primitive(from)) / rate;
}

// A drop of four spacings' radius that conducts so well that its temperature is one number, within Bi = 0.02.
TEST(Cooling, DropThatRadiates) {
  constexpr double spacing = 0.01, ambient = 300.0, start = 1200.0, specific_heat = 1000.0, emissivity = 0.9;
  Particles<3> p = make_ball<3>(4.0 * spacing, spacing, density, full_run() ? 0.1 : 0.0);
  const auto n = static_cast<double>(p.size());
  p.temperature.assign(p.size(), start);
  auto parameters = make_parameters<3>(spacing, 1e-6);
  parameters.ambient = Ambient{ambient, 0.0};
  Material m = warm_material(specific_heat);
  const double radius = spacing * std::cbrt(0.75 * n / pi);
  m.heat->emissivity = emissivity;
  // Bi = 4 e sigma T^3 R/conductivity at the start.
  m.heat->diffusivity =
      4.0 * emissivity * stefan_boltzmann * std::pow(start, 3) * radius / 0.02 / (density * specific_heat);
  Solver<3, float> solver(parameters, {m}, {}, std::move(p));
  solver.prepare();

  const double mass = n * solver.mass(0);
  const double rate = emissivity * stefan_boltzmann * 4.0 * pi * radius * radius / (mass * specific_heat);
  double worst = 0.0, time = 0.0;
  int steps = 0;
  for (const double target : {1000.0, 800.0, 600.0}) {
    const double until = radiation_time(rate, ambient, start, target);
    steps += advance_by(solver, until - time, time);
    time = until;
    const auto& t = solver.particles().temperature;
    worst = std::max(worst, std::abs(std::accumulate(t.begin(), t.end(), 0.0) / n / target - 1.0));
  }
  double held = 0.0;
  for (const double t : solver.particles().temperature) held += solver.mass(0) * specific_heat * (start - t);
  const std::string resolution = fmt::format("{:.0f} particles {} steps", n, steps);
  report_row({.problem = "drop that radiates; 1200 to 600 K",
              .quantity = "temperature / exact - 1",
              .resolution = resolution,
              .error = worst,
              .bar = 0.02});
  report_row({.problem = "drop that radiates; 1200 to 600 K",
              .quantity = "energy radiated / enthalpy lost - 1",
              .resolution = resolution,
              .error = std::abs(solver.heat_ledger().radiated / held - 1.0),
              .bar = 1e-6});
}

}  // namespace
}  // namespace smelt
