#pragma once
// Walls: obstacles that complete the fluid's support (docs/decisions/0008-walls.md).
//
// The part of a particle's support that lies in a solid is integrated over the solid's facets
// (core/sph/wall_integrals.h), corners included. In it the velocity goes on linearly through the wall's own, the
// pressure with the gradient that it has along the wall and that gravity gives it across, the temperature linearly
// through the wall's own. Symbols: n normal out of the solid, y the way from the particle, d > 0 the distance to a
// facet's plane, u the wall's rigid velocity field at the particle's place, Omega its spin (skew), a_w its
// acceleration, A = int_f W dS, Gamma = int W dV over the solid, dx the spacing.

#include "core/round_down.h"
#include "core/sph/collision.h"
#include "core/sph/particles.h"
#include "core/sph/wall_integrals.h"
#include "core/sph/wall_samples.h"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace smelt {

/// One plane of a wall as a particle sees it, or a patch of a curved one: facets whose normals are within some ten
/// degrees are one contact, with their mean plane.
template <int Dim>
struct WallContact {
  Vec<Dim> normal;        ///< n
  Vec<Dim> first;         ///< int_f y W dS, y from the particle [-]
  double distance = 0.0;  ///< d [m]
  double area = 0.0;      ///< A: int grad_w dV over the solid is the sum of -A n [1/m]
  double solid = 0.0;     ///< Gamma of the solid behind this plane [-]
  double push =
      0.0;  ///< 2 A max(1, dx/2d): what mirrored pressure and normal velocity come to, and more within dx/2 [1/m]
  double stretch = 0.0;      ///< (d A + Gamma)/d: int (n.y)/d grad_w dV = stretch n [1/m]
  double conductance = 0.0;  ///< A/d [1/m^2]
  std::uint32_t obstacle = 0;
  Vec<Dim> velocity;      ///< u: the wall's motion continued to the particle, and the sliding of its surface [m/s]
  Vec<Dim> acceleration;  ///< a_w: of the wall, likewise [m/s^2]
};

/// A particle near walls.
template <int Dim>
struct WallNeighbour {
  std::int32_t particle = 0;
  double solid = 0.0;                  ///< Gamma, share of the kernel inside solids [-]
  Mat<Dim> moment = Mat<Dim>::Zero();  ///< int y (x) grad_w dV over the solid, symmetric [-]
  std::vector<WallContact<Dim>> contacts;
};

/// Which particles are near which facets, and what they see of them. Each particle's facets are looked up anew once it
/// has moved by h/4 against them, its sums made anew once it has moved by h/50: what rests or creeps costs next to
/// nothing. They are those of half that way ahead: sums that only ever lagged behind would push what slides along a
/// curved wall.
template <int Dim>
class Walls {
 public:
  /// `spacing` [m] of the particles at rest. A particle nearer to a plane than `least_distance` [m] counts as that far
  /// from it where something grows with 1/d; the swept collision keeps centres about as far.
  Walls(const WallKernel<Dim>& kernel, double spacing, double least_distance)
      : kernel_(kernel), spacing_(spacing), least_distance_(least_distance) {}

  /// Forgets everything; there are `n` particles from now on.
  void reset(std::size_t n);

  /// Follows particles that were put in another order: now particle i is what particle order[i] was. `scratch` has 4
  /// bytes for each.
  void reorder(std::span<const std::int32_t> order, std::span<std::byte> scratch);

  /// Follows particles that all went but those `kept`, in order.
  void keep(std::span<const std::int32_t> kept);

  /// There are `n` particles from now on, those beyond the ones so far unknown.
  void grow(std::size_t n) {
    slot_.resize(n, -1);
    apart_.resize(n, 0.0F);
  }

  /// Particle `i` has moved by `way` [m].
  void travel(std::size_t i, double way) { apart_[i] = round_down(apart_[i] - way); }

  /// What every particle sees from where it is now, after a step of `dt` [s] with `velocity` [m/s] and of the
  /// obstacles; before the first step `dt` is 0. Obstacles that are not walls are left out.
  void update(const Colliders<Dim>& colliders, std::span<const Vec<Dim>> position, std::span<const Vec<Dim>> velocity,
              double dt);

