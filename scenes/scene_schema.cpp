#include "scenes/schema.h"

#include <cmath>

namespace smelt {

namespace {

// Adapters between the visitor's types and the settings' own.

void visit_int(SchemaVisitor& v, const Key& key, int& value, const Limits& limits, bool required = false) {
  std::int64_t wide = value;
  required ? v.required_integer(key, wide, limits) : v.integer(key, wide, limits);
  value = static_cast<int>(wide);
}

template <typename T>
void visit_tables(SchemaVisitor& v, const Key& key, std::vector<T>& values, const std::function<void(T&)>& visit) {
  v.tables(
      key, [&] { return values.size(); }, [&](std::size_t n) { values.resize(n); },
      [&](std::size_t k) { visit(values[k]); });
}


// ------------------------------------------------------------------------------------------------------------- simulation

void visit_viscosity(SchemaVisitor& v, ViscositySettings& s) {
  v.choice({"law", "`smd`: Souza Mendes-Dutra viscoplastic; `newtonian`; `inviscid`"}, s.law, {"smd", "newtonian", "inviscid"});
  v.thermal({"viscosity_Pa_s", "viscosity eta of a `newtonian` fluid", "required by `newtonian`, refused otherwise"}, s.viscosity,
            positive);
  v.thermal({"yield_stress_Pa", "`smd`: stress tau0 below which it hardly flows; 0 is a power-law fluid", "required by `smd`"},
            s.yield_stress, non_negative);
  v.thermal({"consistency_Pa_sn", "`smd`: consistency K", "required by `smd`"}, s.consistency, positive);
  v.number({"index", "`smd`: flow index n; below 1 it thins as it shears", "required by `smd`"}, s.index, {0.0, 1.0, true});
  v.thermal({"jump_number",
             "`smd`: J = eta0 gdot1/tau0 - 1 with gdot1 = (tau0/K)^(1/n): how much stiffer it is at rest than at the end of yielding",
             "`smd` with a yield stress needs this or rest_viscosity_Pa_s, not both"},
            s.jump_number, non_negative);
  v.thermal({"rest_viscosity_Pa_s", "`smd`: viscosity eta0 at rest", "see jump_number"}, s.rest_viscosity, positive);
}

void visit_heat(SchemaVisitor& v, HeatProperties& s) {
  v.required_number({"diffusivity_m2_s", "thermal diffusivity k = conductivity/(density specific heat)"}, s.diffusivity, non_negative);
  v.required_number({"cold_K", "at and below, it is solid and the cold values hold"}, s.cold, non_negative);
  v.required_number({"hot_K", "at and above, it is liquid and the hot values hold; above cold_K, or with latent heat the same: a sharp melting point"},
                    s.hot, non_negative);
  std::optional<double> specific_heat;
  if (s.specific_heat > 0.0) specific_heat = s.specific_heat;
  v.number({"specific_heat_J_kgK", "specific heat c_p", "not known, and then neither is any energy"}, specific_heat, positive);
  s.specific_heat = specific_heat.value_or(0.0);
  v.number({"latent_heat_J_kg", "latent heat L of melting, taken up evenly from cold_K to hot_K; needs the specific heat"}, s.latent_heat,
           non_negative);
  v.number({"emissivity", "of the free surface, which radiates to [ambient]; needs the specific heat"}, s.emissivity, unit_interval);
}

void visit_material(SchemaVisitor& v, MaterialSettings& s) {
  v.required_text({"name", "what bodies call it"}, s.name);
  v.required_number({"density_kg_m3", "density at rest"}, s.density, positive);
  v.table({"viscosity",
           "the flow law. Where the material has `heat`, a value may follow temperature: `{ cold = , hot = }` runs linearly from cold_K to hot_K; "
           "`{ temperature_K = [ ], values = [ ] }` through points, geometrically between values above 0; `{ reference = , reference_K = , "
           "rate_1_K = }` is reference exp(-rate (T - reference_K)), T kept from cold_K to hot_K"},
          nullptr, [&] { visit_viscosity(v, s.viscosity); });
  bool has_heat = s.heat.has_value();
  HeatProperties heat = s.heat.value_or(HeatProperties{});
  v.table({"heat", "conduction and melting; leave it out and nothing thermal exists"}, &has_heat, [&] { visit_heat(v, heat); });
  if (has_heat) s.heat = heat;
}

void visit_placement(SchemaVisitor& v, PlacementSettings& s) {
  v.number({"scale", "the mesh's coordinates times this are metres", "1"}, s.scale, positive);
  v.number({"height_m", "scales the mesh so that it is this tall; instead of `scale`", "not used"}, s.height, positive);
  v.vector({"rotate_deg", "turns about x, then y, then z"}, s.rotate_deg, any_number);
  v.vector({"translate_m", "moves after scaling and turning"}, s.translate, any_number);
  v.number({"stand_at_y_m", "then moves along y so that the lowest point is here", "not moved"}, s.stand_at_y, any_number);
}

void visit_body(SchemaVisitor& v, BodySettings& s) {
  v.required_text({"mesh", "file: .obj .ply .stl .off .gltf .glb, from the scene's folder or smelt's own"}, s.mesh);
  v.required_text({"material", "name of a [[material]]"}, s.material);
  visit_placement(v, s.placement);
  v.vector({"velocity_m_s", "at the start"}, s.velocity, any_number);
  std::optional<std::pair<double, double>> temperature;
  if (s.temperature) temperature = {s.temperature->bottom, s.temperature->top};
  v.range({"temperature_K", "at the start: a number, or `{ bottom = , top = }` for a linear rise over the body's height",
           "required where the material has heat, refused otherwise"},
          "bottom", "top", temperature, non_negative);
  if (temperature) s.temperature = VerticalRange{temperature->first, temperature->second};
}

void visit_terrain(SchemaVisitor& v, ColliderSettings& s) {
  bool given = s.terrain.has_value();
  TerrainSettings t = s.terrain.value_or(TerrainSettings{});
  v.table({"terrain", "of a `mesh` that is a height field. Its middle is put at x = z = 0, heights along y, its first row to the north (-z)"}, &given, [&] {
    v.number({"cell_m", "distance between heights", "the .asc file's; required for .csv and .png"}, t.cell, positive);
    v.number({"height_scale", ".asc, .csv: heights times this are metres"}, t.height_scale, positive);
    v.number({"lowest_m", ".png: height of black"}, t.lowest, any_number);
    v.number({"highest_m", ".png: height of white, above lowest_m"}, t.highest, any_number);
    visit_int(v, {"refine", "each cell is divided into this many along both sides, by a cubic through the heights"}, t.refine, {1, 32});
    v.boolean({"closed", "made a solid by walls down to a bottom; false: a sheet"}, t.closed);
    v.number({"depth_m", "of the bottom below the lowest height", "a tenth of the field's shorter side"}, t.depth, positive);
  });
  if (given) s.terrain = t;
}

void visit_collider(SchemaVisitor& v, ColliderSettings& s) {
  v.required_text({"mesh", "a mesh file, a height field (.asc .csv .png), or `ground`: a floor without end"}, s.mesh);
  visit_placement(v, s.placement);
  v.number({"ground_y_m", "height of the `ground`"}, s.ground_height, any_number);
  v.number({"friction", "share of the tangential velocity kept after a hit; 0 with restitution 0: no slip"}, s.friction, unit_interval);
  v.number({"restitution", "share of the normal velocity returned after a hit"}, s.restitution, unit_interval);
  v.boolean({"wall", "completes the density, pressure and shear of the fluid near it (friction 0: no slip, 1: free slip); false: it only "
                     "stops what hits it"},
            s.wall);
  v.vector({"velocity_m_s", "it moves with, from where it is at the start; not of the `ground`"}, s.velocity, any_number);
  v.vector({"angular_velocity_rad_s", "it spins with about an axis through the pivot, counter-clockwise seen from the vector's tip; not of the "
                                      "`ground`"},
           s.angular_velocity, any_number);
  v.number({"mass_kg",
            "makes it a rigid body, which gravity and what it meets push about: its mesh closed, velocity_m_s and "
            "angular_velocity_rad_s those at the start, about the centre of mass",
            "it goes where the scene says"},
           s.mass, positive);
  v.number({"density_kg_m3", "the same by the mesh's volume; instead of mass_kg", "see mass_kg"}, s.density, positive);
  v.vector({"pivot_m", "point it turns about, where it is before anything moves", "the middle of the placed mesh's box"}, s.pivot, any_number);
  v.choice({"interpolation", "between keyframes: `linear`: at a constant speed; `smooth`: starts and stops gently at each keyframe"},
           s.interpolation, {"linear", "smooth"});
  v.vector({"surface_velocity_m_s", "of its surface beyond that, as of a belt that stays where it is; its part along the surface"}, s.surface_velocity, any_number);
  v.number({"temperature_K", "heat passes between it and the fluid at it; only of a `wall`, in a scene with heat",
            "no heat passes"},
           s.temperature, non_negative);
  v.number({"until_s", "then it vanishes: a gate that opens", "it stays"}, s.until, positive);
  v.vector({"colour", "linear RGB in pictures"}, s.colour, unit_interval);
  v.choice({"material", "in pictures: `matte`, `plastic` (with a coat) or `metal`"}, s.material, {"matte", "plastic", "metal"});
  v.number({"roughness", "of plastic and metal in pictures: small mirrors, large is matt"}, s.roughness, {0.01, 1.0});
  visit_tables<KeyframeSettings>(
      v,
      {"keyframes",
       "where it is at given times, two or more, instead of velocity_m_s and angular_velocity_rad_s: "
       "`keyframes = [{ time_s = 0.0 }, { time_s = 0.5, translate_m = [0.0, -0.2, 0.0], rotate_deg = [0.0, 0.0, 90.0] "
       "}]`. It turns "
       "from one to the next by the shorter way, at an even rate; before the first and after the last, beyond the shot "
       "too, it "
       "stands still"},
      s.keyframes, [&](KeyframeSettings& k) {
        v.required_number({"time_s", "later than the keyframe before"}, k.time, any_number);
        v.vector({"translate_m", "of the pivot, from where the collider is placed"}, k.translate, any_number);
        v.vector({"rotate_deg", "about the pivot: about x, then y, then z"}, k.rotate_deg, any_number);
      });
  visit_terrain(v, s);
}

void visit_emitter(SchemaVisitor& v, EmitterSettings& s) {
  v.required_text({"material", "name of a [[material]]"}, s.material);
  v.vector({"position_m", "middle of the vent, above the ground; what comes in there is driven for a kernel's support (three spacings) along the direction, then free. A vent near the "
                          "ground is rooted in it"},
           s.position, any_number);
  v.vector({"direction", "of the flow, of any length"}, s.direction, any_number);
  v.required_number({"radius_m", "of the vent, at least a spacing"}, s.radius, positive);
  v.required_number({"flow_rate_m3_s", "volume poured in a second"}, s.flow_rate, positive);
  v.number({"temperature_K", "it comes in with", "required where the material has heat, refused otherwise"}, s.temperature, non_negative);
  v.number({"start_s", "when it begins"}, s.start, non_negative);
  v.number({"end_s", "when it ends, after start_s", "with the shot"}, s.end, positive);
}

void visit_outflow(SchemaVisitor& v, OutflowSettings& s) {
  v.choice({"removes", "particles `inside` the box, or those `outside`"}, s.removes, {"inside", "outside"});
  v.vector({"lower_m", "lowest corner", "required"}, s.lower, any_number);
  v.vector({"upper_m", "highest corner", "required"}, s.upper, any_number);
}

void visit_ambient(SchemaVisitor& v, std::optional<AmbientSettings>& ambient) {
  bool present = ambient.has_value();
  AmbientSettings s = ambient.value_or(AmbientSettings{});
  v.table({"ambient", "what free surfaces lose heat to, by convection here and by radiation where a material has an emissivity"}, &present, [&] {
    v.number({"temperature_K", "of the air and of what is radiated to", "required"}, s.temperature, non_negative);
    v.number({"heat_transfer_W_m2K", "h of convection, h (T - temperature_K): still air about 5 to 10, wind up to 100"}, s.heat_transfer,
             non_negative);
  });
  if (present) ambient = s;
}

void visit_heat_source(SchemaVisitor& v, HeatSourceSettings& s) {
  v.vector({"position_m", "where it is at the start"}, s.position, any_number);
  v.required_number({"radius_m", "R: heats free surfaces nearer than this, weighted with (1 - r^2/R^2)^2"}, s.radius, positive);
  v.number({"power_W", "all of it goes into the free surface within the radius", "give this, or temperature_K and heat_transfer_W_m2K"}, s.power,
           non_negative);
  v.number({"temperature_K", "of a flame's gas", "see power_W"}, s.temperature, non_negative);
  v.number({"heat_transfer_W_m2K", "h from that gas, at its middle: h (temperature_K - T)", "see power_W"}, s.heat_transfer, positive);
  v.vector({"velocity_m_s", "it moves with"}, s.velocity, any_number);
  v.number({"from_s", "it burns from this time on"}, s.from, non_negative);
  v.number({"until_s", "until this time", "to the end"}, s.until, positive);
}

void visit_simulation(SchemaVisitor& v, Scene& s) {
  v.table({"particles", "how finely bodies are divided: a cubic lattice fills them, and more particles the rims and fins that are too thin for it. Give `count` or `spacing_m`"}, nullptr, [&] {
    v.integer({"count", "particles in all bodies together, met to 1 %", "see spacing_m"}, s.particles.count, {1, 2e9});
    v.number({"spacing_m", "distance between particles", "follows from count"}, s.particles.spacing, positive);
    v.number({"jitter", "random shift at the start, as a fraction of the spacing"}, s.particles.jitter, {0.0, 0.49});
    v.integer({"seed", "of the jitter"}, s.particles.seed, {0, 9.0e15});
    v.number({"smoothing_length_over_spacing", "h over the spacing; 1.2 gives about 58 neighbours"},
             s.particles.smoothing_length_over_spacing, {0.9, 3.0});
    v.boolean({"rest_position", "caches carry where each particle was before the material moved, for textures that move with it ([look.crust])"},
              s.particles.rest_position);
  });
  v.table({"gravity", "a uniform force"}, nullptr, [&] { v.vector({"acceleration_m_s2", "gravity"}, s.gravity, any_number); });
  v.table({"solver", "numerical settings; the defaults suit most shots"}, nullptr, [&] {
    v.number({"sound_speed_m_s", "c of the equation of state; the density errs by about gH/c^2",
              "10 sqrt(2 g H), H the height of the scene, plus ten times the fastest start"},
             s.solver.sound_speed, positive);
    v.number({"shear_wave_speed_m_s",
              "stiffness sqrt(G/rho0) of the relaxed stress, with which any viscosity is stable; 0: the stress follows the strain rate at "
              "once and viscosity limits the time step",
              "the sound speed where a material is `smd`, else 0"},
             s.solver.shear_wave_speed, non_negative);
    v.number({"artificial_viscosity", "alpha, damps sound"}, s.solver.artificial_viscosity, {0.0, 10.0});
    v.number({"density_diffusion",
              "delta, smooths pressure noise in fluids with little viscosity; 0.1 to 0.5, and from 0.4 on it shortens the step"},
             s.solver.density_diffusion, {0.0, 1.0});
    v.boolean({"corrected_divergence", "density by the corrected velocity gradient, exact at a free surface: keeps thin layers and the fronts of "
                                       "lava from swelling; of viscous scenes with `density` by continuity"},
              s.solver.corrected_divergence);
    v.number({"hourglass_control", "share of the viscosity that acts on motions of the lattice that no velocity gradient sees; of viscous scenes"},
             s.solver.hourglass_control, unit_interval);
    v.number({"xsph", "epsilon, how much particles move with their neighbours' velocity"}, s.solver.xsph, unit_interval);
    v.choice({"kernel", "W: `quintic_spline` reaches 3 h instead of 2 h, smoother and with three times the neighbours; `quadratic` keeps "
                        "particles from clumping"},
             s.solver.kernel, {"cubic_spline", "quintic_spline", "quadratic"});
    v.choice({"equation_of_state", "`linear`: p = c^2 (rho - rho0); `tait`: p = c^2 rho0/7 ((rho/rho0)^7 - 1), stiffer as it is compressed"},
             s.solver.equation_of_state, {"linear", "tait"});
    v.number({"background_pressure_Pa", "added to p: spaces particles evenly where there is no free surface, and blows a free surface apart"},
             s.solver.background_pressure, non_negative);
    v.choice({"density", "`continuity`: integrated in time, right at free surfaces; `summation`: sum of m W, which never drifts but sees "
                         "a free surface as thin; `normalised_summation`: that over sum of V W, which sees it as less thin"},
             s.solver.density, {"continuity", "summation", "normalised_summation"});
    v.choice({"precision", "of the pair sums; the state is always double"}, s.solver.precision, {"single", "double"});
  });
  v.table({"time_step", "the adaptive time step"}, nullptr, [&] {
    v.number({"courant", "C in dt = C min(h/(v + c), h^2 rho/(8 eta), sqrt(h/a))"}, s.time_step.courant, {0.0, 0.5, true});
    v.number({"min_s", "a smaller step is an error"}, s.time_step.min_time_step, positive);
  });
  v.table({"domain", "a particle that leaves this box is an error"}, nullptr, [&] {
    v.vector({"lower_m", "lowest corner", "ten times the scene's size below it"}, s.domain.lower, any_number);
    v.vector({"upper_m", "highest corner", "ten times the scene's size above it"}, s.domain.upper, any_number);
  });
  bool is_periodic = s.periodic.has_value();
  PeriodicSettings periodic = s.periodic.value_or(PeriodicSettings{});
  v.table({"periodic", "a box that repeats: what leaves through a face comes in through the opposite one. Bodies start inside; obstacles and "
                       "surfaces do not repeat"},
          &is_periodic, [&] {
            v.choice({"axes", "along which it repeats"}, periodic.axes, {"x", "y", "z", "xy", "xz", "yz", "xyz"});
            v.vector({"lower_m", "lowest corner; along other axes it does not matter", "required"}, periodic.lower, any_number);
            v.vector({"upper_m", "highest corner", "required"}, periodic.upper, any_number);
          });
  if (is_periodic) s.periodic = periodic;
  visit_tables<MaterialSettings>(v, {"material", "what bodies are made of; at least one"}, s.materials,
                                 [&](MaterialSettings& m) { visit_material(v, m); });
  visit_tables<BodySettings>(v, {"body", "what flows from the start; at least one, or an [[emitter]]"}, s.bodies, [&](BodySettings& b) { visit_body(v, b); });
  visit_tables<ColliderSettings>(v, {"collider", "what it meets; none is allowed"}, s.colliders,
                                 [&](ColliderSettings& c) { visit_collider(v, c); });
  visit_tables<EmitterSettings>(v, {"emitter", "a vent that pours; none is allowed"}, s.emitters, [&](EmitterSettings& e) { visit_emitter(v, e); });
  visit_tables<OutflowSettings>(v, {"outflow", "a box that takes particles out of the shot; none is allowed"}, s.outflows,
                                [&](OutflowSettings& o) { visit_outflow(v, o); });
  visit_ambient(v, s.ambient);
  visit_tables<HeatSourceSettings>(v, {"heat_source", "a flame or a lamp that heats free surfaces near it; none is allowed"}, s.heat_sources,
                                   [&](HeatSourceSettings& h) { visit_heat_source(v, h); });
}

// --------------------------------------------------------------------------------------------------------- surface, render

void visit_surface(SchemaVisitor& v, Scene& s) {
  v.table({"surface", "the mesh around the particles"}, nullptr, [&] {
    v.number({"iso_value", "of the characteristic function, 1 deep inside and 0 outside"}, s.surface.iso_value, {0.01, 0.99});
    v.number({"cell_over_spacing", "edge of a grid cell over the particle spacing"}, s.surface.cell_over_spacing, {0.1, 2.0});
    v.number({"kernel_over_spacing", "smoothing length of the kernel over the particle spacing"}, s.surface.kernel_over_spacing,
             {0.6, 3.0});
    v.number({"thin_feature_gain", "how far drops, threads and sheets one particle thick are kept from shrinking"},
             s.surface.thin_feature_gain, unit_interval);
    v.boolean({"anisotropic", "kernels stretched along the surface: truer volumes and edges, at some cost in time"}, s.surface.anisotropic);
    visit_int(v, {"smoothing_passes", "volume-preserving smoothing of the mesh"}, s.surface.smoothing_passes, {0, 1000});
    v.boolean({"ply", "also surface.NNNN.ply: velocity, temperature and viscosity at every vertex"}, s.surface_outputs.ply);
    v.boolean({"fog_volume", "also a grid `density` in the VDB, 1 inside"}, s.surface_outputs.fog_volume);
    v.boolean({"vertex_colours", "colours in the OBJ from temperature: blue, white, red"}, s.surface_outputs.vertex_colours);
    v.number({"colour_cold_K", "temperature that is blue"}, s.surface_outputs.colour_cold, non_negative);
    v.number({"colour_hot_K", "temperature that is red"}, s.surface_outputs.colour_hot, positive);
  });
}

/// Adapter between the visitor's double and the renderer's float; writes the shortest decimals.
void visit_float(SchemaVisitor& v, const Key& key, float& value, const Limits& limits) {
  double wide = std::round(static_cast<double>(value) * 1e6) / 1e6;
  v.number(key, wide, limits);
  value = static_cast<float>(wide);
}

void visit_camera(SchemaVisitor& v, CameraSettings& s) {
  v.table({"camera", "a thin lens; without f_number a pinhole. By default it frames the bodies"}, nullptr, [&] {
    v.vector({"eye_m", "where it is", "a three-quarter view of the bodies"}, s.eye, any_number);
    v.vector({"target_m", "what is in the middle of the picture", "the middle of the bodies"}, s.target, any_number);
    v.number({"vertical_fov_deg", "angle from bottom to top", "18"}, s.vertical_fov_deg, {1.0, 150.0});
    v.number({"focal_length_m", "instead of vertical_fov_deg: 0.05 is a 50 mm lens", "see vertical_fov_deg"}, s.focal_length, positive);
    v.number({"film_height_m", "what focal_length_m and f_number go with: 0.024 is a full frame"}, s.film_height, positive);
    v.number({"f_number", "focal length over the lens's diameter: what is out of focus blurs", "all is sharp"}, s.f_number, positive);
    v.number({"focus_distance_m", "of the plane that is sharp, with f_number", "through the target"}, s.focus_distance, positive);
    v.number({"shutter", "how long it is open, of the time between frames: 0.5 is a film camera's; 0: nothing blurs by moving"}, s.shutter,
             unit_interval);
    visit_int(v, {"width", "of the picture in pixels"}, s.width, {16, 16384});
    visit_int(v, {"height", "of the picture in pixels"}, s.height, {16, 16384});
    v.choice({"interpolation", "between keyframes: `linear`: at a constant speed; `smooth`: starts and stops gently at each keyframe"},
             s.interpolation, {"linear", "smooth"});
    visit_tables<CameraKeyframeSettings>(
        v,
        {"keyframes", "where it is at given times: `keyframes = [{ time_s = 0.0 }, { time_s = 2.0, eye_m = [3.0, 1.0, 2.0] }]`; what a "
                      "keyframe leaves out is as above"},
        s.keyframes, [&](CameraKeyframeSettings& k) {
          v.required_number({"time_s", "later than the keyframe before"}, k.time, any_number);
          v.vector({"eye_m", "where it is", "[camera] eye_m"}, k.eye, any_number);
          v.vector({"target_m", "what it looks at", "[camera] target_m"}, k.target, any_number);
          v.number({"vertical_fov_deg", "its angle", "[camera]'s"}, k.vertical_fov_deg, {1.0, 150.0});
        });
  });
}

void visit_environment(SchemaVisitor& v, EnvironmentSettings& s) {
  v.table({"environment", "light from all around"}, nullptr, [&] {
    v.choice({"kind", "`studio`: dim and even, before a grey cove; `sky`: sun and sky of a clear day, and no other lights unless there are [[light]]s; "
                      "`image`: a panorama"},
             s.kind, {"studio", "sky", "image"});
    v.optional_text({"image", "`image`: an equirectangular panorama, .exr or .hdr, from the scene's folder or smelt's own; its middle is towards -z",
            "required by `image`"},
           s.image);
    v.number({"strength", "factor on its radiance"}, s.strength, positive);
    v.number({"rotate_deg", "`image`: turns it counter-clockwise, seen from above"}, s.rotate_deg, any_number);
    v.number({"sun_elevation_deg", "`sky`: of the sun above the horizon; below -0.5 it is dusk"}, s.sun_elevation_deg, {-6.0, 90.0});
    v.number({"sun_azimuth_deg", "`sky`: from -z (0, north) over +x (90, east)"}, s.sun_azimuth_deg, any_number);
    v.number({"haze", "`sky`: how hazy the air is; 1 is clear, 5 is milky"}, s.haze, {0.1, 10.0});
    v.boolean({"visible", "the camera sees it instead of the grey cove", "true unless `studio`"}, s.visible);
  });
}

void visit_look_state(SchemaVisitor& v, std::string_view name, std::string_view meaning, LookSettings::State& state) {
  v.table({name, meaning}, nullptr, [&] {
    v.vector({"colour", "linear RGB under the coat; of a metal, what it reflects", "the material's"}, state.colour, unit_interval);
    v.number({"roughness", "of the coat: small is wet, large is matt", "the material's"}, state.roughness, {0.01, 1.0});
    v.number({"scatter_m", "how far red light wanders under the surface of wax", "the material's"}, state.scatter, non_negative);
  });
}

void visit_glow(SchemaVisitor& v, LookSettings& s) {
  bool glows = s.black_body.has_value();
  BlackBodyLook body = s.black_body.value_or(BlackBodyLook{});
  v.table({"black_body", "the surface glows as its temperature says, and lights what is around it. Lava has it in any case"}, &glows, [&] {
    visit_float(v, {"emissivity", "share of a black body's light"}, body.emissivity, {0.0, 1.0, true});
    visit_float(v, {"white_cd_m2", "luminance that counts as a radiance of 1: 30000 in the sun, 100 at dusk; rock of 1400 K gives off 2400"},
                body.white_cd_m2, positive);
  });
  if (glows) s.black_body = body;
}

void visit_crust(SchemaVisitor& v, LookSettings& s) {
  bool given = s.crust.has_value();
  CrustLook crust = s.crust.value_or(CrustLook{});
  v.table({"crust", "plates with cracks, which move with the material; needs particles.rest_position"}, &given, [&] {
    visit_float(v, {"plate_m", "size of the plates"}, crust.plate_m, positive);
    visit_float(v, {"crack", "width of the cracks over the size of the plates where it has set; two and a half times that where it is liquid"}, crust.crack,
                {0.0, 0.5, true});
    visit_float(v, {"cooler_K", "how much cooler than the fluid under it a plate is"}, crust.cooler_K, non_negative);
    visit_float(v, {"relief", "height of plates and grain; 0: smooth"}, crust.relief, {0.0, 2.0});
  });
  if (given) s.crust = crust;
}

void visit_render(SchemaVisitor& v, Scene& s) {
  visit_camera(v, s.camera);
  visit_tables<LightSettings>(
      v, {"light", "area lights; with none, a soft key from the left and a warm rim from behind"}, s.lights, [&](LightSettings& l) {
        v.choice({"shape", "flat lamp"}, l.shape, {"rectangle", "disk"});
        v.vector({"position_m", "centre"}, l.position, any_number);
        v.vector({"target_m", "the lamp faces this point"}, l.target, any_number);
        v.number({"width_m", "or diameter"}, l.width, positive);
        v.number({"height_m", "of a rectangle"}, l.height, positive);
        v.vector({"radiance", "linear RGB"}, l.radiance, non_negative);
      });
  visit_environment(v, s.environment);
  v.table({"look", "how the fluid looks, blended from cold to hot by its temperature"}, nullptr, [&] {
    v.choice({"material", "`wax` and `plastic`: a coat over a body that light wanders through; `rock`: opaque; `metal`; `lava`: rock that glows"},
             s.look.material, {"wax", "plastic", "rock", "metal", "lava"});
    v.number({"cold_K", "where the cold look ends", "the first material's heat.cold_K"}, s.look.cold_K, non_negative);
    v.number({"hot_K", "where the hot look begins", "the first material's heat.hot_K"}, s.look.hot_K, non_negative);
    v.number({"specular", "strength of the coat's reflection", "1; of rock and lava 0.5"}, s.look.specular, unit_interval);
    v.number({"ior", "index of refraction of the coat"}, s.look.ior, {1.01, 3.0});
    v.number({"exposure", "brightness before tone mapping"}, s.look.exposure, positive);
    v.choice({"tone_curve", "what becomes of colours too bright for a display; `neutral`: they keep their hue and bleach; `film`: red turns to orange, "
                            "yellow and white",
              "neutral; of lava film"},
             s.look.tone_curve, {"neutral", "film"});
    visit_look_state(v, "cold", "at and below cold_K", s.look.cold);
    visit_look_state(v, "hot", "at and above hot_K", s.look.hot);
    visit_glow(v, s.look);
    visit_crust(v, s.look);
  });
  v.table({"render", "quality of the pictures"}, nullptr, [&] {
    visit_int(v, {"samples", "per pixel of fluid"}, s.render.samples, {1, 4096});
    visit_int(v, {"bounces", "surfaces that light may meet after the one that is seen"}, s.render.bounces, {1, 24});
    v.number({"firefly_limit", "luminance, as displayed, that one path may bring from its bounces; what it takes away stands in run.json. 0: no limit"},
             s.render.firefly_limit, non_negative);
    v.boolean({"denoise", "filter what noise is left"}, s.render.denoise);
    v.integer({"seed", "of the noise"}, s.render.seed, {0, 4294967295.0});
    visit_int(v, {"png_bits", "8 or 16 bits a channel"}, s.render.png_bits, {8, 16});
    v.boolean({"exr", "frames/frame.0001.exr too: linear, with layers albedo, depth, normal, position, temperature, velocity"}, s.render.exr);
  });
}

}  // namespace

void visit_section(SchemaVisitor& visitor, Scene& scene, SceneSection section) {
  switch (section) {
    case SceneSection::simulation:
      visitor.number({"fps", ""}, scene.shot.fps, positive);
      visit_simulation(visitor, scene);
      break;
    case SceneSection::surface: visit_surface(visitor, scene); break;
    case SceneSection::render: visit_render(visitor, scene); break;
  }
}

void visit_scene(SchemaVisitor& visitor, Scene& scene) {
  visitor.table({"shot", "the sequence"}, nullptr, [&] {
    visitor.required_text({"name", "names the output folder and the film"}, scene.shot.name);
    visit_int(visitor, {"frames", "number of frames; frame 1 is the start"}, scene.shot.frames, {1, 100000}, true);
    visitor.number({"fps", "frames per second"}, scene.shot.fps, {0.0, 100000.0, true});
    visitor.choice({"quality",
                    "settings for a purpose, where the scene does not say them itself: `preview` (a quarter of the particles, coarse surface, small "
                    "pictures), `final`, `study` (small time steps, no XSPH, sums in double precision); what they buy: docs/accuracy.md",
                    "the defaults below"},
                   scene.shot.quality, {"preview", "final", "study"});
  });
  visit_simulation(visitor, scene);
  visit_surface(visitor, scene);
  visit_render(visitor, scene);
}

}  // namespace smelt
