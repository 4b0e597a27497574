#include "scenes/schema_parts.h"

namespace smelt {

void visit_section(SchemaVisitor& visitor, Scene& scene, SceneSection section) {
  switch (section) {
    case SceneSection::simulation:
      visitor.number({"fps", ""}, scene.shot.fps, positive);
      visit_simulation(visitor, scene);
      break;
    case SceneSection::surface:
      visit_surface(visitor, scene);
      break;
    case SceneSection::render:
      visit_render(visitor, scene);
      break;
  }
}

void visit_scene(SchemaVisitor& visitor, Scene& scene) {
  visitor.table({"shot", "the sequence"}, nullptr, [&] {
    visitor.required_text({"name", "names the output folder and the film"}, scene.shot.name);
    visit_int(visitor, {"frames", "number of frames; frame 1 is the start"}, scene.shot.frames, {1, 100000}, true);
    visitor.number({"fps", "frames per second"}, scene.shot.fps, {0.0, 100000.0, true});
    visitor.choice(
        {"quality",
         "settings for a purpose, where the scene does not say them itself: `preview` (a quarter of the particles, "
         "coarse surface, small pictures), `final`, `study` (small time steps, no XSPH, sums in double precision); "
         "what they buy: docs/accuracy.md",
         "the defaults below"},
        scene.shot.quality, {"preview", "final", "study"});
  });
  visit_simulation(visitor, scene);
  visit_surface(visitor, scene);
  visit_render(visitor, scene);
}

}  // namespace smelt