  const std::vector<WallNeighbour<Dim>>& neighbours() const { return neighbours_; }

  /// Of particle `i`, or nullptr where it is far from all walls.
  const WallNeighbour<Dim>* of(std::size_t i) const {
    return slot_[i] < 0 ? nullptr : &neighbours_[static_cast<std::size_t>(slot_[i])];
  }

  /// Where one of them is among them.
  std::size_t slot(const WallNeighbour<Dim>& wall) const {
    return static_cast<std::size_t>(&wall - neighbours_.data());
  }

 private:
  /// What a particle has in reach of one obstacle, at rest as the obstacle's facets are.
  struct Sight {
    std::uint32_t obstacle = 0;
    double side = 1.0;                            ///< +1 where the particle is in front of it, -1 behind
    Vec<Dim> origin = Vec<Dim>::Zero();           ///< where it was looked up; samples are relative to it
    std::size_t facets_end = 0, patches_end = 0;  ///< of its own; they begin where those of the sight before end
  };
  /// What was looked up for one particle, and what came of it.
  struct View {
    Vec<Dim> origin = Vec<Dim>::Zero();  ///< where the particle was when it was looked up
    double way = -1.0;                   ///< of the obstacles by then; -1: not looked up yet
    std::vector<Sight> sights;
    std::vector<std::uint32_t> facets;     ///< to be integrated one by one
    std::vector<std::size_t> patches_end;  ///< of patches of samples, in `samples`
    std::vector<float> samples;
    Vec<Dim> summed_from = Vec<Dim>::Zero();  ///< where the particle was when it was summed
    Vec<Dim> summed_at = Vec<Dim>::Zero();    ///< where the sums hold: a little ahead of that
    double summed_way = -1.0;                 ///< -1: not summed yet
    WallNeighbour<Dim> sums;                  ///< of then
  };

  /// Farther than this a particle sees nothing, however it moves until the next look [m].
  double reach() const { return kernel_.support_radius() + slack(); }
  double slack() const { return 0.25 * kernel_.smoothing_length(); }
  bool comes_near(const Colliders<Dim>& colliders, std::span<const Vec<Dim>> position, std::size_t i);
  void take_in(const Colliders<Dim>& colliders, std::span<const Vec<Dim>> position);
  void sort_slots();
  void drop_blind();
  /// So far a particle may go until its sums are made anew [m]. The lattice of a fluid at rest moves by less; it is far
  /// below what any sum changes over.
  double little() const { return Dim == 3 ? 0.02 * kernel_.smoothing_length() : 0.0; }
  Vec<Dim> half_of_a_little(const Vec<Dim>& velocity, double dt) const;
  void refresh(const Colliders<Dim>& colliders, const Vec<Dim>& position, const Vec<Dim>& ahead, std::size_t slot);
  void look_up(const Colliders<Dim>& colliders, const Vec<Dim>& position, View& view) const;
  void sum(const Colliders<Dim>& colliders, const Vec<Dim>& position, View& view) const;
  void sum_sight(const PlacedObstacle<Dim>& placed, const Vec<Dim>& local, std::size_t k, View& view) const;
  bool shift(const View& view, const Vec<Dim>& moved, WallNeighbour<Dim>& seen) const;
  void complete(const PlacedObstacle<Dim>& placed, const Vec<Dim>& position, WallContact<Dim>& contact) const;

  WallKernel<Dim> kernel_;
  double spacing_;
  double least_distance_;
  double way_ = 0.0;                ///< of the obstacles, at least, since the last reset [m]
  std::vector<std::int32_t> slot_;  ///< of each particle among neighbours_, or -1
  std::vector<float> apart_;        ///< the way the obstacles may go before a particle without a slot can see one [m]
  std::vector<WallNeighbour<Dim>> neighbours_;
  std::vector<View> views_;                    ///< of each of them
  std::optional<SampleKernel> sample_kernel_;  ///< in 3D
  std::vector<WallTree> trees_;                ///< of every obstacle, in 3D
};

}  // namespace smelt
