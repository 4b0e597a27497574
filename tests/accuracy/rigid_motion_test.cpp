// A stiff blob in rigid motion: no viscous force, surface included, and a spin that lasts.

#include "bench/cases/rigid_rotation.h"
#include "core/sph/kernel.h"
#include "core/sph/rheology.h"
#include "core/sph/stress_update.h"
#include "tests/accuracy/measure.h"

#include <Eigen/Geometry>
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

namespace smelt {
namespace {

using namespace rigid_rotation;

constexpr int across = 6;  // spacings from the centre to the surface

template <int Dim>
Particles<Dim> make_blob(double radius, double jitter, double rate, double translation) {
  Particles<Dim> p = make_ball<Dim>(radius, spacing, density, jitter);
  for (std::size_t i = 0; i < p.size(); ++i)
    p.velocity[i] = spin_velocity<Dim>(p.position[i], rate) + Vec<Dim>::Constant(translation);
  return p;
}

/// Largest acceleration, over that of the full rest viscosity against the motion, eta0 rate / (rho h^2).
template <int Dim>
double largest_over_scale(const std::vector<Vec<Dim>>& acceleration, double rate) {
  const double eta0 = flow_curve_at(stiff_material().rheology, 0.0).rest_viscosity;
  const double h = 1.2 * spacing;
  double largest = 0.0;
  for (const auto& a : acceleration) largest = std::max(largest, a.norm());
  return largest * density * h * h / (eta0 * rate);
}

/// The viscous force of [P 4-45, 4-46] as they stand: velocity gradient and force from bare sums. Pair by pair from the
/// text.
template <int Dim>
std::vector<Vec<Dim>> bare_viscous_force(const Solver<Dim, double>& solver) {
  const auto& p = solver.particles();
  const Kernel<Dim> kernel(solver.parameters().smoothing_length);
  const FlowCurve curve = flow_curve_at(stiff_material().rheology, 0.0);
  const auto grad_w = [&](std::size_t i, std::size_t j) {
    const Vec<Dim> x_ij = p.position[i] - p.position[j];
    return Vec<Dim>(kernel.derivative(x_ij.norm()) / x_ij.norm() * x_ij);
  };
  std::vector<Mat<Dim>> stress(p.size(), Mat<Dim>::Zero());
  for (std::size_t i = 0; i < p.size(); ++i) {
    Mat<Dim> gradient = Mat<Dim>::Zero();
    for (const std::int32_t j : solver.neighbours().row(i))
      gradient += solver.mass(j) / p.density[j] * (p.velocity[j] - p.velocity[i]) * grad_w(i, j).transpose();
    const Mat<Dim> strain_rate = gradient + gradient.transpose();
    stress[i] = viscosity(curve, std::sqrt(0.5 * strain_rate.squaredNorm())) * strain_rate;
  }
  std::vector<Vec<Dim>> force(p.size(), Vec<Dim>::Zero());
  for (std::size_t i = 0; i < p.size(); ++i)
    for (const std::int32_t j : solver.neighbours().row(i))
      force[i] += solver.mass(j) / (p.density[i] * p.density[j]) * (stress[i] + stress[j]) * grad_w(i, j);
  return force;
}

/// The force right after `prepare`, where the stress follows the strain rate at once and the density is at rest:
/// viscous and no more.
template <int Dim>
void report_force() {
  constexpr double rate = 1.3;
  const std::string resolution = fmt::format("radius {} spacings (jitter 0.2)", across);
  const auto report = [&](const char* motion, double spin, double translation) {
    Solver<Dim, double> solver(make_parameters<Dim>(spacing, sound_speed), {stiff_material()}, {},
                               make_blob<Dim>(across * spacing, 0.2, spin, translation));
    solver.prepare();
    std::vector<Vec<Dim>> acceleration;
    for (std::size_t i = 0; i < solver.particles().size(); ++i) acceleration.push_back(solver.acceleration(i));
    const std::string problem = fmt::format("rigid {} in {}D; J = 1000", motion, Dim);
    report_row({.problem = problem,
                .quantity = "viscous force / (eta0 rate / (rho h^2))",
                .resolution = resolution,
                .error = largest_over_scale<Dim>(acceleration, rate),
                .bar = 1e-13});
    return largest_over_scale<Dim>(bare_viscous_force<Dim>(solver), rate);
  };
  report("translation", 0.0, 2.0);
  const double bare = report("rotation", rate, 0.7);
  report_row({.problem = fmt::format("rigid rotation in {}D; J = 1000", Dim),
              .quantity = "the same with the bare gradient of [P 4-45]",
              .resolution = resolution,
              .error = bare});
  EXPECT_GT(bare, 1e-4) << "the correction is not needed here: the row above shows nothing";
}

TEST(RigidMotion, NoViscousForceIn2D) {
  report_force<2>();
}
TEST(RigidMotion, NoViscousForceIn3D) {
  report_force<3>();
}

/// One whole turn of a free body with the relaxed stress, its rim (`radius` from the origin [m]) at 2 % of the speed of
/// sound.
template <int Dim>
void report_turn(const std::string& body, Particles<Dim> particles, double radius) {
  Solver<Dim, double> solver = make_spinning<Dim>(std::move(particles), radius);
  solver.prepare();
  const double before = angular_velocity<Dim>(solver), momentum = angular_momentum<Dim>(solver);
  // The marker at the rim says that it did turn, and once.
  const auto position_of = [&](std::int32_t id) {
    const auto& ids = solver.particles().id;
    return Vec<Dim>(solver.particles().position[std::find(ids.begin(), ids.end(), id) - ids.begin()]);
  };
  const Vec<Dim> marker = position_of(0);
  const double turn = 2.0 * std::numbers::pi / rate_of(radius);
  const int steps = advance_by(solver, 0.5 * turn);
  EXPECT_LT((position_of(0).template head<2>() + marker.template head<2>()).norm(), 0.05 * radius) << "half a turn";
  advance_by(solver, 0.5 * turn, 0.5 * turn);
  EXPECT_LT((position_of(0) - marker).norm(), 0.05 * radius) << "a whole turn";

  const std::string problem = fmt::format("free spinning {}; J = 1000", body);
  const std::string resolution = fmt::format("radius {:.0f} spacings {} steps", radius / spacing, 2 * steps);
  report_row({.problem = problem,
              .quantity = "angular velocity after a turn / start - 1",
              .resolution = resolution,
              .error = std::abs(angular_velocity<Dim>(solver) / before - 1.0),
              .bar = 0.01});
  report_row({.problem = problem,
              .quantity = "angular momentum after a turn / start - 1",
              .resolution = resolution,
              .error = std::abs(angular_momentum<Dim>(solver) / momentum - 1.0)});
}

TEST(RigidMotion, DiscTurns) {
  const double radius = spacing * (full_run() ? 12 : 6);
  report_turn<2>("disc", make_ball<2>(radius, spacing, density), radius);
}

TEST(RigidMotion, BallTurns) {
  const double radius = spacing * (full_run() ? 6 : 4);
  report_turn<3>("ball", make_ball<3>(radius, spacing, density), radius);
}

// The pull on a bar turns with it; in a disc it is the same in every direction and a stress that stayed behind would
// not show.
TEST(RigidMotion, BarTurns) {
  const double length = spacing * (full_run() ? 24 : 12);
  const Vec<2> half(0.5 * length, length / 6.0);
  report_turn<2>("bar 3 to 1", make_block<2>({-half, half}, spacing, density), half.norm());
}

// At these spins the spring would hide a stress that stays behind: it takes no more strain than stress/G to make up for
// it. So the stress by itself: carried through a turn about an oblique axis, its own dashpot frozen, it must be where
// it was.
TEST(RigidMotion, StressTurnsWithTheMaterial) {
  const Vec3 spin = Vec3(0.3, -1.1, 0.7);
  Mat3 gradient;
  gradient << 0.0, -spin[2], spin[1], spin[2], 0.0, -spin[0], -spin[1], spin[0], 0.0;
  Mat3 pull;
  pull << 300.0, 50.0, -20.0, 50.0, -200.0, 80.0, -20.0, 80.0, -100.0;
  const FlowCurve frozen{1e9, 1.0, 1.0, 1e15};
  const double turn = 2.0 * std::numbers::pi / spin.norm();
  std::vector<double> step, error;
  for (const int n : {200, 400, 800}) {
    StressState<3> state{to_symmetric<3>(pull), 1e15};
    for (int k = 0; k < n; ++k) {
      state = relaxed_stress<3>(frozen, 1e5, turn / n, gradient, state);
      if (k == n / 2) {
        EXPECT_GT((to_matrix<3>(state.stress) - pull).norm() / pull.norm(), 0.5) << "it did not turn";
      }
    }
    step.push_back(turn / n);
    error.push_back((to_matrix<3>(state.stress) - pull).norm() / pull.norm());
  }
  report_row({.problem = "stress of a rigid turn in 3D",
              .quantity = "stress after a turn - start / magnitude",
              .resolution = "800 steps a turn",
              .error = error.back(),
              .bar = 1e-4,
              .order = convergence_order(step, error),
              .least_order = 1.9});
}

}  // namespace
}  // namespace smelt
