#include "scenes/rest_positions.h"

#include "core/error.h"

#include <gtest/gtest.h>

namespace smelt {
namespace {

ParticleFrame frame_of(std::vector<std::int32_t> id, std::vector<Vec3> position, double time) {
  ParticleFrame frame;
  frame.id = std::move(id);
  frame.position = std::move(position);
  frame.time = time;
  return frame;
}

/// Pours upwards; the speed follows from the sites of its lattice.
SolverParameters<3> with_vent() {
  SolverParameters<3> parameters;
  parameters.particle_volume = 1e-3;
  parameters.smoothing_length = 0.12;
  Emitter<3> vent;
  vent.position = Vec3(1.0, 0.0, 0.0);
  vent.direction = Vec3::UnitY();
  vent.radius = 0.5;
  vent.root = 0.1;
  vent.flow_rate = 1.0;
  vent.end = 10.0;
  parameters.emitters.push_back(vent);
  return parameters;
}

TEST(RestPositions, OfABodyAreWhereItStarts) {
  RestPositions rest(SolverParameters<3>{});
  ParticleFrame first = frame_of({3, 5}, {Vec3(1, 2, 3), Vec3(4, 5, 6)}, 0.0);
  rest.set_rest(first);
  EXPECT_EQ(first.rest[1], Vec3f(4, 5, 6));
  ParticleFrame later = frame_of({5}, {Vec3(9, 9, 9)}, 0.5);
  rest.set_rest(later);
  EXPECT_EQ(later.rest[0], Vec3f(4, 5, 6));
}

/// Particles of one column, seen at two times, rest as far apart as they came in.
TEST(RestPositions, OfAVentAreAColumnThatItPushesOut) {
  const auto parameters = with_vent();
  const double speed = compute_emitter_layers(parameters.emitters[0], parameters.particle_volume, 0.24).speed;
  RestPositions rest(parameters);
  ParticleFrame empty = frame_of({}, {}, 0.0);
  rest.set_rest(empty);
  ParticleFrame early = frame_of({0}, {Vec3(1.1, 0.2, 0.0)}, 1.0);
  rest.set_rest(early);
  ParticleFrame late = frame_of({0, 1}, {Vec3(3.0, 3.0, 3.0), Vec3(1.1, 0.2, 0.0)}, 1.5);
  rest.set_rest(late);
  EXPECT_EQ(late.rest[0], early.rest[0]);
  EXPECT_NEAR(late.rest[0].y() - late.rest[1].y(), 0.5 * speed, 1e-5);
  EXPECT_FLOAT_EQ(late.rest[1].x(), 1.1f);
}

TEST(RestPositions, GoOnFromAFrame) {
  ParticleFrame kept = frame_of({7}, {Vec3(0, 0, 0)}, 0.4);
  RestPositions rest(SolverParameters<3>{});
  EXPECT_THROW(rest.take_over(kept), Error);
  kept.rest = {Vec3f(1, 1, 1)};
  rest.take_over(kept);
  ParticleFrame next = frame_of({7}, {Vec3(2, 0, 0)}, 0.5);
  rest.set_rest(next);
  EXPECT_EQ(next.rest[0], Vec3f(1, 1, 1));
}

}  // namespace
}  // namespace smelt
