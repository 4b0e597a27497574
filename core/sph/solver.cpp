#include "core/sph/solver.h"

#include "core/error.h"
#include "core/parallel.h"
#include "core/sph/gradient_correction.h"
#include "core/sph/kernel.h"
#include "core/sph/stress_update.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace smelt {

namespace {

template <typename T>
void reorder(std::vector<T>& values, const std::vector<std::int32_t>& order) {
  if (values.empty()) return;
  std::vector<T> sorted(values.size());
  parallel_for_each(values.size(), [&](std::size_t i) { sorted[i] = values[order[i]]; });
  values.swap(sorted);
}

bool inviscid(const Rheology& r) {
  return r.yield_stress.cold == 0.0 && r.yield_stress.hot == 0.0 && r.consistency.cold == 0.0 && r.consistency.hot == 0.0;
}

/// Radius of the sphere (disc, segment) of a particle's volume  [P 5-11].
template <int Dim>
double particle_radius(double volume) {
  constexpr double pi = std::numbers::pi;
  return Dim == 3 ? std::cbrt(0.75 * volume / pi) : Dim == 2 ? std::sqrt(volume / pi) : 0.5 * volume;
}

}  // namespace

template <int Dim, typename Real>
Solver<Dim, Real>::Solver(const SolverParameters<Dim>& parameters, std::vector<Material> materials, Colliders<Dim> colliders,
                          Particles<Dim> particles)
    : parameters_(parameters),
      materials_(std::move(materials)),
      colliders_(std::move(colliders)),
      particles_(std::move(particles)) {
  const std::size_t n = particles_.size();
  if (n == 0) fail("simulation: there are no particles");
  terms_.gas = parameters_.equation_of_state.law == PressureLaw::ideal_gas;
  if (!(parameters_.particle_volume > 0.0) || !(parameters_.smoothing_length > 0.0) || !(parameters_.sound_speed > 0.0 || terms_.gas))
    fail("simulation: particle volume, smoothing length and sound speed must be > 0, are {}, {}, {}",
         parameters_.particle_volume, parameters_.smoothing_length, parameters_.sound_speed);
  CHECK_EQ(particles_.density.size(), n);
  terms_.pair.kernel = parameters_.kernel;
  for (const Material& m : materials_) {
    if (!inviscid(m.rheology)) terms_.pair.stress = true;
    if (m.heat) terms_.pair.heat = true;
  }
  terms_.pair.xsph = parameters_.xsph > 0.0;
  for (int a = 0; a < Dim; ++a) terms_.periodic = terms_.periodic || is_periodic(parameters_.period, a);
  check_period<Dim>(parameters_.period, list_reach());
  terms_.relaxed = terms_.pair.stress && parameters_.shear_wave_speed > 0.0;
  CHECK_EQ(particles_.temperature.size(), terms_.pair.heat ? n : 0);
  if (terms_.pair.stress) {
    particles_.stress.resize(n, Symmetric<Dim>::Zero());
    particles_.viscosity.resize(n, 0.0F);
  }
  CHECK_EQ(particles_.internal_energy.size(), terms_.gas ? n : 0);
  if (terms_.gas && (terms_.pair.stress || terms_.pair.heat)) fail("simulation: an ideal gas has no viscosity and conducts no heat");
  if (terms_.gas && !(parameters_.equation_of_state.adiabatic_index > 1.0))
    fail("simulation: the adiabatic index must be > 1, is {}", parameters_.equation_of_state.adiabatic_index);
  if (!terms_.gas && parameters_.quadratic_artificial_viscosity != 0.0)
    fail("simulation: quadratic artificial viscosity is for an ideal gas; shocks in liquids are weak");
  if (terms_.gas) energy_rate_.resize(n);
  acceleration_.resize(n, Vec<Dim>::Zero());
  force_sums_.resize(n);
  rates_.resize(n);
  if (terms_.pair.xsph) transport_.resize(n);
  if (terms_.pair.xsph) xsph_.resize(n, Vec<Dim>::Zero());
}

