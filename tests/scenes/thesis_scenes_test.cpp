// The shots of [P table 6.2] hold as many particles as the table says.

#include "bench/thesis_bench.h"
#include "scenes/build_simulation.h"
#include "scenes/scene_reader.h"

#include <gtest/gtest.h>

namespace smelt {
namespace {

TEST(ThesisScenes, HoldAsManyParticlesAsTheTableSays) {
  EXPECT_EQ(thesis_shots().size(), 9u);
  for (const ThesisShot& shot : thesis_shots()) {
    const Scene scene = read_scene(scene_file(shot));
    const SimulationSetup setup = build_simulation(scene);
    const double n =
        static_cast<double>(setup.particles.size()) + count_poured(setup, scene.shot.frames / scene.shot.fps);
    EXPECT_NEAR(n / static_cast<double>(shot.n_particles), 1.0, 0.01) << shot.name;
    for (const std::string& warning : setup.warnings) ADD_FAILURE() << shot.name << ": " << warning;
  }
}

}  // namespace
}  // namespace smelt
