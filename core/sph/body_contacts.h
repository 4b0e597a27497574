#pragma once
// Rigid bodies against each other and against other obstacles.
//
// Contacts are those of the corners of a body with the facets of the other thing, and of the other's corners where that
// is a body too. Two edges that cross without a corner near them pass: meshes want to be finer than what they may hit
// with an edge. Between corner and facet is a skin of a thousandth of the body's size.

#include "core/sph/collision.h"

namespace smelt {

/// Changes the velocities of the rigid bodies among `placed`, and sets where each ends after a step of `dt` [s], so
/// that no corner passes a facet. At a contact the bodies' normal velocity is stopped, and the larger restitution of
/// the two gives that share of the impulse back; of the tangential one the smaller friction's share is kept. Both act
/// as impulses, by sweeps over the contacts in a fixed order; what they have not resolved stops a body at the contact
/// for the rest of the step. `begin` and `end` of what moves by itself must be set.
template <int Dim>
void move_bodies(std::vector<PlacedObstacle<Dim>>& placed, double dt);

}  // namespace smelt