// ---------------------------------------------------------------------------------------------------------- the algorithm

template <int Dim, typename Real>
void Solver<Dim, Real>::prepare() {
  search_neighbours();
  pack_motion(particles_.velocity);
  sum_densities();
  evaluate_rates();
  integrate_rates(0.0);
  evaluate_forces();
}

template <int Dim, typename Real>
TimeStep Solver<Dim, Real>::step(double remaining, double time) {
  const TimeStep limit = compute_time_step(time_step_input(), parameters_.courant);
  if (!(limit.dt >= parameters_.min_time_step))
    throw DivergedError(fmt::format(
        "the time step collapsed to {:.3g} s (floor {:.3g} s) at t = {:.6g} s, limited by the {} term; lower the {} or raise "
        "[time_step] min_s",
        limit.dt, parameters_.min_time_step, time, time_step_term_names[static_cast<std::size_t>(limit.term)],
        limit.term == TimeStepTerm::viscous ? "viscosity" : "sound speed"));
  const TimeStep step = fit_to_frame(limit, remaining);
  const double dt = step.dt;

  // Leap-frog: half a kick, a whole drift, half a kick.
  kick(0.5 * dt);
  drift(dt);

  if (2.0 * travelled_ > parameters_.skin * parameters_.smoothing_length) search_neighbours();

  // Density, heat and stress change with the velocity that moved the particles.
  pack_motion(terms_.pair.xsph ? transport_ : particles_.velocity);
  sum_densities();
  evaluate_rates();
  integrate_rates(dt);
  evaluate_forces();
  kick(0.5 * dt);

  check_state(time + dt);
  return step;
}

// ------------------------------------------------------------------------------------------------------------- neighbours

template <int Dim, typename Real>
void Solver<Dim, Real>::search_neighbours() {
  const double radius = list_reach();
  if (terms_.periodic) wrap_positions<Dim>(parameters_.period, particles_.position);
  const auto order = compute_cell_order<Dim>(particles_.position, particles_.id, radius);
  for_each_array(particles_, [&](auto& values) { reorder(values, order); });
  reorder(transport_, order);
  if (terms_.gas) {
    // The rates of the last step look half a kick ahead (pack_gas).
    reorder(acceleration_, order);
    reorder(energy_rate_, order);
  }
  if (terms_.periodic)
    images_ = build_periodic_neighbour_lists<Dim>(parameters_.period, particles_.position, particles_.id, radius, pair_lanes<Real>, lists_);
  else
    build_neighbour_lists<Dim>(particles_.position, radius, radius, pair_lanes<Real>, lists_);
  // The middle of the particles: what single precision resolves there is relative to their extent.
  Box<Dim> bounds;
  for (const auto& x : particles_.position) bounds.extend(x);
  origin_ = bounds.centre();
  travelled_ = 0.0;
}

// ------------------------------------------------------------------------------------------- fields for the pair loops

template <int Dim, typename Real>
void Solver<Dim, Real>::pack_motion(const std::vector<Vec<Dim>>& velocity) {
  using Fields = PairFields<Dim, Real>;
  const std::size_t n = particles_.size();
  const std::size_t n_records = n + images_.size();
  fields_.motion.resize(n_records * Fields::motion_stride);
  if (terms_.pair.heat) fields_.temperature.resize(n_records);
  const double reference = materials_.front().heat ? materials_.front().heat->cold : 0.0;
  parallel_for_each(n, [&](std::size_t i) {
    Real* record = fields_.motion.data() + i * Fields::motion_stride;
    const Vec<Dim> x = particles_.position[i] - origin_;
    for (int a = 0; a < Dim; ++a) record[a] = static_cast<Real>(x[a]);
    for (int a = 0; a < Dim; ++a) record[Fields::velocity_at + a] = static_cast<Real>(velocity[i][a]);
    record[Fields::volume_at] = static_cast<Real>(mass(i) / particles_.density[i]);
    record[Fields::density_at] = static_cast<Real>(particles_.density[i]);
    // Relative to the melting range, where single precision is needed most.
    if (terms_.pair.heat) fields_.temperature[i] = static_cast<Real>(particles_.temperature[i] - reference);
  });
  copy_motion_to_images();
}

