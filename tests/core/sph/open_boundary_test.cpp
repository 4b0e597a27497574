#include "core/sph/open_boundary.h"

#include "core/error.h"
#include "core/sph/diagnostics.h"
#include "core/sph/solver.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

namespace smelt {
namespace {

constexpr double spacing = 0.05;

Emitter<3> make_vent() {
  Emitter<3> e;
  e.position = Vec3(0.0, 1.0, 0.0);
  e.direction = Vec3(0.0, -1.0, 0.0);
  e.radius = 3.2 * spacing;
  e.flow_rate = 0.04;
  e.start = 0.1;
  e.end = 0.6;
  return e;
}

Material syrup() {
  Material m{"syrup", 1000.0, {}, std::nullopt};
  m.rheology.consistency = {20.0, 20.0};
  return m;
}

template <int Dim>
SolverParameters<Dim> make_parameters(double sound_speed = 10.0) {
  SolverParameters<Dim> p;
  p.particle_volume = std::pow(spacing, Dim);
  p.smoothing_length = 1.2 * spacing;
  p.sound_speed = sound_speed;
  p.shear_wave_speed = sound_speed;
  p.artificial_viscosity = 0.2;
  p.hourglass_control = 1.0;
  p.xsph = 0.3;
  return p;
}

/// Calls see(solver, time) after every step from `begin` to `end`, in frames of `frame` seconds.
template <int Dim, typename Real, typename See>
void run(Solver<Dim, Real>& solver, double begin, double end, double frame, const See& see) {
  for (int k = static_cast<int>(std::lround(begin / frame)); k < static_cast<int>(std::lround(end / frame)); ++k) {
    solver.prepare(k * frame);
    for (double remaining = frame; remaining > 0.0;) {
      const double time = k * frame + frame - remaining;
      const TimeStep step = solver.step(remaining, time);
      remaining -= step.dt;
      see(solver, time + step.dt);
    }
  }
}

const auto see_nothing = [](const auto&, double) {};

/// added - removed - present, in particles of each material; all of them zero is what mass conservation means.
template <int Dim, typename Real>
std::vector<std::int64_t> imbalance(const Solver<Dim, Real>& solver) {
  const ParticleAccount& account = solver.account();
  std::vector<std::int64_t> left = account.initial;
  for (std::size_t m = 0; m < left.size(); ++m) left[m] -= account.removed[m];
  for (std::size_t e = 0; e < account.entered.size(); ++e)
    left[solver.parameters().emitters[e].material] += account.entered[e];
  for (std::size_t i = 0; i < solver.particles().size(); ++i)
    --left[solver.particles().material.empty() ? 0 : solver.particles().material[i]];
  return left;
}

TEST(Emitter, LayersHaveTheFlowRateAndTheParticlesVolume) {
  const Emitter<3> e = make_vent();
  const EmitterLayers<3> layers = compute_emitter_layers<3>(e, std::pow(spacing, 3), 2.4 * spacing);
  const double volume = std::pow(spacing, 3);
  EXPECT_NEAR(static_cast<double>(layers.sites.size()) * volume / layers.period / e.flow_rate, 1.0, 1e-12);
  EXPECT_NEAR(layers.speed * layers.period / spacing, 1.0, 1e-12);
  EXPECT_NEAR(layers.depth / spacing, 3.0, 1e-12);
  EXPECT_NEAR(static_cast<double>(layers.sites.size()), M_PI * 3.2 * 3.2, 2.0);
  Vec3 sum = Vec3::Zero();
  for (const Vec3& s : layers.sites) {
    EXPECT_LE(s.norm(), e.radius);
    EXPECT_NEAR(s.dot(e.direction), 0.0, 1e-15);
    sum += s;
  }
  EXPECT_LT(sum.norm(), 1e-12) << "the section is symmetric";
  EXPECT_EQ(layers.n_particles, std::llround(0.04 * 0.5 / volume));
  EXPECT_EQ(count_entered<3>(e, layers, 10.0), layers.n_particles);
  EXPECT_EQ(count_entered<3>(e, layers, 0.1), 0);
}

// By layers of whole particles the flow rate can be met to half a layer at any time, not better.
TEST(Emitter, FlowRateIsMetToHalfALayerAtAnyTime) {
  const Emitter<3> e = make_vent();
  const double volume = std::pow(spacing, 3);
  const EmitterLayers<3> layers = compute_emitter_layers<3>(e, volume, 2.4 * spacing);
  double worst = 0.0;
  for (int k = 0; k <= 1000; ++k) {
    const double t = e.start + (e.end - e.start) * k / 1000.0;
    const double entered = static_cast<double>(count_entered<3>(e, layers, t)) * volume;
    worst = std::max(worst, std::abs(entered - e.flow_rate * (t - e.start)));
  }
  EXPECT_LE(worst, 0.5001 * static_cast<double>(layers.sites.size()) * volume);
  EXPECT_GE(worst, 0.4 * static_cast<double>(layers.sites.size()) * volume) << "the bar is not slack";
}

TEST(Emitter, RefusesWhatCannotPour) {
  const double volume = std::pow(spacing, 3);
  const auto error_of = [&](auto&& change) {
    Emitter<3> e = make_vent();
    change(e);
    try {
      compute_emitter_layers<3>(e, volume, 2.4 * spacing);
    } catch (const Error& error) {
      return std::string(error.what());
    }
    return std::string("none");
  };
  EXPECT_NE(error_of([](auto& e) { e.radius = 0.9 * spacing; }).find("narrower than two particles"), std::string::npos);
  EXPECT_NE(error_of([](auto& e) { e.flow_rate = 0.0; }).find("flow rate must be > 0"), std::string::npos);
  EXPECT_NE(error_of([](auto& e) { e.end = e.start; }).find("end after it starts"), std::string::npos);
  EXPECT_NE(error_of([](auto& e) { e.direction *= 2.0; }).find("unit vector"), std::string::npos);
  EXPECT_EQ(error_of([](auto&) {}), "none");
}

// Nothing acts on a jet in empty space: it must go on as the lattice that it came in as.
TEST(Emitter, FreeJetKeepsItsVelocityAndDensity) {
  auto parameters = make_parameters<3>();
  parameters.emitters = {make_vent()};
  Solver<3, float> solver(parameters, {syrup()}, {}, {});
  double worst_density = 0.0, worst_velocity = 0.0;
  run(solver, 0.0, 1.0, 0.05, [&](const auto& s, double) {
    for (std::size_t i = 0; i < s.particles().size(); ++i) {
      worst_density = std::max(worst_density, std::abs(s.particles().density[i] / 1000.0 - 1.0));
      worst_velocity =
          std::max(worst_velocity, (s.particles().velocity[i] - Vec3(0.0, s.particles().velocity[i][1], 0.0)).norm());
    }
  });
  const auto& p = solver.particles();
  const EmitterLayers<3> layers =
      compute_emitter_layers<3>(parameters.emitters[0], parameters.particle_volume, 2.4 * spacing);
  EXPECT_EQ(static_cast<std::int64_t>(p.size()), layers.n_particles);
  EXPECT_EQ(imbalance(solver), std::vector<std::int64_t>{0});
  EXPECT_LT(worst_density, 1e-4);
  EXPECT_LT(worst_velocity, 1e-3 * layers.speed);
  EXPECT_EQ(std::count(p.driven.begin(), p.driven.end(), 0), static_cast<std::ptrdiff_t>(p.size()))
      << "all have left the duct";
  for (std::size_t i = 0; i < p.size(); ++i) ASSERT_NEAR(p.velocity[i][1] / -layers.speed, 1.0, 1e-3);
}

/// A vat of syrup that a vent in its floor fills, 2D: walls of the solver, the vent soon covered.
struct Vat {
  static constexpr double half_width = 0.75;
  SolverParameters<2> parameters = make_parameters<2>(30.0);
  Colliders<2> colliders;

