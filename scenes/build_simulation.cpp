#include "scenes/build_simulation.h"

#include "core/error.h"
#include "core/geometry/seeding.h"
#include "io/height_field.h"
#include "io/mesh_import.h"
#include "scenes/collider_motion.h"
#include "scenes/place_vents.h"
#include "scenes/prepare_colliders.h"
#include "scenes/scene_reader.h"

#include <algorithm>
#include <cmath>

namespace smelt {

namespace {

/// A body's mesh in the world, sound and closed.
struct PlacedBody {
  TriangleMesh mesh;
  double volume = 0.0;
  Box3 bounds;
};

void place(TriangleMesh& mesh, const PlacementSettings& s) {
  const Box3 bounds = compute_bounds(mesh);
  double scale = s.scale.value_or(1.0);
  if (s.height) {
    if (!(bounds.extent()[1] > 0.0)) fail("height_m cannot scale a mesh that is flat along y");
    scale = *s.height / bounds.extent()[1];
  }
  const Mat3 rotation = rotation_from_degrees(s.rotate_deg);
  for (Vec3& x : mesh.vertices) x = rotation * (scale * x) + s.translate;
  if (s.stand_at_y) {
    const double drop = *s.stand_at_y - compute_bounds(mesh).lower[1];
    for (Vec3& x : mesh.vertices) x[1] += drop;
  }
}

TriangleMesh import_terrain(const std::filesystem::path& file, const TerrainSettings& s) {
  const HeightField field = refine(read_height_field(file, {s.cell, s.height_scale, s.lowest, s.highest}), s.refine);
  if (!s.closed) return make_terrain_sheet(field);
  const double shorter = field.cell * static_cast<double>(std::min(field.n_columns, field.n_rows) - 1);
  return make_terrain_solid(
      field, *std::min_element(field.height.begin(), field.height.end()) - s.depth.value_or(0.1 * shorter));
}

TriangleMesh import_placed(const Scene& scene, const std::string& name, const PlacementSettings& placement,
                           void (*validate)(const TriangleMesh&),
                           const std::optional<TerrainSettings>& terrain = std::nullopt) {
  const std::filesystem::path file = find_mesh(scene, name);
  TriangleMesh mesh =
      is_height_field(file) ? import_terrain(file, terrain.value_or(TerrainSettings{})) : import_mesh(file);
  try {
    validate(mesh);
    place(mesh, placement);
  } catch (const Error& error) {
    fail("{}: {}", file.string(), error.what());
  }
  return mesh;
}

/// The spacing a mesh is mended for: what was asked, or about what the count will come to.
double estimate_spacing(const Scene& scene, double volume) {
  if (scene.particles.spacing) return *scene.particles.spacing;
  return std::cbrt(std::abs(volume) / static_cast<double>(*scene.particles.count));
}

std::vector<PlacedBody> import_bodies(const Scene& scene, std::vector<std::string>& warnings) {
  const std::vector<TriangleMesh> meshes = import_placed_bodies(scene);
  double volume = 0.0;
  for (const TriangleMesh& mesh : meshes) {
    // A mesh with holes has no volume to speak of: its box does for the estimate.
    volume +=
        compute_topology(mesh).closed() ? std::abs(compute_volume(mesh)) : 0.3 * compute_bounds(mesh).extent().prod();
  }
  const double spacing = estimate_spacing(scene, volume);
  std::vector<PlacedBody> bodies;
  for (std::size_t k = 0; k < meshes.size(); ++k) {
    const std::string& name = scene.bodies[k].mesh;
    RepairedMesh repaired =
        blame(scene.places, fmt::format("body.{}.mesh: {}", k, name), [&] { return repair(meshes[k], spacing); });
    if (repaired.report.repaired) warnings.push_back(fmt::format("{}: {}", name, repaired.report.description));
    bodies.push_back({std::move(repaired.mesh), 0.0, {}});
    bodies.back().volume = compute_volume(bodies.back().mesh);
    bodies.back().bounds = compute_bounds(bodies.back().mesh);
  }
  return bodies;
}

/// Particles of each body share the count by volume.
std::vector<Seeds> seed_bodies(const Scene& scene, const std::vector<PlacedBody>& bodies) {
  double total = 0.0;
  for (const PlacedBody& body : bodies) total += body.volume;
  std::vector<Seeds> seeds;
  for (std::size_t k = 0; k < bodies.size(); ++k) {
    SeedingOptions options;
    options.jitter = scene.particles.jitter;
    options.seed = static_cast<std::uint64_t>(scene.particles.seed) + k;
    if (scene.particles.spacing)
      options.spacing = *scene.particles.spacing;
    else
      options.count = std::max<std::int64_t>(
          1, std::llround(static_cast<double>(*scene.particles.count) * bodies[k].volume / total));
    seeds.push_back(blame(scene.places, fmt::format("body.{}.mesh: {}", k, scene.bodies[k].mesh),
                          [&] { return seed_particles(bodies[k].mesh, options); }));
  }
  return seeds;
}

std::size_t material_index(const Scene& scene, const std::string& name) {
  const auto found =
      std::find_if(scene.materials.begin(), scene.materials.end(), [&](const auto& m) { return m.name == name; });
  CHECK(found != scene.materials.end());
  return static_cast<std::size_t>(found - scene.materials.begin());
}

void append_body(const Scene& scene, std::size_t k, const PlacedBody& body, const Seeds& seeds,
                 Particles<3>& particles) {
  const BodySettings& settings = scene.bodies[k];
  const std::size_t material = material_index(scene, settings.material);
  for (const Vec3& x : seeds.positions) {
    particles.id.push_back(static_cast<std::int32_t>(particles.id.size()));
    if (scene.materials.size() > 1) particles.material.push_back(static_cast<std::uint8_t>(material));
    particles.position.push_back(x);
    particles.velocity.push_back(settings.velocity);
    particles.density.push_back(scene.materials[material].density);
    if (settings.temperature) {
      const double height = (x[1] - body.bounds.lower[1]) / body.bounds.extent()[1];
      particles.temperature.push_back((1.0 - height) * settings.temperature->bottom +
                                      height * settings.temperature->top);
    }
  }
}

/// A square floor so large that no particle of the domain gets past its edge.
TriangleMesh make_ground(double height, double half_size, const Vec3& centre) {
  const auto corner = [&](double x, double z) {
    return Vec3(centre[0] + x * half_size, height, centre[2] + z * half_size);
  };
  return {{corner(-1, -1), corner(-1, 1), corner(1, 1), corner(1, -1)}, {{0, 1, 2}, {0, 2, 3}}};
}

/// Solid ground under a body is what it stands on: a particle that begins below it could only fall.
void refuse_bodies_under_ground(const Scene& scene, const std::vector<PlacedBody>& bodies) {
  for (const ColliderSettings& collider : scene.colliders) {
    if (collider.mesh != "ground") continue;
    for (std::size_t k = 0; k < bodies.size(); ++k) {
      const double below = collider.ground_height - bodies[k].bounds.lower[1];
      if (below > 1e-6 * bodies[k].bounds.extent()[1])
        fail(
            "{}: the body reaches {:.4g} m below the ground at y = {} m; move it with translate_m, or put it there "
            "with stand_at_y_m = {}",
            scene.bodies[k].mesh, below, collider.ground_height, collider.ground_height);
    }
  }
}

/// A particle that begins outside would be moved into what is inside.
void refuse_bodies_outside_period(const Scene& scene, const Box3& period, const std::vector<PlacedBody>& bodies) {
  for (std::size_t k = 0; k < bodies.size(); ++k)
    for (int a = 0; a < 3; ++a) {
      if (!is_periodic(period, a)) continue;
      const double outside =
          std::max(period.lower[a] - bodies[k].bounds.lower[a], bodies[k].bounds.upper[a] - period.upper[a]);
      if (outside > 1e-6 * bodies[k].bounds.extent()[a])
        fail(
            "{}: the body reaches {:.4g} m out of the [periodic] box along {}; move it with translate_m, or make the "
            "box larger",
            scene.bodies[k].mesh, outside, "xyz"[a]);
    }
}

Box3 to_period(const Scene& scene) {
  Box3 period;
  if (!scene.periodic) return period;
  for (int a = 0; a < 3; ++a) {
    if (scene.periodic->axes.find("xyz"[a]) == std::string::npos) continue;
    period.lower[a] = (*scene.periodic->lower)[a];
    period.upper[a] = (*scene.periodic->upper)[a];
  }
  return period;
}

KernelType to_kernel(const std::string& name) {
  if (name == "quintic_spline") return KernelType::quintic_spline;
  return name == "quadratic" ? KernelType::quadratic : KernelType::cubic_spline;
}

DensityForm to_density_form(const std::string& name) {
  if (name == "summation") return DensityForm::summation;
  return name == "normalised_summation" ? DensityForm::normalised_summation : DensityForm::continuity;
}

/// The fastest body, collider or emitter.
double compute_fastest_start(const Scene& scene, const SimulationSetup& setup) {
  double start = 0.0;
  for (const BodySettings& body : scene.bodies) start = std::max(start, body.velocity.norm());
  for (std::size_t k = 0; k < setup.obstacles.size(); ++k) {
    const Motion<3>& motion = setup.obstacles[k].motion;
    double reach = 0.0;
    for (const Vec3& x : setup.colliders[k].vertices) reach = std::max(reach, (x - motion.pivot).norm());
    start = std::max(start, speed_bound(motion, 0.0, scene.shot.frames / scene.shot.fps, reach) +
                                setup.obstacles[k].surface_velocity.norm());
  }
  for (const EmitterSettings& e : scene.emitters)
    start = std::max(start, e.flow_rate / (std::numbers::pi * e.radius * e.radius));
  return start;
}

/// sqrt(2 g H), H how far anything can fall, over the whole scene along gravity.
double compute_free_fall(const Scene& scene, const Box3& scene_bounds) {
  const double g = scene.gravity.norm();
  const double height = g > 0.0 ? scene_bounds.extent().dot(scene.gravity.cwiseAbs()) / g : 0.0;
  return std::sqrt(2.0 * g * height);
}

double automatic_sound_speed(double expected_speed) {
  if (!(expected_speed > 0.0))
    fail(
        "[solver] sound_speed_m_s: nothing moves at the start and there is no gravity, so it does not follow from the "
        "scene; give it, about ten times the fastest speed expected");
  return 10.0 * expected_speed;
}

Obstacle<3> to_obstacle(const ColliderSettings& s, const TriangleMesh& mesh) {
  Obstacle<3> obstacle;
  obstacle.response = {s.friction, s.restitution};
  obstacle.wall = s.wall;
  obstacle.motion = to_motion(s, mesh);
  obstacle.surface_velocity = s.surface_velocity;
  obstacle.temperature = s.temperature;
  if (s.until) obstacle.until = *s.until;
  return obstacle;
}

Emitter<3> to_emitter(const Scene& scene, const EmitterSettings& s) {
  Emitter<3> emitter;
  emitter.position = s.position;
  emitter.direction = s.direction.normalized();
  emitter.radius = s.radius;
  emitter.flow_rate = s.flow_rate;
  emitter.start = s.start;
  emitter.end = s.end.value_or(std::numeric_limits<double>::infinity());
  emitter.temperature = s.temperature.value_or(0.0);
  emitter.material = static_cast<std::uint8_t>(material_index(scene, s.material));
  return emitter;
}

/// Mass of a rigid body; turns a mesh that is inside out. Throws Error for one that bounds no volume.
double weigh_body(const ColliderSettings& s, TriangleMesh& mesh, std::vector<std::string>& warnings) {
  if (!compute_topology(mesh).closed())
    fail(
        "{}: a rigid body needs a closed mesh, and this one has holes: close it, or leave mass_kg and density_kg_m3 "
        "out",
        s.mesh);
  double volume = compute_volume(mesh);
  if (volume < 0.0) {
    for (auto& triangle : mesh.triangles) std::swap(triangle[0], triangle[1]);
    volume = -volume;
    warnings.push_back(
        fmt::format("{}: the mesh of the rigid body is inside out; its faces were turned round", s.mesh));
  }
  if (!(volume > 0.0)) fail("{}: a rigid body needs a mesh that bounds a volume, and this one bounds none", s.mesh);
  return s.mass ? *s.mass : *s.density * volume;
}

void set_heat_exchange(const Scene& scene, SolverParameters<3>& p) {
  if (scene.ambient) p.ambient = Ambient{*scene.ambient->temperature, scene.ambient->heat_transfer};
  for (const HeatSourceSettings& s : scene.heat_sources) {
    HeatSource<3> source{
        s.position, s.velocity, s.radius, s.power, s.temperature.value_or(0.0), s.heat_transfer.value_or(0.0), s.from};
    if (s.until) source.end = *s.until;
    p.heat_sources.push_back(source);
  }
}

void set_parameters(const Scene& scene, const Box3& scene_bounds, SimulationSetup& setup) {
  SolverParameters<3>& p = setup.parameters;
  p.particle_volume = setup.particles.size() > 0 ? setup.body_volume / static_cast<double>(setup.particles.size())
                                                 : std::pow(*scene.particles.spacing, 3);
  setup.spacing = std::cbrt(p.particle_volume);
  p.smoothing_length = scene.particles.smoothing_length_over_spacing * setup.spacing;
  p.gravity = scene.gravity;
  setup.fastest_start = compute_fastest_start(scene, setup);
  setup.expected_speed = compute_free_fall(scene, scene_bounds) + setup.fastest_start;
  p.sound_speed = scene.solver.sound_speed ? *scene.solver.sound_speed : automatic_sound_speed(setup.expected_speed);
  const bool viscoplastic = std::any_of(scene.materials.begin(), scene.materials.end(),
                                        [](const MaterialSettings& m) { return m.viscosity.law == "smd"; });
  p.shear_wave_speed = scene.solver.shear_wave_speed.value_or(viscoplastic ? p.sound_speed : 0.0);
  p.artificial_viscosity = scene.solver.artificial_viscosity;
  p.density_diffusion = scene.solver.density_diffusion;
  p.hourglass_control = scene.solver.hourglass_control;
  p.corrected_divergence = scene.solver.corrected_divergence;
  p.xsph = scene.solver.xsph;
  p.kernel = to_kernel(scene.solver.kernel);
  p.equation_of_state.law = scene.solver.equation_of_state == "tait" ? PressureLaw::tait : PressureLaw::linear;
  p.equation_of_state.background_pressure = scene.solver.background_pressure;
  p.density = to_density_form(scene.solver.density);
  p.period = to_period(scene);
  for (const EmitterSettings& e : scene.emitters) p.emitters.push_back(to_emitter(scene, e));
  for (const OutflowSettings& o : scene.outflows) p.outflows.push_back({{*o.lower, *o.upper}, o.removes == "outside"});
  set_heat_exchange(scene, p);
  p.courant = scene.time_step.courant;
  p.min_time_step = scene.time_step.min_time_step;
  Box3 reached = scene_bounds;
  for (const EmitterSettings& e : scene.emitters) {
    const Vec3 pile = Vec3::Constant(e.radius + pile_size(scene, e));
    reached.extend(e.position - pile);
    reached.extend(e.position + pile);
  }
  const Vec3 margin = Vec3::Constant(10.0 * reached.extent().maxCoeff());
  p.domain.lower = scene.domain.lower.value_or(reached.lower - margin);
  p.domain.upper = scene.domain.upper.value_or(reached.upper + margin);
}

}  // namespace

std::vector<TriangleMesh> import_placed_bodies(const Scene& scene) {
  std::vector<TriangleMesh> meshes;
  for (std::size_t k = 0; k < scene.bodies.size(); ++k)
    meshes.push_back(blame(scene.places, fmt::format("body.{}.mesh", k), [&] {
      return import_placed(scene, scene.bodies[k].mesh, scene.bodies[k].placement, validate_mesh);
    }));
  return meshes;
}

TriangleMesh import_placed_collider(const Scene& scene, std::size_t k) {
  const ColliderSettings& collider = scene.colliders[k];
  return blame(scene.places, fmt::format("collider.{}.mesh", k), [&] {
    return import_placed(scene, collider.mesh, collider.placement, validate_surface, collider.terrain);
  });
}

double pile_size(const Scene& scene, const EmitterSettings& emitter) {
  const double shot_end = (scene.shot.frames - 1) / scene.shot.fps;
  const double seconds = std::min(emitter.end.value_or(shot_end), shot_end) - emitter.start;
  return std::cbrt(emitter.flow_rate * std::max(0.0, seconds));
}

double count_poured(const SimulationSetup& setup, double seconds) {
  double volume = 0.0;
  for (const Emitter<3>& e : setup.parameters.emitters)
    volume += e.flow_rate * std::max(0.0, std::min(e.end, seconds) - e.start);
  return volume / setup.parameters.particle_volume;
}

Rheology to_rheology(const ViscositySettings& s, const std::optional<HeatProperties>& heat) {
  Rheology r;
  if (s.law == "smd") {
    r.yield_stress = *s.yield_stress;
    r.consistency = *s.consistency;
    r.index = *s.index;
    r.jump_number = s.jump_number;
    r.rest_viscosity = s.rest_viscosity;
  } else {
    r.consistency = s.law == "newtonian" ? *s.viscosity : ThermalRange{0.0, 0.0};
  }
  if (!heat) return r;
  for (ThermalRange* property : {&r.yield_stress, &r.consistency, r.jump_number ? &*r.jump_number : nullptr,
                                 r.rest_viscosity ? &*r.rest_viscosity : nullptr}) {
    if (!property) continue;
    property->coldest = heat->cold;
    property->hottest = heat->hot;
  }
  return r;
}

SimulationSetup build_simulation(const Scene& scene) {
  SimulationSetup setup;
  const std::vector<PlacedBody> bodies = import_bodies(scene, setup.warnings);
  refuse_bodies_under_ground(scene, bodies);
  refuse_bodies_outside_period(scene, to_period(scene), bodies);
  const std::vector<Seeds> seeds = seed_bodies(scene, bodies);
  std::vector<std::size_t> first{0};  // particle of each body
  for (std::size_t k = 0; k < bodies.size(); ++k) {
    append_body(scene, k, bodies[k], seeds[k], setup.particles);
    first.push_back(setup.particles.size());
    setup.body_volume += bodies[k].volume;
    setup.body_bounds.extend(bodies[k].bounds.lower);
    setup.body_bounds.extend(bodies[k].bounds.upper);
  }
  for (const MaterialSettings& m : scene.materials)
    setup.materials.push_back({m.name, m.density, to_rheology(m.viscosity, m.heat), m.heat});

  Box3 scene_bounds = setup.body_bounds;
  for (const EmitterSettings& e : scene.emitters) scene_bounds.extend(e.position);
  const Vec3 middle = scene_bounds.centre();
  for (std::size_t k = 0; k < scene.colliders.size(); ++k) {
    const ColliderSettings& collider = scene.colliders[k];
    if (collider.mesh == "ground") {
      scene_bounds.extend(Vec3(middle[0], collider.ground_height, middle[2]));
      setup.colliders.emplace_back();
    } else {
      setup.colliders.push_back(import_placed_collider(scene, k));
      wind_collider(scene, k, setup.colliders.back(), setup.warnings);
    }
    TriangleMesh& mesh = setup.colliders.back();
    setup.obstacles.push_back(to_obstacle(collider, mesh));
    if (collider.rigid())
      setup.obstacles.back().mass = blame(scene.places, fmt::format("collider.{}.mesh", k),
                                          [&] { return weigh_body(collider, mesh, setup.warnings); });
    const Motion<3>& motion = setup.obstacles.back().motion;
    const TriangleMesh at_start = motion.still() ? mesh : moved(mesh, pose_at(motion, 0.0));
    for (const Vec3& x : at_start.vertices) scene_bounds.extend(x);
    // The places that it is taken to.
    for (const Keyframe<3>& key : motion.keyframes)
      for (const Vec3& x : moved(mesh, pose_at(motion, key.time)).vertices) scene_bounds.extend(x);
  }
  prepare_colliders(scene, first, setup);
  set_parameters(scene, scene_bounds, setup);
  place_vents(scene, setup);

  const Box3& domain = setup.parameters.domain;
  for (std::size_t k = 0; k < setup.colliders.size(); ++k)
    if (scene.colliders[k].mesh == "ground")
      setup.colliders[k] = make_ground(scene.colliders[k].ground_height, domain.extent().maxCoeff(), domain.centre());
  return setup;
}

Colliders<3> build_colliders(const SimulationSetup& setup) {
  Colliders<3> colliders;
  for (std::size_t k = 0; k < setup.colliders.size(); ++k) {
    const TriangleMesh& mesh = setup.colliders[k];
    std::vector<Simplex<3>> triangles;
    triangles.reserve(mesh.triangles.size());
    for (const auto& t : mesh.triangles)
      triangles.push_back({mesh.vertices[t[0]], mesh.vertices[t[1]], mesh.vertices[t[2]]});
    Obstacle<3> obstacle = setup.obstacles[k];
    obstacle.facets = std::move(triangles);
    colliders.add(std::move(obstacle));
  }
  return colliders;
}

}  // namespace smelt
