#include "scenes/validate_scene.h"

#include "core/error.h"
#include "core/sph/rheology.h"
#include "io/extension.h"
#include "io/height_field.h"
#include "render/film.h"
#include "scenes/nearest_word.h"
#include "scenes/scene_reader.h"

#include <algorithm>
#include <set>

namespace smelt {

void SceneErrors::add(const std::string& key_path, const std::string& what) {
  const KeyPlaces::Place place = places_.find(key_path);
  entries_.push_back({place.line, fmt::format("{}: {}", place.text, what)});
}

void SceneErrors::throw_if_any() const {
  if (entries_.empty()) return;
  std::vector<Entry> sorted = entries_;
  std::stable_sort(sorted.begin(), sorted.end(), [](const Entry& a, const Entry& b) { return a.line < b.line; });
  std::string text = fmt::format("{} error{} in {}:", sorted.size(), sorted.size() == 1 ? "" : "s", places_.file());
  for (const Entry& entry : sorted) text += "\n  " + entry.text;
  throw Error(text);
}

namespace {

void validate_viscosity(const ViscositySettings& s, const std::string& path, SceneErrors& errors) {
  const auto refuse = [&](bool given, const char* key) {
    if (given) errors.add(fmt::format("{}.{}", path, key), fmt::format("a {} fluid has none; leave it out", s.law));
  };
  const auto require = [&](bool given, const char* key) {
    if (!given) errors.add(fmt::format("{}.{}", path, key), fmt::format("missing: law \"{}\" needs it", s.law));
  };
  if (s.law == "smd") {
    refuse(s.viscosity.has_value(), "viscosity_Pa_s");
    require(s.yield_stress.has_value(), "yield_stress_Pa");
    require(s.consistency.has_value(), "consistency_Pa_sn");
    require(s.index.has_value(), "index");
    if (s.jump_number && s.rest_viscosity)
      errors.add(path + ".rest_viscosity_Pa_s",
                 "give jump_number or rest_viscosity_Pa_s, not both: one follows from the other");
    const bool yields = s.yield_stress && !is_zero(*s.yield_stress);
    if (yields && !s.jump_number && !s.rest_viscosity)
      errors.add(path + ".jump_number", "missing: a yield stress needs jump_number or rest_viscosity_Pa_s");
    return;
  }
  if (s.law == "newtonian")
    require(s.viscosity.has_value(), "viscosity_Pa_s");
  else
    refuse(s.viscosity.has_value(), "viscosity_Pa_s");
  refuse(s.yield_stress.has_value(), "yield_stress_Pa");
  refuse(s.consistency.has_value(), "consistency_Pa_sn");
  refuse(s.index.has_value(), "index");
  refuse(s.jump_number.has_value(), "jump_number");
  refuse(s.rest_viscosity.has_value(), "rest_viscosity_Pa_s");
}

void validate_heat(const HeatProperties& s, bool has_ambient, const std::string& path, SceneErrors& errors) {
  if (s.hot < s.cold || (s.hot == s.cold && !(s.latent_heat > 0.0)))
    errors.add(
        path + ".hot_K",
        fmt::format("must be above cold_K = {}, is {}; only with latent_heat_J_kg may they be equal", s.cold, s.hot));
  if (s.latent_heat > 0.0 && !(s.specific_heat > 0.0))
    errors.add(path + ".latent_heat_J_kg", "needs specific_heat_J_kgK beside it");
  if (s.emissivity > 0.0 && !(s.specific_heat > 0.0))
    errors.add(path + ".emissivity", "needs specific_heat_J_kgK beside it");
  if (s.emissivity > 0.0 && !has_ambient)
    errors.add(path + ".emissivity", "needs an [ambient] with the temperature_K that is radiated to");
}

void validate_thermal_table(const ThermalRange& s, const std::string& path, SceneErrors& errors) {
  if (s.temperature.size() != s.value.size())
    errors.add(path + ".values", fmt::format("must be as many as temperature_K, which has {}, are {}",
                                             s.temperature.size(), s.value.size()));
  if (s.temperature.size() < 2)
    errors.add(path + ".temperature_K",
               fmt::format("must hold at least two temperatures, holds {}", s.temperature.size()));
  for (std::size_t k = 1; k < s.temperature.size(); ++k)
    if (!(s.temperature[k] > s.temperature[k - 1]))
      return errors.add(path + ".temperature_K", fmt::format("must rise from one to the next, but {} is followed by {}",
                                                             s.temperature[k - 1], s.temperature[k]));
}

void validate_thermal(const std::optional<ThermalRange>& value, const std::optional<HeatProperties>& heat,
                      const std::string& path, SceneErrors& errors) {
  if (!value || (value->law == ThermalLaw::range && value->cold == value->hot)) return;
  if (!heat) return errors.add(path, "follows temperature, but the material has no heat");
  if (value->law == ThermalLaw::table) validate_thermal_table(*value, path, errors);
  if (value->law == ThermalLaw::exponential && !(heat->hot > heat->cold))
    errors.add(path, fmt::format("an exponential holds from heat.cold_K to heat.hot_K, which are both {}", heat->cold));
}

void validate_material(const MaterialSettings& m, bool has_ambient, const std::string& path, SceneErrors& errors) {
  validate_viscosity(m.viscosity, path + ".viscosity", errors);
  if (m.heat) validate_heat(*m.heat, has_ambient, path + ".heat", errors);
  const std::string of = path + ".viscosity.";
  validate_thermal(m.viscosity.viscosity, m.heat, of + "viscosity_Pa_s", errors);
  validate_thermal(m.viscosity.yield_stress, m.heat, of + "yield_stress_Pa", errors);
  validate_thermal(m.viscosity.consistency, m.heat, of + "consistency_Pa_sn", errors);
  validate_thermal(m.viscosity.jump_number, m.heat, of + "jump_number", errors);
  validate_thermal(m.viscosity.rest_viscosity, m.heat, of + "rest_viscosity_Pa_s", errors);
}

/// Whether a property is 0 at some temperature.
bool reaches_zero(const ThermalRange& s) {
  if (s.law == ThermalLaw::range) return s.cold == 0.0 || s.hot == 0.0;
  if (s.law == ThermalLaw::table) return std::find(s.value.begin(), s.value.end(), 0.0) != s.value.end();
  return s.reference == 0.0;
}

/// A power-law fluid at rest has no finite viscosity; a stress that follows the strain rate at once would need it.
void validate_power_law(const Scene& scene, SceneErrors& errors) {
  if (scene.solver.shear_wave_speed.value_or(1.0) > 0.0) return;
  for (const MaterialSettings& m : scene.materials)
    if (const ViscositySettings& s = m.viscosity;
        s.law == "smd" && s.yield_stress && reaches_zero(*s.yield_stress) && s.index.value_or(1.0) != 1.0)
      errors.add("solver.shear_wave_speed_m_s",
                 fmt::format("must be above 0, or left out: material \"{}\" is a power-law fluid where its "
                             "yield_stress_Pa is 0, which has no finite viscosity at rest",
                             m.name));
}

void validate_placement(const PlacementSettings& s, const std::string& path, SceneErrors& errors) {
  if (s.scale && s.height) errors.add(path + ".height_m", "give scale or height_m, not both");
}

void validate_mesh_file(const Scene& scene, const std::string& mesh, const std::string& path, SceneErrors& errors) {
  if (mesh.empty()) return;
  try {
    find_mesh(scene, mesh);
  } catch (const Error& error) {
    errors.add(path + ".mesh", error.what());
  }
}

/// What is poured or filled in must be of a material that is there, and have a temperature where that has heat.
void validate_substance(const Scene& scene, const std::string& material_name, const std::string& path,
                        bool has_temperature, SceneErrors& errors) {
  std::vector<std::string> names;
  for (const auto& m : scene.materials) names.push_back(m.name);
  const auto found = std::find(names.begin(), names.end(), material_name);
  if (found == names.end()) {
    if (material_name.empty()) return;
    const auto nearest = nearest_word(material_name, names);
    errors.add(path + ".material", fmt::format("there is no [[material]] named \"{}\"; {}", material_name,
                                               nearest ? fmt::format("did you mean \"{}\"?", *nearest)
                                                       : fmt::format("there are: {}", fmt::join(names, ", "))));
    return;
  }
  const MaterialSettings& material = scene.materials[static_cast<std::size_t>(found - names.begin())];
  if (material.heat && !has_temperature)
    errors.add(path + ".temperature_K", fmt::format("missing: material \"{}\" has heat", material.name));
  if (!material.heat && has_temperature)
    errors.add(path + ".temperature_K",
               fmt::format("material \"{}\" has no heat; give it one, or leave this out", material.name));
}

void validate_bodies(const Scene& scene, SceneErrors& errors) {
  for (std::size_t k = 0; k < scene.bodies.size(); ++k) {
    const BodySettings& body = scene.bodies[k];
    const std::string path = fmt::format("body.{}", k);
    validate_placement(body.placement, path, errors);
    validate_mesh_file(scene, body.mesh, path, errors);
    validate_substance(scene, body.material, path, body.temperature.has_value(), errors);
  }
}

void validate_keyframes(const ColliderSettings& s, const std::string& path, SceneErrors& errors) {
  if (s.keyframes.empty()) return;
  if (s.keyframes.size() == 1)
    errors.add(path + ".keyframes",
               "one keyframe moves nothing: give two or more, or place the collider with translate_m and rotate_deg");
  if (!s.velocity.isZero(0.0)) errors.add(path + ".velocity_m_s", "give keyframes or a velocity, not both");
  if (!s.angular_velocity.isZero(0.0))
    errors.add(path + ".angular_velocity_rad_s", "give keyframes or an angular velocity, not both");
  for (std::size_t k = 1; k < s.keyframes.size(); ++k) {
    const KeyframeSettings &before = s.keyframes[k - 1], &key = s.keyframes[k];
    const std::string here = fmt::format("{}.keyframes.{}", path, k);
    if (!(key.time > before.time))
      errors.add(here + ".time_s",
                 fmt::format("must be later than the keyframe before, at {} s, is {}; put the keyframes in order",
                             before.time, key.time));
    const double turn = (key.rotate_deg - before.rotate_deg).cwiseAbs().maxCoeff();
    if (turn >= 180.0)
      errors.add(
          here + ".rotate_deg",
          fmt::format("turns by {} degrees from the keyframe before, and half a turn or more may go either way: put "
                      "keyframes in between, or use angular_velocity_rad_s",
                      turn));
  }
}

void validate_emitter(const Scene& scene, const EmitterSettings& s, const std::string& path, SceneErrors& errors) {
  validate_substance(scene, s.material, path, s.temperature.has_value(), errors);
  if (!(s.direction.norm() > 0.0)) errors.add(path + ".direction", "must not be zero");
  if (s.end && !(*s.end > s.start))
    errors.add(path + ".end_s", fmt::format("must be after start_s = {}, is {}", s.start, *s.end));
  if (scene.particles.spacing && s.radius > 0.0 && s.radius < *scene.particles.spacing)
    errors.add(
        path + ".radius_m",
        fmt::format("must be at least the spacing of particles, {} m, is {}; widen the vent, or take a smaller spacing",
                    *scene.particles.spacing, s.radius));
  if (scene.solver.density != "continuity")
    errors.add(path,
               fmt::format(
                   "goes with [solver] density = \"continuity\" alone; \"{}\" would see the back of the vent as a free "
                   "surface",
                   scene.solver.density));
  if (scene.periodic) errors.add(path, "a [periodic] box has none: what comes in could not go out of it");
}

void validate_outflow(const OutflowSettings& s, const std::string& path, SceneErrors& errors) {
  if (!s.lower) errors.add(path + ".lower_m", "missing: lowest corner of the box");
  if (!s.upper) errors.add(path + ".upper_m", "missing: highest corner of the box");
  if (s.lower && s.upper && !((*s.upper - *s.lower).array() > 0.0).all())
    errors.add(path + ".upper_m", "must be above lower_m along every axis");
}

void validate_terrain(const ColliderSettings& s, const std::string& path, SceneErrors& errors) {
  const std::string extension = lower_case_extension(s.mesh);
  if (!is_height_field(s.mesh)) {
    if (s.terrain)
      errors.add(path + ".terrain",
                 fmt::format("\"{}\" is no height field (.asc, .csv or .png); leave this out", s.mesh));
    return;
  }
  if (extension != ".asc" && !(s.terrain && s.terrain->cell))
    errors.add(path + ".terrain.cell_m",
               fmt::format("missing: a {} file does not say how far apart its heights are", extension));
  if (extension == ".png" && s.terrain && !(s.terrain->highest > s.terrain->lowest))
    errors.add(path + ".terrain.highest_m",
               fmt::format("must be above lowest_m = {}, is {}", s.terrain->lowest, s.terrain->highest));
}

void validate_collider(const ColliderSettings& s, bool hot, const std::string& path, SceneErrors& errors) {
  if (s.mesh == "ground") {
    const auto refuse = [&](bool given, const char* key) {
      if (given)
        errors.add(path + key,
                   "the ground has no end and cannot move; its surface may (surface_velocity_m_s), or a mesh");
    };
    refuse(!s.velocity.isZero(0.0), ".velocity_m_s");
    refuse(!s.angular_velocity.isZero(0.0), ".angular_velocity_rad_s");
    refuse(!s.keyframes.empty(), ".keyframes");
    refuse(s.mass.has_value(), ".mass_kg");
    refuse(s.density.has_value(), ".density_kg_m3");
    const PlacementSettings& p = s.placement;
    if (p.scale || p.height || p.stand_at_y || !p.translate.isZero(0.0) || !p.rotate_deg.isZero(0.0))
      errors.add(path + ".translate_m", "the ground is placed by its height alone: give ground_y_m, or a mesh");
  } else if (s.ground_height != 0.0) {
    errors.add(path + ".ground_y_m", "is of the `ground`; a mesh is placed with translate_m or stand_at_y_m");
  }
  if (s.mass && s.density)
    errors.add(path + ".density_kg_m3", "give mass_kg or density_kg_m3, not both: one follows from the other");
  if (s.rigid() && !s.keyframes.empty())
    errors.add(path + ".keyframes", "a rigid body goes where it is pushed: leave the keyframes out, or its mass");
  if (s.rigid() && s.pivot)
    errors.add(path + ".pivot_m", "a rigid body turns about its centre of mass: leave this out");
  validate_keyframes(s, path, errors);
  if (s.temperature && !hot)
    errors.add(path + ".temperature_K", "no material has heat; give it one, or leave this out");
  if (s.temperature && !s.wall)
    errors.add(path + ".temperature_K", "heat passes through walls only; set wall = true, or leave this out");
}

void validate_ambient(const Scene& scene, std::size_t n_hot, SceneErrors& errors) {
  const AmbientSettings& s = *scene.ambient;
  if (!s.temperature) errors.add("ambient.temperature_K", "missing: of the air and of what is radiated to");
  if (n_hot == 0) return errors.add("ambient", "no material has heat; give it one, or leave this out");
  const bool radiates = std::any_of(scene.materials.begin(), scene.materials.end(),
                                    [](const auto& m) { return m.heat && m.heat->emissivity > 0.0; });
  if (s.heat_transfer == 0.0 && !radiates)
    errors.add("ambient.heat_transfer_W_m2K",
               "is 0 and no material has an emissivity, so nothing is lost; give one of them, or leave [ambient] out");
}

void validate_heat_source(const HeatSourceSettings& s, std::size_t n_hot, const std::string& path,
                          SceneErrors& errors) {
  if (n_hot == 0) return errors.add(path, "no material has heat; give it one, or leave this out");
  if (s.power && (s.temperature || s.heat_transfer))
    errors.add(path + ".power_W", "give power_W, or temperature_K and heat_transfer_W_m2K, not both");
  if (!s.power && !s.temperature)
    errors.add(path + ".power_W", "missing: give power_W, or temperature_K and heat_transfer_W_m2K");
  if (!s.power && s.temperature && !s.heat_transfer)
    errors.add(path + ".heat_transfer_W_m2K", "missing: how much passes from the gas of temperature_K");
  if (s.until && !(*s.until > s.from))
    errors.add(path + ".until_s", fmt::format("must be after from_s = {}, is {}", s.from, *s.until));
}

/// Energies want the specific heat of all materials.
void validate_specific_heats(const Scene& scene, SceneErrors& errors) {
  const auto known = [](const MaterialSettings& m) { return m.heat && m.heat->specific_heat > 0.0; };
  const bool some = std::any_of(scene.materials.begin(), scene.materials.end(), known);
  const bool exchange = scene.ambient || !scene.heat_sources.empty();
  for (std::size_t k = 0; k < scene.materials.size(); ++k) {
    const MaterialSettings& m = scene.materials[k];
    if (!m.heat || known(m) || !(some || exchange)) continue;
    errors.add(fmt::format("material.{}.heat.specific_heat_J_kgK", k),
               fmt::format("missing: {}",
                           some ? "another material has it, and heat passes between them"
                                : "[ambient] and [[heat_source]] exchange energy, which it turns into temperature"));
  }
}

void validate_periodic(const PeriodicSettings& s, SceneErrors& errors) {
  if (!s.lower) errors.add("periodic.lower_m", "missing: lowest corner of the box that repeats");
  if (!s.upper) errors.add("periodic.upper_m", "missing: highest corner of the box that repeats");
  if (!s.lower || !s.upper) return;
  for (int a = 0; a < 3; ++a)
    if (s.axes.find("xyz"[a]) != std::string::npos && !((*s.upper)[a] > (*s.lower)[a]))
      errors.add("periodic.upper_m",
                 fmt::format("must be above lower_m along {}, is {} and {}", "xyz"[a], (*s.upper)[a], (*s.lower)[a]));
}

void validate_camera(const Scene& scene, SceneErrors& errors) {
  const CameraSettings& s = scene.camera;
  if (s.eye && s.target && (*s.eye - *s.target).norm() < 1e-9)
    errors.add("camera.target_m", "is the eye itself; choose another point to look at");
  if (s.focal_length && s.vertical_fov_deg)
    errors.add("camera.focal_length_m",
               "give vertical_fov_deg or focal_length_m, not both: one follows from the other");
  if (s.focus_distance && !s.f_number)
    errors.add("camera.focus_distance_m", "without f_number all is sharp; give one, or leave this out");
  for (std::size_t k = 0; k < s.keyframes.size(); ++k) {
    const CameraKeyframeSettings& key = s.keyframes[k];
    const std::string path = fmt::format("camera.keyframes.{}", k);
    if (k > 0 && !(key.time > s.keyframes[k - 1].time))
      errors.add(path + ".time_s", fmt::format("must be later than the keyframe before, at {} s, is {}",
                                               s.keyframes[k - 1].time, key.time));
    if (key.eye && key.target && (*key.eye - *key.target).norm() < 1e-9)
      errors.add(path + ".target_m", "is the eye itself; choose another point to look at");
  }
  const double pixels = static_cast<double>(s.width) * s.height;
  if (pixels > static_cast<double>(max_picture_pixels))
    errors.add("camera.width",
               fmt::format("{} x {} pixels would take {:.1f} GB of memory; at most {} pixels in all are drawn", s.width,
                           s.height, pixels * static_cast<double>(film_bytes_per_pixel) * 1e-9, max_picture_pixels));
}

void validate_surface(const Scene& scene, SceneErrors& errors) {
  const SurfacingOptions& s = scene.surface;
  const SurfaceOutputs& outputs = scene.surface_outputs;
  if (s.cell_over_spacing > most_cell_over_kernel * s.kernel_over_spacing)
    errors.add("surface.cell_over_spacing",
               fmt::format("must be at most {} times kernel_over_spacing = {}, or cells pass particles by; is {}",
                           most_cell_over_kernel, s.kernel_over_spacing, s.cell_over_spacing));
  if (!outputs.vertex_colours) return;
  if (std::none_of(scene.materials.begin(), scene.materials.end(), [](const auto& m) { return m.heat.has_value(); }))
    errors.add("surface.vertex_colours",
               "follow temperature, but no material has heat; give it one, or leave this out");
  if (!(outputs.colour_hot > outputs.colour_cold))
    errors.add("surface.colour_hot_K",
               fmt::format("must be above colour_cold_K = {}, is {}", outputs.colour_cold, outputs.colour_hot));
}

void validate_environment(const Scene& scene, SceneErrors& errors) {
  const EnvironmentSettings& s = scene.environment;
  if (s.kind != "image") {
    if (!s.image.empty())
      errors.add("environment.image", fmt::format("goes with kind = \"image\" alone, which is \"{}\"", s.kind));
    return;
  }
  if (s.image.empty()) return errors.add("environment.image", "missing: the panorama's file, .exr or .hdr");
  try {
    find_mesh(scene, s.image);
  } catch (const Error& error) {
    errors.add("environment.image", error.what());
  }
}

void validate_look(const Scene& scene, SceneErrors& errors) {
  const bool hot = !scene.materials.empty() && std::all_of(scene.materials.begin(), scene.materials.end(),
                                                           [](const auto& m) { return m.heat.has_value(); });
  if (scene.look.material == "lava" && !hot)
    errors.add("look.material",
               "lava glows by its temperature, but the material has no heat; give it one, or take rock");
  if (scene.look.black_body && !hot)
    errors.add("look.black_body",
               "glows by the temperature, but the material has no heat; give it one, or leave this out");
  if (scene.look.crust && !scene.particles.rest_position)
    errors.add("look.crust", "moves with the material: set rest_position = true in [particles] too");
}

}  // namespace

void validate_scene(const Scene& scene, SceneErrors& errors) {
  if (scene.particles.count && scene.particles.spacing)
    errors.add("particles.spacing_m", "give count or spacing_m, not both");
  if (!scene.particles.count && !scene.particles.spacing)
    errors.add("particles.count", "missing: give count or spacing_m");
  if (scene.shot.name.find('/') != std::string::npos) errors.add("shot.name", "names a folder and must not hold a /");

  if (scene.materials.empty()) errors.add("material", "missing: a scene needs at least one [[material]]");
  if (scene.bodies.empty() && scene.emitters.empty())
    errors.add("body", "missing: a scene needs at least one [[body]] or [[emitter]]");
  if (scene.bodies.empty() && scene.particles.count)
    errors.add("particles.count", "counts the particles of bodies, and there are none; give spacing_m");
  if (scene.materials.size() > 255)
    errors.add("material", fmt::format("up to 255 are possible, there are {}", scene.materials.size()));
  std::set<std::string> names;
  std::size_t n_hot = 0;
  for (std::size_t k = 0; k < scene.materials.size(); ++k) {
    const std::string path = fmt::format("material.{}", k);
    validate_material(scene.materials[k], scene.ambient.has_value(), path, errors);
    if (!names.insert(scene.materials[k].name).second && !scene.materials[k].name.empty())
      errors.add(path + ".name", fmt::format("another material is called \"{}\" too", scene.materials[k].name));
    if (scene.materials[k].heat) ++n_hot;
  }
  if (n_hot != 0 && n_hot != scene.materials.size())
    errors.add("material", "either all materials of a scene have heat or none: heat would stop at the ones without");
  validate_power_law(scene, errors);
  validate_bodies(scene, errors);

  for (std::size_t k = 0; k < scene.colliders.size(); ++k) {
    const std::string path = fmt::format("collider.{}", k);
    validate_placement(scene.colliders[k].placement, path, errors);
    validate_collider(scene.colliders[k], n_hot > 0, path, errors);
    if (scene.colliders[k].mesh != "ground") validate_mesh_file(scene, scene.colliders[k].mesh, path, errors);
    validate_terrain(scene.colliders[k], path, errors);
  }
  for (std::size_t k = 0; k < scene.emitters.size(); ++k)
    validate_emitter(scene, scene.emitters[k], fmt::format("emitter.{}", k), errors);
  if (scene.emitters.size() > 255)
    errors.add("emitter", fmt::format("up to 255 are possible, there are {}", scene.emitters.size()));
  for (std::size_t k = 0; k < scene.outflows.size(); ++k)
    validate_outflow(scene.outflows[k], fmt::format("outflow.{}", k), errors);
  validate_specific_heats(scene, errors);
  if (scene.ambient) validate_ambient(scene, n_hot, errors);
  for (std::size_t k = 0; k < scene.heat_sources.size(); ++k)
    validate_heat_source(scene.heat_sources[k], n_hot, fmt::format("heat_source.{}", k), errors);
  if (scene.domain.lower && scene.domain.upper && !((*scene.domain.upper - *scene.domain.lower).array() > 0.0).all())
    errors.add("domain.upper_m", "must be above lower_m along every axis");
  if (scene.periodic) validate_periodic(*scene.periodic, errors);
  validate_camera(scene, errors);
  for (std::size_t k = 0; k < scene.lights.size(); ++k)
    if ((scene.lights[k].target - scene.lights[k].position).norm() < 1e-9)
      errors.add(fmt::format("light.{}.target_m", k), "is the lamp's own position; choose the point it faces");
  validate_surface(scene, errors);
  validate_environment(scene, errors);
  validate_look(scene, errors);
  if (scene.render.png_bits != 8 && scene.render.png_bits != 16)
    errors.add("render.png_bits", fmt::format("must be 8 or 16, is {}", scene.render.png_bits));
  if (scene.look.cold_K && scene.look.hot_K && !(*scene.look.hot_K > *scene.look.cold_K))
    errors.add("look.hot_K", fmt::format("must be above cold_K = {}, is {}", *scene.look.cold_K, *scene.look.hot_K));
}

}  // namespace smelt