template <int Dim, typename Real>
void Solver<Dim, Real>::copy_motion_to_images() {
  using Fields = PairFields<Dim, Real>;
  const std::size_t n = particles_.size();
  parallel_for_each(images_.size(), [&](std::size_t k) {
    const std::size_t source = images_.source[k];
    Real* record = fields_.motion.data() + (n + k) * Fields::motion_stride;
    std::copy_n(fields_.motion.data() + source * Fields::motion_stride, Fields::motion_stride, record);
    // From the state, as its source's: shifting the rounded record would round it twice.
    const Vec<Dim> x = particles_.position[source] + images_.shift[k] - origin_;
    for (int a = 0; a < Dim; ++a) record[a] = static_cast<Real>(x[a]);
    if (terms_.pair.heat) fields_.temperature[n + k] = fields_.temperature[source];
  });
}

/// The records of the force pass, from the state after its rates were integrated.
template <int Dim, typename Real>
void Solver<Dim, Real>::pack_forces(std::size_t i, const Mat<Dim>& corrected_stress) {
  using Fields = PairFields<Dim, Real>;
  Real* motion = fields_.motion.data() + i * Fields::motion_stride;
  const double rho = particles_.density[i];
  for (int a = 0; a < Dim; ++a) motion[Fields::velocity_at + a] = static_cast<Real>(particles_.velocity[i][a]);
  motion[Fields::volume_at] = static_cast<Real>(mass(i) / rho);
  motion[Fields::density_at] = static_cast<Real>(rho);

  Real* force = fields_.force.data() + i * Fields::force_stride(terms_.pair.stress);
  const double pressure = compute_pressure(parameters_.equation_of_state, parameters_.sound_speed, material(i).density, rho, 0.0);
  force[0] = static_cast<Real>(pressure / (rho * rho));
  if (terms_.pair.stress)
    for (int a = 0; a < Dim; ++a)
      for (int b = 0; b < Dim; ++b) force[1 + a * Dim + b] = static_cast<Real>(corrected_stress(a, b));
}

/// The same for an ideal gas after a step of dt. Its forces depend on energy and velocity, so both are wanted at the step's end: half a
/// kick ahead, by the rates of the step before. What particles lose as kinetic energy they then gain as heat to second order in dt.
template <int Dim, typename Real>
void Solver<Dim, Real>::pack_gas(std::size_t i, double dt) {
  using Fields = PairFields<Dim, Real>;
  const double ahead = 0.5 * dt;
  const Vec<Dim> velocity = particles_.velocity[i] + ahead * acceleration_[i];
  const double e = particles_.internal_energy[i] + ahead * energy_rate_[i];
  const double rho = particles_.density[i];
  Real* motion = fields_.motion.data() + i * Fields::motion_stride;
  for (int a = 0; a < Dim; ++a) motion[Fields::velocity_at + a] = static_cast<Real>(velocity[a]);
  motion[Fields::volume_at] = static_cast<Real>(mass(i) / rho);
  motion[Fields::density_at] = static_cast<Real>(rho);
  Real* force = fields_.force.data() + i * Fields::force_stride(false);
  const EquationOfState& state = parameters_.equation_of_state;
  force[0] = static_cast<Real>(compute_pressure(state, 0.0, 1.0, rho, e) / (rho * rho));
  force[1] = static_cast<Real>(compute_sound_speed(state, 0.0, 1.0, rho, e));
}

template <int Dim, typename Real>
void Solver<Dim, Real>::copy_forces_to_images() {
  copy_motion_to_images();
  const std::size_t n = particles_.size();
  const int stride = PairFields<Dim, Real>::force_stride(terms_.pair.stress);
  parallel_for_each(images_.size(), [&](std::size_t k) {
    std::copy_n(fields_.force.data() + images_.source[k] * stride, stride, fields_.force.data() + (n + k) * stride);
  });
}

