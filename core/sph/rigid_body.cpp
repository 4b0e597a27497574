#include "core/sph/rigid_body.h"

#include "core/error.h"

#include <Eigen/Eigenvalues>

#include <algorithm>

namespace smelt {

/// In principal axes, Omega_ab = L_ab / (J_a + J_b).
template <int Dim>
Mat<Dim> RigidBody<Dim>::spin_of(const Mat<Dim>& l) const {
  const Mat<Dim> world_from_axes = state.rotation * axes;
  Mat<Dim> spin = world_from_axes.transpose() * l * world_from_axes;
  for (int a = 0; a < Dim; ++a)
    for (int b = 0; b < Dim; ++b) spin(a, b) = a == b ? 0.0 : spin(a, b) / (moments[a] + moments[b]);
  const Mat<Dim> world = world_from_axes * spin * world_from_axes.transpose();
  return 0.5 * (world - world.transpose());
}

template <int Dim>
double RigidBody<Dim>::compliance(const Vec<Dim>& x, const Vec<Dim>& n) const {
  const Vec<Dim> arm = x - state.centre;
  const Mat<Dim> moment = n * arm.transpose() - arm * n.transpose();
  return 1.0 / mass + n.dot(spin_of(moment) * arm);
}

template <int Dim>
double RigidBody<Dim>::compliance_bound(const Vec<Dim>& x) const {
  Vec<Dim> sorted = moments;
  std::sort(sorted.data(), sorted.data() + Dim);
  return 1.0 / mass + (Dim == 1 ? 0.0 : (x - state.centre).squaredNorm() / (sorted[0] + sorted[Dim > 1 ? 1 : 0]));
}

template <int Dim>
void RigidBody<Dim>::strike(const Vec<Dim>& x, const Vec<Dim>& impulse) {
  const Vec<Dim> arm = x - state.centre;
  state.velocity += impulse / mass;
  state.angular_momentum += impulse * arm.transpose() - arm * impulse.transpose();
}

template <int Dim>
double RigidBody<Dim>::kinetic_energy() const {
  // L . omega / 2, and a skew matrix holds each component of its vector twice.
  return 0.5 * mass * state.velocity.squaredNorm() + 0.25 * spin().cwiseProduct(state.angular_momentum).sum();
}

template <int Dim>
RigidBody<Dim> make_rigid_body(std::span<const Simplex<Dim>> facets, double mass) {
  if constexpr (Dim == 1) {
    fail("rigid body: there are none in one dimension");
  } else {
    const MassProperties<Dim> properties = compute_mass_properties<Dim>(facets);
    if (!(properties.volume > 0.0)) fail("rigid body: its facets bound no volume; it must be closed and wound outward");
    if (!(mass > 0.0)) fail("rigid body: its mass must be > 0, is {} kg", mass);
    RigidBody<Dim> body;
    body.mass = mass;
    body.rest_centre = body.state.centre = properties.centre;
    const Eigen::SelfAdjointEigenSolver<Mat<Dim>> solver(mass / properties.volume * properties.second);
    body.axes = solver.eigenvectors();
    body.moments = solver.eigenvalues();
    return body;
  }
}

template <int Dim>
void kick_body(RigidBody<Dim>& body, const Vec<Dim>& gravity, double dt) {
  body.state.velocity += dt * (body.load.force / body.mass + gravity);
  body.state.angular_momentum += dt * body.load.torque;
}

template <int Dim>
BodyState<Dim> drift_body(const RigidBody<Dim>& body, double dt) {
  BodyState<Dim> after = body.state;
  after.centre += dt * body.state.velocity;
  if (body.state.angular_momentum.isZero(0.0)) return after;
  RigidBody<Dim> middle = body;
  middle.state.rotation = rotation_of<Dim>(0.5 * dt * body.spin()) * body.state.rotation;
  after.rotation = to_rotation<Dim>(rotation_of<Dim>(dt * middle.spin()) * body.state.rotation);
  return after;
}

template struct RigidBody<1>;
template struct RigidBody<2>;
template struct RigidBody<3>;
template RigidBody<1> make_rigid_body<1>(std::span<const Simplex<1>>, double);
template RigidBody<2> make_rigid_body<2>(std::span<const Simplex<2>>, double);
template RigidBody<3> make_rigid_body<3>(std::span<const Simplex<3>>, double);
template void kick_body<1>(RigidBody<1>&, const Vec<1>&, double);
template void kick_body<2>(RigidBody<2>&, const Vec<2>&, double);
template void kick_body<3>(RigidBody<3>&, const Vec<3>&, double);
template BodyState<1> drift_body<1>(const RigidBody<1>&, double);
template BodyState<2> drift_body<2>(const RigidBody<2>&, double);
template BodyState<3> drift_body<3>(const RigidBody<3>&, double);

}  // namespace smelt
