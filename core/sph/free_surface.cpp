#include "core/sph/free_surface.h"

#include "core/parallel.h"

#include <algorithm>
#include <cmath>

namespace smelt {

namespace {

/// 0 up to `low`, 1 from `high` on, smooth in between.
double ramp(double x, double low, double high) {
  const double t = std::clamp((x - low) / (high - low), 0.0, 1.0);
  return t * t * (3.0 - 2.0 * t);
}

/// The way from j, image or not, to i, and who j is.
template <int Dim>
struct Neighbour {
  std::size_t source;
  Vec<Dim> x_ij;
};

template <int Dim>
Neighbour<Dim> neighbour_of(const FreeSurfaceInput<Dim>& in, std::size_t i, std::int32_t entry) {
  const auto k = static_cast<std::size_t>(entry);
  if (k < in.position.size()) return {k, in.position[i] - in.position[k]};
  const std::size_t image = k - in.position.size();
  const auto source = static_cast<std::size_t>(in.images.source[image]);
  return {source, in.position[i] - (in.position[source] + in.images.shift[image])};
}

/// The sums over the support that tell where its empty side is.
template <int Dim>
struct Support {
  Vec<Dim> gradient = Vec<Dim>::Zero();  ///< s [1/m]
  double trace = 0.0;                    ///< of the position moment, about Dim where the support is full
};

template <int Dim>
Support<Dim> sum_support(const FreeSurfaceInput<Dim>& in, const Kernel<Dim>& kernel, std::size_t i) {
  Support<Dim> support;
  for (const std::int32_t entry : in.lists.row(i)) {
    const auto [j, x_ij] = neighbour_of(in, i, entry);
    const double r = x_ij.norm();
    if (r >= kernel.support_radius() || r == 0.0) continue;
    const double weight = in.volume[j] * kernel.derivative(r);
    support.gradient += weight / r * x_ij;
    support.trace -= weight * r;
  }
  if (const WallNeighbour<Dim>* wall = in.walls ? in.walls->of(i) : nullptr) {
    for (const WallContact<Dim>& contact : wall->contacts) support.gradient -= contact.area * contact.normal;
    support.trace += wall->moment.trace();
  }
  return support;
}

/// How much stands in the cone about `outward`: about 1 for a single neighbour in its middle.
template <int Dim>
double cone_occupancy(const FreeSurfaceInput<Dim>& in, std::size_t i, const Vec<Dim>& outward) {
  constexpr double rim = 0.5, core = 0.75, reach = 2.0;  // cosines of 60 and 41 degrees; spacings
  const auto count = [&](double cosine, double distance) {
    return std::clamp((cosine - rim) / (core - rim), 0.0, 1.0) *
           std::clamp(2.0 * (reach - distance / in.spacing), 0.0, 1.0);
  };
  double occupancy = 0.0;
  for (const std::int32_t entry : in.lists.row(i)) {
    const Vec<Dim> x_ij = neighbour_of(in, i, entry).x_ij;
    const double r = x_ij.norm();
    if (r > 0.0 && r < reach * in.spacing) occupancy += count(-x_ij.dot(outward) / r, r);
  }
  if (const WallNeighbour<Dim>* wall = in.walls ? in.walls->of(i) : nullptr)
    for (const WallContact<Dim>& contact : wall->contacts)
      if (contact.distance > 0.0) occupancy += 2.0 * count(-contact.normal.dot(outward), contact.distance);
  return occupancy;
}

/// Weights at the surface, and outward normals: none where the support has no empty side to speak of.
template <int Dim>
struct SurfaceParticles {
  std::vector<double> weight;
  std::vector<Vec<Dim>> normal;
};

template <int Dim>
SurfaceParticles<Dim> find_surface(const FreeSurfaceInput<Dim>& in) {
  const std::size_t n = in.position.size();
  SurfaceParticles<Dim> surface{std::vector<double>(n), std::vector<Vec<Dim>>(n)};
  const Kernel<Dim> kernel(in.smoothing_length, in.kernel);
  parallel_for_each(n, [&](std::size_t i) {
    const Support<Dim> support = sum_support(in, kernel, i);
    const double emptiness = in.smoothing_length * support.gradient.norm();
    const Vec<Dim> outward = emptiness > 1e-12 ? Vec<Dim>(-support.gradient.normalized()) : Vec<Dim>(Vec<Dim>::Unit(0));
    const double crowded = ramp(cone_occupancy(in, i, outward), 0.3, 1.0) * ramp(support.trace / Dim, 0.4, 0.55);
    surface.weight[i] = 1.0 - crowded;
    surface.normal[i] = ramp(emptiness, 0.03, 0.1) * outward;
  });
  return surface;
}

/// K of the surface, which has one dimension less than its space: the cubic spline.
template <int Dim>
class LateralKernel {
 public:
  explicit LateralKernel(double h) : inverse_h_(1.0 / h) {
    if constexpr (Dim > 1) scale_ = kernel_normalisation<Dim - 1>(KernelType::cubic_spline) / std::pow(h, Dim - 1);
  }