// ------------------------------------------------------------------------------------------------------ rates and forces

/// Where density is a sum, it follows from the positions alone.
template <int Dim, typename Real>
void Solver<Dim, Real>::sum_densities() {
  if (parameters_.density == DensityForm::continuity) return;
  set_summed_densities(false);
  // [S 4.20] has V_j from the densities of the step before. Evenly compressed, those would come out again, and nothing would resist:
  // the volumes follow from the plain sums instead.
  if (parameters_.density == DensityForm::normalised_summation) set_summed_densities(true);
}

template <int Dim, typename Real>
void Solver<Dim, Real>::set_summed_densities(bool normalise) {
  using Fields = PairFields<Dim, Real>;
  const std::size_t n = particles_.size();
  density_sums_.resize(n);
  parallel_blocks(n, [&](std::size_t begin, std::size_t end) {
    compute_density_sums<Dim, Real>(fields_, lists_, parameters_.kernel, parameters_.smoothing_length, begin, end, density_sums_.data());
  });
  parallel_for_each(n, [&](std::size_t i) {
    const DensitySums<Real>& sums = density_sums_[i];
    const double rho = normalise ? static_cast<double>(sums.mass) / sums.volume : sums.mass;
    particles_.density[i] = rho;
    Real* record = fields_.motion.data() + i * Fields::motion_stride;
    record[Fields::volume_at] = static_cast<Real>(mass(i) / rho);
    record[Fields::density_at] = static_cast<Real>(rho);
  });
  copy_motion_to_images();
}

template <int Dim, typename Real>
void Solver<Dim, Real>::evaluate_rates() {
  parallel_blocks(particles_.size(), [&](std::size_t begin, std::size_t end) {
    compute_rate_sums<Dim, Real>(fields_, lists_, terms_.pair, parameters_.smoothing_length, begin, end, rates_.data());
  });
}

/// With dt = 0 nothing advances, but the stress of a law without memory and the XSPH correction follow from the state.
template <int Dim, typename Real>
void Solver<Dim, Real>::integrate_rates(double dt) {
  fields_.force.resize((particles_.size() + images_.size()) * PairFields<Dim, Real>::force_stride(terms_.pair.stress));
  parallel_for_each(particles_.size(), [&](std::size_t i) {
    const RateSums<Dim, Real>& rate = rates_[i];
    const Material& m = material(i);
    // rho c_p dT/dt = div(c_p rho0 k grad T): the factor rho0/rho makes the exchange symmetric, so that sum m T is kept.
    if (m.heat) particles_.temperature[i] += dt * m.heat->diffusivity * m.density / particles_.density[i] * rate.heat;
    Mat<Dim> corrected_stress = Mat<Dim>::Zero();
    if (terms_.pair.stress) corrected_stress = integrate_stress(i, dt);
    if (parameters_.density == DensityForm::continuity) particles_.density[i] += dt * rate.density_rate;
    if (terms_.pair.xsph)
      for (int a = 0; a < Dim; ++a) xsph_[i][a] = parameters_.xsph * rate.xsph[a];
    if (terms_.gas)
      pack_gas(i, dt);
    else
      pack_forces(i, corrected_stress);
  });
  copy_forces_to_images();
}