  explicit Vat(double flow_rate = 0.4) {
    parameters.gravity = Vec<2>(0.0, -9.81);
    Emitter<2> e;
    e.position = Vec<2>(0.0, 0.0);
    e.direction = Vec<2>(0.0, 1.0);
    e.radius = 4.0 * spacing;
    e.flow_rate = flow_rate;
    e.end = 10.0;
    parameters.emitters = {e};
    Obstacle<2> vat;
    vat.wall = true;
    const Vec<2> a(-half_width, 2.0), b(-half_width, 0.0), c(half_width, 0.0), d(half_width, 2.0);
    vat.facets = {{a, b}, {b, c}, {c, d}};
    colliders.add(std::move(vat));
  }
  Colliders<2> take_colliders() { return std::move(colliders); }
  double exit_height() const { return 3.0 * spacing; }
};

/// Between two slippery walls a vent pushes up a column of fluid: it moves as one, and its pressure is hydrostatic
/// while it grows.
struct Column {
  double pressure_error = 0.0, rms_error = 0.0;  ///< over rho g H
  double velocity_error = 0.0;                   ///< over the speed
};

Column push_up_a_column() {
  auto parameters = make_parameters<2>(60.0);
  parameters.gravity = Vec<2>(0.0, -9.81);
  Emitter<2> e;
  e.direction = Vec<2>(0.0, 1.0);
  e.radius = 4.0 * spacing;
  e.flow_rate = 0.4;
  e.end = 10.0;
  parameters.emitters = {e};
  Colliders<2> colliders;
  for (const double x : {-4.0 * spacing, 4.0 * spacing}) {
    Obstacle<2> side;
    side.wall = true;
    side.response.friction = 1.0;
    side.facets = {{Vec<2>(x, -1.0), Vec<2>(x, 4.0)}};
    colliders.add(std::move(side));
  }
  Solver<2, double> solver(parameters, {syrup()}, std::move(colliders), {});
  Column worst;
  double sum2 = 0.0;
  int n = 0;
  run(solver, 0.0, 1.0, 0.1, [&](const auto& s, double time) {
    if (time < 0.4) return;
    const auto& p = s.particles();
    const double top = time - spacing, per_head = 1.0 / (1000.0 * 9.81 * time);
    for (std::size_t i = 0; i < p.size(); ++i) {
      if (top - p.position[i][1] < 3.0 * spacing)
        continue;  // at the free surface the column's top is right to half a spacing only
      const double pressure = 3600.0 * (p.density[i] - 1000.0);
      const double error = std::abs(pressure - 1000.0 * 9.81 * (top - p.position[i][1])) * per_head;
      if (p.driven[i] == 0) {
        worst.pressure_error = std::max(worst.pressure_error, error);
        sum2 += error * error;
        ++n;
      }
      worst.velocity_error = std::max(worst.velocity_error, (p.velocity[i] - Vec<2>(0.0, 1.0)).norm());
    }
  });
  worst.rms_error = std::sqrt(sum2 / n);
  return worst;
}

TEST(Emitter, PushesUpAColumnAtHydrostaticPressure) {
  const Column worst = push_up_a_column();
  EXPECT_LT(worst.rms_error, 0.03);
  EXPECT_LT(worst.pressure_error, 0.1);
  EXPECT_LT(worst.velocity_error, 0.02);
}

/// Worst relative density error of free particles within six spacings of the vent.
double density_error_at_vent(const Particles<2>& p, const Vat& vat) {
  double worst = 0.0;
  for (std::size_t i = 0; i < p.size(); ++i)
    if (p.driven[i] == 0 && (p.position[i] - Vec<2>(0.0, vat.exit_height())).norm() < 6.0 * spacing)
      worst = std::max(worst, std::abs(p.density[i] / 1000.0 - 1.0));
  return worst;
}

TEST(Emitter, FillsAVatWithoutShocks) {
  Vat vat;
  Solver<2, double> solver(vat.parameters, {syrup()}, vat.take_colliders(), {});
  double worst = 0.0, highest = 0.0, across_duct = 1.0;
  run(solver, 0.0, 1.6, 0.1, [&](const auto& s, double) {
    const auto& p = s.particles();
    worst = std::max(worst, density_error_at_vent(p, vat));
    for (std::size_t i = 0; i < p.size(); ++i)
      if (p.driven[i] == 0 && p.position[i][1] < vat.exit_height() - spacing)
        across_duct = std::min(across_duct, std::abs(p.position[i][0]));
  });
  for (const auto& x : solver.particles().position) highest = std::max(highest, x[1]);
  EXPECT_LT(worst, 0.03);
  EXPECT_GT(across_duct, 4.0 * spacing - 0.5 * spacing) << "what comes back does not get into the duct";
  EXPECT_GT(highest, vat.exit_height() + 2.0 * spacing) << "the vent is covered";
  EXPECT_EQ(imbalance(solver), std::vector<std::int64_t>{0});
}

// The state at a frame and the account are all that a resume needs, in the middle of a layer too.
TEST(Emitter, ResumesInMidPourToTheSameBytes) {
  const auto make = [](Particles<2> particles, ParticleAccount account) {
    Vat vat;
    vat.parameters.outflows = {{{Vec<2>(0.3, -1.0), Vec<2>(1.0, 0.3)}, false}};
    return Solver<2, double>(vat.parameters, {syrup()}, vat.take_colliders(), std::move(particles), std::move(account));
  };
  constexpr double frame = 0.07;  // 1.4 layers
  auto whole = make({}, {});
  run(whole, 0.0, 14 * frame, frame, see_nothing);
  auto half = make({}, {});
  run(half, 0.0, 7 * frame, frame, see_nothing);
  auto rest = make(half.particles(), half.account());
  run(rest, 7 * frame, 14 * frame, frame, see_nothing);

  EXPECT_GT(whole.account().removed[0], 0) << "something flew out as well";
  EXPECT_EQ(rest.account().next_id, whole.account().next_id);
  EXPECT_EQ(rest.account().removed, whole.account().removed);
  std::vector<std::string> bytes[2];
  for (int k = 0; k < 2; ++k)
    for_each_array((k ? rest : whole).particles(), [&](const auto& values) {
      bytes[k].emplace_back(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(values[0]));
    });
  EXPECT_EQ(bytes[0], bytes[1]);
  EXPECT_EQ(imbalance(rest), std::vector<std::int64_t>{0});
}

TEST(Emitter, SameBytesOnOneAndTwoThreads) {
  std::vector<Vec3> positions[2];
  for (int k = 0; k < 2; ++k) {
    const tbb::global_control threads(tbb::global_control::max_allowed_parallelism, static_cast<std::size_t>(k + 1));
    auto parameters = make_parameters<3>();
    parameters.gravity = Vec3(0.0, -9.81, 0.0);
    Emitter<3> e = make_vent();
    e.flow_rate = 0.15;
    parameters.emitters = {e};
    parameters.outflows = {{{Vec3(-9.0, -9.0, -9.0), Vec3(9.0, 0.3, 9.0)}, false}};
    Solver<3, float> solver(parameters, {syrup()}, {}, {});
    run(solver, 0.0, 0.6, 0.1, see_nothing);
    positions[k] = solver.particles().position;
    EXPECT_GT(solver.particles().size(), 300u);
    EXPECT_GT(solver.account().removed[0], 100);
    EXPECT_EQ(imbalance(solver), std::vector<std::int64_t>{0});
  }
  EXPECT_EQ(positions[0], positions[1]);
}

// Two materials, each with its own account.
TEST(Outflow, CountsWhatItTakesOfEachMaterial) {
  auto parameters = make_parameters<3>();
  parameters.shear_wave_speed = 0.0;
  parameters.xsph = 0.0;
  parameters.outflows = {{{Vec3(-1.0, -1.0, -1.0), Vec3(1.0, 1.0, 1.0)}, true}};
  Particles<3> p;
  for (int k = 0; k < 10; ++k) {
    p.id.push_back(k);
    p.material.push_back(static_cast<std::uint8_t>(k % 2));
    p.position.push_back(Vec3(0.0, 0.0, 0.18 * k - 0.85));
    p.velocity.push_back(Vec3(0.0, 0.0, 1.0));
    p.density.push_back(k % 2 ? 500.0 : 1000.0);
  }
  Material water{"water", 1000.0, {}, std::nullopt}, oil{"oil", 500.0, {}, std::nullopt};
  water.rheology.consistency = oil.rheology.consistency = {0.0, 0.0};
  Solver<3, double> solver(parameters, {water, oil}, {}, p);
  run(solver, 0.0, 0.8, 0.2, see_nothing);
  // Those at z + 0.8 > 1: from k = 6 on.
  EXPECT_EQ(solver.particles().size(), 6u);
  EXPECT_EQ(solver.account().removed, (std::vector<std::int64_t>{2, 2}));
  EXPECT_EQ(imbalance(solver), (std::vector<std::int64_t>{0, 0}));
  std::set<std::int32_t> ids(solver.particles().id.begin(), solver.particles().id.end());
  EXPECT_EQ(ids, (std::set<std::int32_t>{0, 1, 2, 3, 4, 5}));
}

TEST(Emitter, PoursForEverWithoutAnEnd) {
  Emitter<3> emitter;
  emitter.radius = 0.05;
  emitter.flow_rate = 1e-3;
  emitter.end = std::numeric_limits<double>::infinity();
  const auto layers = compute_emitter_layers<3>(emitter, 1e-6, 0.024);
  EXPECT_NEAR(static_cast<double>(count_entered(emitter, layers, 100.0)), 1e5,
              static_cast<double>(layers.sites.size()));
  emitter.end = 1e20;  // more particles than can be counted
  EXPECT_GT(compute_emitter_layers<3>(emitter, 1e-6, 0.024).n_particles, std::int64_t{1} << 60);
}

// Water behind a gate: it stays while the gate stands, and flows when it has gone.
TEST(Gate, HoldsUntilItVanishes) {
  auto parameters = make_parameters<2>(20.0);
  parameters.gravity = Vec<2>(0.0, -9.81);
  Colliders<2> colliders;
  Obstacle<2> vat, gate;
  vat.wall = gate.wall = true;
  vat.facets = {{Vec<2>(0.0, 2.0), Vec<2>(0.0, 0.0)}, {Vec<2>(0.0, 0.0), Vec<2>(4.0, 0.0)}};
  gate.facets = {{Vec<2>(0.5, 0.0), Vec<2>(0.5, 2.0)}};
  gate.until = 0.4;
  colliders.add(std::move(vat));
  colliders.add(std::move(gate));
  Particles<2> p;
  for (int j = 0; j < 10; ++j)
    for (int i = 0; i < 10; ++i) {
      p.id.push_back(static_cast<std::int32_t>(p.id.size()));
      p.position.push_back(spacing * Vec<2>(i + 0.5, j + 0.5));
      p.velocity.push_back(Vec<2>::Zero());
      p.density.push_back(1000.0 * (1.0 + 9.81 * (0.5 - p.position.back()[1]) / 400.0));
    }
  Material thin = syrup();
  thin.rheology.consistency = {2.0, 2.0};
  Solver<2, double> solver(parameters, {thin}, std::move(colliders), std::move(p));
  double reached_before = 0.0, reached_after = 0.0;
  run(solver, 0.0, 0.8, 0.1, [&](const auto& s, double time) {
    for (const auto& x : s.particles().position) {
      double& reached = time < 0.4 ? reached_before : reached_after;
      reached = std::max(reached, x[0]);
    }
  });
  EXPECT_LT(reached_before, 0.5) << "nothing passes a gate that stands";
  EXPECT_GT(reached_after, 1.0) << "the reservoir empties";
}

}  // namespace
}  // namespace smelt