  double value(double distance2) const {
    if constexpr (Dim == 1) return 1.0;
    const double q = std::sqrt(distance2) * inverse_h_;
    return q < 2.0 ? scale_ * kernel_shape(KernelType::cubic_spline, q) : 0.0;
  }

 private:
  double inverse_h_;
  double scale_ = 1.0;
};

/// Share of the lateral kernel that lies in walls, which hold no particles; that of the kernel itself is as good as it.
template <int Dim>
double share_in_walls(const FreeSurfaceInput<Dim>& in, std::size_t i, const Vec<Dim>& normal) {
  const WallNeighbour<Dim>* wall = in.walls ? in.walls->of(i) : nullptr;
  if (!wall) return 0.0;
  double share = 0.0;
  for (const WallContact<Dim>& contact : wall->contacts) {
    const double across = contact.normal.dot(normal);
    share += (normal.squaredNorm() - across * across) * contact.solid;
  }
  return std::clamp(share, 0.0, 0.75);  // a corner of three walls
}

/// Weight per area of the surface around particle i [1/m^(Dim - 1)].
template <int Dim>
double weight_density(const FreeSurfaceInput<Dim>& in, const SurfaceParticles<Dim>& surface,
                      const LateralKernel<Dim>& kernel, std::size_t i) {
  const Vec<Dim>& n_i = surface.normal[i];
  const double half = 0.5 * in.spacing;
  double density = surface.weight[i] * kernel.value(0.0);
  for (const std::int32_t entry : in.lists.row(i)) {
    const auto [j, x_ij] = neighbour_of(in, i, entry);
    if (surface.weight[j] == 0.0) continue;
    const Vec<Dim>& n_j = surface.normal[j];
    // Where either has no normal nobody knows which side it is on: it counts whole.
    const double same_side = std::clamp(2.0 * (n_i.dot(n_j) + 1.0 - n_i.norm() * n_j.norm()), 0.0, 1.0);
    if (same_side == 0.0) continue;
    const Vec<Dim> y_ij = x_ij + half * (n_i - n_j);
    const Vec<Dim> across = n_i + n_j;
    const double length2 = across.squaredNorm();
    const double height = length2 > 0.25 ? across.dot(y_ij) : 0.0;
    const double distance2 = std::max(0.0, y_ij.squaredNorm() - (length2 > 0.25 ? height * height / length2 : 0.0));
    density += same_side * surface.weight[j] * kernel.value(distance2);
  }
  return density / (1.0 - share_in_walls(in, i, n_i));
}

}  // namespace

template <int Dim>
void compute_free_surface_areas(const FreeSurfaceInput<Dim>& input, std::vector<double>& area) {
  const SurfaceParticles<Dim> surface = find_surface(input);
  const LateralKernel<Dim> kernel(0.5 * kernel_kappa(input.kernel) * input.smoothing_length);  // of the same support
  area.resize(input.position.size());
  parallel_for_each(area.size(), [&](std::size_t i) {
    area[i] = surface.weight[i] > 0.0 ? surface.weight[i] / weight_density(input, surface, kernel, i) : 0.0;
  });
}

template void compute_free_surface_areas<1>(const FreeSurfaceInput<1>&, std::vector<double>&);
template void compute_free_surface_areas<2>(const FreeSurfaceInput<2>&, std::vector<double>&);
template void compute_free_surface_areas<3>(const FreeSurfaceInput<3>&, std::vector<double>&);

}  // namespace smelt