/// Advances the extra stress S and returns S L for the force pass.
template <int Dim, typename Real>
Mat<Dim> Solver<Dim, Real>::integrate_stress(std::size_t i, double dt) {
  Symmetric<Dim> moment;
  for (int k = 0; k < n_symmetric<Dim>; ++k) moment[k] = rates_[i].position_moment[k];
  const Mat<Dim> correction = compute_gradient_correction<Dim>(to_matrix<Dim>(moment));
  if (!terms_.relaxed || dt > 0.0) {
    Mat<Dim> bare_gradient;
    for (int a = 0; a < Dim; ++a)
      for (int b = 0; b < Dim; ++b) bare_gradient(a, b) = rates_[i].velocity_moment[a * Dim + b];
    const Mat<Dim> gradient = bare_gradient * correction;

    const Material& m = material(i);
    const double u = m.heat ? melted_fraction(*m.heat, particles_.temperature[i]) : 0.0;
    const FlowCurve curve = flow_curve_at(m.rheology, u);
    const double modulus = m.density * parameters_.shear_wave_speed * parameters_.shear_wave_speed;
    const StressState<Dim> before{particles_.stress[i], particles_.viscosity[i]};
    const StressState<Dim> after = terms_.relaxed ? relaxed_stress<Dim>(curve, modulus, dt, gradient, before)
                                                  : instant_stress<Dim>(curve, gradient);
    particles_.stress[i] = after.stress;
    particles_.viscosity[i] = static_cast<float>(after.viscosity);
  }
  return to_matrix<Dim>(particles_.stress[i]) * correction;
}

template <int Dim, typename Real>
void Solver<Dim, Real>::evaluate_forces() {
  const ForceParameters force{parameters_.smoothing_length, parameters_.artificial_viscosity, parameters_.sound_speed};
  const GasForceParameters gas{parameters_.smoothing_length, parameters_.artificial_viscosity, parameters_.quadratic_artificial_viscosity};
  parallel_blocks(particles_.size(), [&](std::size_t begin, std::size_t end) {
    if (terms_.gas)
      compute_gas_force_sums<Dim, Real>(fields_, lists_, terms_.pair.kernel, gas, begin, end, force_sums_.data(), energy_rate_.data());
    else
      compute_force_sums<Dim, Real>(fields_, lists_, terms_.pair, force, begin, end, force_sums_.data());
    for (std::size_t i = begin; i < end; ++i)
      for (int a = 0; a < Dim; ++a) acceleration_[i][a] = force_sums_[i][a] + parameters_.gravity[a];
  });
}

// -------------------------------------------------------------------------------------------------------------- leap-frog

template <int Dim, typename Real>
void Solver<Dim, Real>::kick(double dt) {
  parallel_for_each(particles_.size(), [&](std::size_t i) { particles_.velocity[i] += dt * acceleration_[i]; });
  if (terms_.gas)
    parallel_for_each(particles_.size(), [&](std::size_t i) { particles_.internal_energy[i] += dt * energy_rate_[i]; });
}

template <int Dim, typename Real>
void Solver<Dim, Real>::drift(double dt) {
  const double radius = particle_radius<Dim>(parameters_.particle_volume);
  const double farthest = deterministic_reduce(
      particles_.size(), 0.0,
      [&](std::size_t i) {
        Vec<Dim>& velocity = particles_.velocity[i];
        // XSPH moves particles with a smoothed velocity and leaves the velocity itself alone  [Monaghan 1989].
        Vec<Dim> transport = velocity;
        if (terms_.pair.xsph) transport += xsph_[i];
        const Vec<Dim> before = particles_.position[i];
        if (colliders_.empty())
          particles_.position[i] += dt * transport;
        else
          colliders_.move_sphere(radius, dt, particles_.position[i], transport, velocity);
        if (terms_.pair.xsph) transport_[i] = transport;
        return (particles_.position[i] - before).norm();
      },
      [](double a, double b) { return std::max(a, b); });
  travelled_ += farthest;
}

/// Largest sound speed of any particle [m/s].
template <int Dim, typename Real>
double Solver<Dim, Real>::fastest_sound() const {
  const EquationOfState& state = parameters_.equation_of_state;
  if (state.law == PressureLaw::linear) return parameters_.sound_speed;
  return deterministic_reduce(
      particles_.size(), 0.0,
      [&](std::size_t i) {
        return compute_sound_speed(state, parameters_.sound_speed, material(i).density, particles_.density[i], internal_energy(i));
      },
      [](double a, double b) { return std::max(a, b); });
}

