#include "core/sph/open_boundary.h"

#include "core/error.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace smelt {

namespace {

/// Unit vectors across `direction`.
template <int Dim>
std::vector<Vec<Dim>> axes_across(const Vec<Dim>& direction) {
  std::vector<Vec<Dim>> axes;
  if constexpr (Dim == 2) axes.push_back(Vec<2>(-direction[1], direction[0]));
  if constexpr (Dim == 3) {
    int least = 0;
    direction.cwiseAbs().minCoeff(&least);
    const Vec<3> helper = Vec<3>::Unit(least);
    const auto cross = [](const Vec<3>& a, const Vec<3>& b) {
      return Vec<3>(a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]);
    };
    axes.push_back(cross(direction, helper).normalized());
    axes.push_back(cross(direction, axes[0]));
  }
  return axes;
}

/// The sites of a square lattice within `radius` of its origin, which is a site, or the middle of a cell where
/// `between`.
template <int Dim>
std::vector<Vec<Dim>> lattice_disc(const std::vector<Vec<Dim>>& axes, double radius, double spacing, bool between) {
  std::vector<Vec<Dim>> sites;
  const double shift = between ? 0.5 : 0.0;
  const int n = static_cast<int>(radius / spacing) + 1;
  const int n_second = Dim == 3 ? n : 0;
  for (int j = -n_second; j <= n_second; ++j)
    for (int i = -n; i <= n; ++i) {
      Vec<Dim> site = Vec<Dim>::Zero();
      if constexpr (Dim > 1) site += (i + shift) * spacing * axes[0];
      if constexpr (Dim > 2) site += (j + shift) * spacing * axes[1];
      if (Dim > 1 ? site.norm() <= radius : i == 0) sites.push_back(site);
    }
  return sites;
}

template <int Dim>
double section_area(double radius) {
  constexpr double pi = 3.14159265358979323846;
  return Dim == 3 ? pi * radius * radius : Dim == 2 ? 2.0 * radius : 1.0;
}

}  // namespace

template <int Dim>
EmitterLayers<Dim> compute_emitter_layers(const Emitter<Dim>& emitter, double particle_volume, double support_radius) {
  const double spacing = std::pow(particle_volume, 1.0 / Dim);
  if (!(emitter.radius >= spacing))
    fail(
        "a vent of radius {:.4g} m is narrower than two particles, which are {:.4g} m apart; widen it, or take a "
        "smaller spacing",
        emitter.radius, spacing);
  if (!(emitter.flow_rate > 0.0)) fail("the flow rate must be > 0, is {}", emitter.flow_rate);
  if (!(std::abs(emitter.direction.norm() - 1.0) < 1e-9)) fail("the direction must be a unit vector");
  if (!(emitter.end > emitter.start))
    fail("it must end after it starts, at {} s; it ends at {} s", emitter.start, emitter.end);

  // Of the two lattices the one whose section is nearer to the circle's.
  const auto axes = axes_across<Dim>(emitter.direction);
  const double cell = std::pow(spacing, Dim - 1);
  auto sites = lattice_disc<Dim>(axes, emitter.radius, spacing, false);
  auto between = lattice_disc<Dim>(axes, emitter.radius, spacing, true);
  const auto error = [&](const std::vector<Vec<Dim>>& s) {
    return std::abs(static_cast<double>(s.size()) * cell - section_area<Dim>(emitter.radius));
  };
  if (error(between) < error(sites)) sites.swap(between);
  std::stable_sort(sites.begin(), sites.end(),
                   [](const Vec<Dim>& a, const Vec<Dim>& b) { return a.squaredNorm() < b.squaredNorm(); });

  EmitterLayers<Dim> layers;
  layers.speed = emitter.flow_rate / (static_cast<double>(sites.size()) * cell);
  layers.period = spacing / layers.speed;
  layers.depth = spacing * std::ceil(support_radius / spacing);
  const double n_poured = emitter.flow_rate * (emitter.end - emitter.start) / particle_volume;
  constexpr double endless = 0x1p62;  // more than any simulation gets to
  layers.n_particles = n_poured < endless ? std::llround(n_poured) : std::numeric_limits<std::int64_t>::max();
  layers.root = spacing * std::max(1.0, std::ceil(emitter.root / spacing));
  layers.sites = std::move(sites);
  return layers;
}

template <int Dim>
std::int64_t count_entered(const Emitter<Dim>& emitter, const EmitterLayers<Dim>& layers, double time) {
  if (!(time > emitter.start)) return 0;
  if (time >= emitter.end) return layers.n_particles;  // the last half layer as well
  const auto n_layers = static_cast<std::int64_t>(std::floor((time - emitter.start) / layers.period + 0.5));
  return std::min(layers.n_particles, n_layers * static_cast<std::int64_t>(layers.sites.size()));
}

template <int Dim>
Vec<Dim> entered_position(const Emitter<Dim>& emitter, const EmitterLayers<Dim>& layers, std::int64_t k, double time) {
  const auto n_sites = static_cast<std::int64_t>(layers.sites.size());
  const double entered = emitter.start + (static_cast<double>(k / n_sites) + 0.5) * layers.period;
  // Behind the entry: on the ground there is never a gap under the last layer that others could get into.
  const double along = (time - entered) * layers.speed - layers.root;
  return emitter.position + layers.sites[static_cast<std::size_t>(k % n_sites)] + along * emitter.direction;
}

#define SMELT_INSTANTIATE(Dim)                                                                      \
  template EmitterLayers<Dim> compute_emitter_layers<Dim>(const Emitter<Dim>&, double, double);     \
  template std::int64_t count_entered<Dim>(const Emitter<Dim>&, const EmitterLayers<Dim>&, double); \
  template Vec<Dim> entered_position<Dim>(const Emitter<Dim>&, const EmitterLayers<Dim>&, std::int64_t, double);
SMELT_INSTANTIATE(1)
SMELT_INSTANTIATE(2)
SMELT_INSTANTIATE(3)
#undef SMELT_INSTANTIATE

}  // namespace smelt