template <int Dim, typename Real>
TimeStepInput Solver<Dim, Real>::time_step_input() const {
  TimeStepInput input;
  input.smoothing_length = parameters_.smoothing_length;
  const double c = fastest_sound();
  const double shear = terms_.relaxed ? parameters_.shear_wave_speed : 0.0;
  input.wave_speed = std::sqrt(c * c + 4.0 / 3.0 * shear * shear);
  struct Extremes {
    double speed2 = 0.0, acceleration2 = 0.0, viscosity = 0.0;
  };
  const bool limited_by_viscosity = terms_.pair.stress && !terms_.relaxed;
  const Extremes extremes = deterministic_reduce(
      particles_.size(), Extremes{},
      [&](std::size_t i) {
        const double nu = limited_by_viscosity ? particles_.viscosity[i] / particles_.density[i] : 0.0;
        return Extremes{particles_.velocity[i].squaredNorm(), acceleration_[i].squaredNorm(), nu};
      },
      [](const Extremes& a, const Extremes& b) {
        return Extremes{std::max(a.speed2, b.speed2), std::max(a.acceleration2, b.acceleration2),
                        std::max(a.viscosity, b.viscosity)};
      });
  input.max_speed = std::sqrt(extremes.speed2);
  input.max_acceleration = std::sqrt(extremes.acceleration2);
  input.max_kinematic_viscosity = extremes.viscosity;
  for (const Material& m : materials_)
    if (m.heat) input.max_diffusivity = std::max(input.max_diffusivity, m.heat->diffusivity);
  return input;
}

// ------------------------------------------------------------------------------------------------------------- watchfulness

template <int Dim, typename Real>
void Solver<Dim, Real>::check_state(double time) const {
  const auto& p = particles_;
  const Box<Dim>& domain = parameters_.domain;
  const bool bounded = !domain.empty();
  const auto broken_term = [&](std::size_t i) -> const char* {
    const double relative_density = p.density[i] / material(i).density;
    // A gas has no density at rest; a liquid has no business far from it.
    if (!(terms_.gas ? relative_density > 0.0 && std::isfinite(relative_density) : relative_density > 0.1 && relative_density < 10.0))
      return "the density";
    if (terms_.gas && !(p.internal_energy[i] > 0.0 && std::isfinite(p.internal_energy[i]))) return "the internal energy";
    if (terms_.pair.heat && !(p.temperature[i] >= 0.0 && std::isfinite(p.temperature[i]))) return "the temperature (heat equation)";
    if (terms_.pair.stress && !p.stress[i].allFinite()) return "the extra stress (rheology)";
    if (!acceleration_[i].allFinite()) return "the acceleration (pressure and stress forces)";
    if (!p.velocity[i].allFinite() || !p.position[i].allFinite()) return "the velocity (leap-frog)";
    if (bounded && ((p.position[i] - domain.lower).array() < 0.0 || (domain.upper - p.position[i]).array() < 0.0).any())
      return "the position (it left the domain)";
    return nullptr;
  };
  constexpr std::int32_t none = std::numeric_limits<std::int32_t>::max();
  const std::int32_t first = deterministic_reduce(
      p.size(), none, [&](std::size_t i) { return broken_term(i) ? static_cast<std::int32_t>(i) : none; },
      [](std::int32_t a, std::int32_t b) { return std::min(a, b); });
  if (first == none) return;
  const auto i = static_cast<std::size_t>(first);
  std::string at;
  for (int a = 0; a < Dim; ++a) at += fmt::format("{}{:.6g}", a ? ", " : "", p.position[i][a]);
  throw DivergedError(fmt::format(
      "the simulation diverged at t = {:.6g} s: {} of particle {} at ({}) m went wrong (density {:.6g} kg/m3, speed {:.6g} m/s); a "
      "higher [solver] sound_speed_m_s or a lower [time_step] courant helps",
      time, broken_term(i), p.id[i], at, p.density[i], p.velocity[i].norm()));
}

template class Solver<3, float>;
template class Solver<3, double>;
template class Solver<2, double>;
template class Solver<1, double>;

}  // namespace smelt
