#include "scenes/schema_parts.h"

namespace smelt {

namespace {

void visit_viscosity(SchemaVisitor& v, ViscositySettings& s) {
  v.choice({"law", "`smd`: Souza Mendes-Dutra viscoplastic; `newtonian`; `inviscid`"}, s.law,
           {"smd", "newtonian", "inviscid"});
  v.thermal({"viscosity_Pa_s", "viscosity eta of a `newtonian` fluid", "required by `newtonian`, refused otherwise"},
            s.viscosity, positive);
  v.thermal({"yield_stress_Pa", "`smd`: stress tau0 below which it hardly flows; 0 is a power-law fluid",
             "required by `smd`"},
            s.yield_stress, non_negative);
  v.thermal({"consistency_Pa_sn", "`smd`: consistency K", "required by `smd`"}, s.consistency, positive);
  v.number({"index", "`smd`: flow index n; below 1 it thins as it shears", "required by `smd`"}, s.index,
           {0.0, 1.0, true});
  v.thermal(
      {"jump_number",
       "`smd`: J = eta0 gdot1/tau0 - 1 with gdot1 = (tau0/K)^(1/n): how much stiffer it is at rest than at the end of "
       "yielding",
       "`smd` with a yield stress needs this or rest_viscosity_Pa_s, not both"},
      s.jump_number, non_negative);
  v.thermal({"rest_viscosity_Pa_s", "`smd`: viscosity eta0 at rest", "see jump_number"}, s.rest_viscosity, positive);
}

void visit_heat(SchemaVisitor& v, HeatProperties& s) {
  v.required_number({"diffusivity_m2_s", "thermal diffusivity k = conductivity/(density specific heat)"}, s.diffusivity,
                    non_negative);
  v.required_number({"cold_K", "at and below, it is solid and the cold values hold"}, s.cold, non_negative);
  v.required_number(
      {"hot_K",
       "at and above, it is liquid and the hot values hold; above cold_K, or with latent heat the same: a sharp "
       "melting point"},
      s.hot, non_negative);
  std::optional<double> specific_heat;
  if (s.specific_heat > 0.0) specific_heat = s.specific_heat;
  v.number({"specific_heat_J_kgK", "specific heat c_p", "not known, and then neither is any energy"}, specific_heat,
           positive);
  s.specific_heat = specific_heat.value_or(0.0);
  v.number(
      {"latent_heat_J_kg", "latent heat L of melting, taken up evenly from cold_K to hot_K; needs the specific heat"},
      s.latent_heat, non_negative);
  v.number({"emissivity", "of the free surface, which radiates to [ambient]; needs the specific heat"}, s.emissivity,
           unit_interval);
}

void visit_material(SchemaVisitor& v, MaterialSettings& s) {
  v.required_text({"name", "what bodies call it"}, s.name);
  v.required_number({"density_kg_m3", "density at rest"}, s.density, positive);
  v.table(
      {"viscosity",
       "the flow law. Where the material has `heat`, a value may follow temperature: `{ cold = , hot = }` runs "
       "linearly from cold_K to hot_K; `{ temperature_K = [ ], values = [ ] }` through points, geometrically between "
       "values above 0; `{ reference = , reference_K = , rate_1_K = }` is reference exp(-rate (T - reference_K)), T "
       "kept from cold_K to hot_K"},
      nullptr, [&] { visit_viscosity(v, s.viscosity); });
  bool has_heat = s.heat.has_value();
  HeatProperties heat = s.heat.value_or(HeatProperties{});
  v.table({"heat", "conduction and melting; leave it out and nothing thermal exists"}, &has_heat,
          [&] { visit_heat(v, heat); });
  if (has_heat) s.heat = heat;
}

void visit_placement(SchemaVisitor& v, PlacementSettings& s) {
  v.number({"scale", "the mesh's coordinates times this are metres", "1"}, s.scale, positive);
  v.number({"height_m", "scales the mesh so that it is this tall; instead of `scale`", "not used"}, s.height, positive);
  v.vector({"rotate_deg", "turns about x, then y, then z"}, s.rotate_deg, any_number);
  v.vector({"translate_m", "moves after scaling and turning"}, s.translate, any_number);
  v.number({"stand_at_y_m", "then moves along y so that the lowest point is here", "not moved"}, s.stand_at_y,
           any_number);
}

void visit_body(SchemaVisitor& v, BodySettings& s) {
  v.required_text({"mesh", "file: .obj .ply .stl .off .gltf .glb, from the scene's folder or smelt's own"}, s.mesh);
  v.required_text({"material", "name of a [[material]]"}, s.material);
  visit_placement(v, s.placement);
  v.vector({"velocity_m_s", "at the start"}, s.velocity, any_number);
  std::optional<std::pair<double, double>> temperature;
  if (s.temperature) temperature = {s.temperature->bottom, s.temperature->top};
  v.range(
      {"temperature_K", "at the start: a number, or `{ bottom = , top = }` for a linear rise over the body's height",
       "required where the material has heat, refused otherwise"},
      "bottom", "top", temperature, non_negative);
  if (temperature) s.temperature = VerticalRange{temperature->first, temperature->second};
}

void visit_terrain(SchemaVisitor& v, ColliderSettings& s) {
  bool given = s.terrain.has_value();
  TerrainSettings t = s.terrain.value_or(TerrainSettings{});
  v.table({"terrain",
           "of a `mesh` that is a height field. Its middle is put at x = z = 0, heights along y, its first row to the "
           "north (-z)"},
          &given, [&] {
            v.number({"cell_m", "distance between heights", "the .asc file's; required for .csv and .png"}, t.cell,
                     positive);
            v.number({"height_scale", ".asc, .csv: heights times this are metres"}, t.height_scale, positive);
            v.number({"lowest_m", ".png: height of black"}, t.lowest, any_number);
            v.number({"highest_m", ".png: height of white, above lowest_m"}, t.highest, any_number);
            visit_int(
                v, {"refine", "each cell is divided into this many along both sides, by a cubic through the heights"},
                t.refine, {1, 32});
            v.boolean({"closed", "made a solid by walls down to a bottom; false: a sheet"}, t.closed);
            v.number({"depth_m", "of the bottom below the lowest height", "a tenth of the field's shorter side"},
                     t.depth, positive);
          });
  if (given) s.terrain = t;
}

void visit_collider(SchemaVisitor& v, ColliderSettings& s) {
  v.required_text({"mesh", "a mesh file, a height field (.asc .csv .png), or `ground`: a floor without end"}, s.mesh);
  visit_placement(v, s.placement);
  v.number({"ground_y_m", "height of the `ground`"}, s.ground_height, any_number);
  v.number({"friction", "share of the tangential velocity kept after a hit; 0 with restitution 0: no slip"}, s.friction,
           unit_interval);
  v.number({"restitution", "share of the normal velocity returned after a hit"}, s.restitution, unit_interval);
  v.boolean(
      {"wall",
       "completes the density, pressure and shear of the fluid near it (friction 0: no slip, 1: free slip); false: it "
       "only stops what hits it"},
      s.wall);
  v.vector({"velocity_m_s", "it moves with, from where it is at the start; not of the `ground`"}, s.velocity,
           any_number);
  v.vector({"angular_velocity_rad_s",
            "it spins with about an axis through the pivot, counter-clockwise seen from the vector's tip; not of the "
            "`ground`"},
           s.angular_velocity, any_number);
  v.number({"mass_kg",
            "makes it a rigid body, which gravity and what it meets push about: its mesh closed, velocity_m_s and "
            "angular_velocity_rad_s those at the start, about the centre of mass",
            "it goes where the scene says"},
           s.mass, positive);
  v.number({"density_kg_m3", "the same by the mesh's volume; instead of mass_kg", "see mass_kg"}, s.density, positive);
  v.vector(
      {"pivot_m", "point it turns about, where it is before anything moves", "the middle of the placed mesh's box"},
      s.pivot, any_number);
  v.choice({"interpolation",
            "between keyframes: `linear`: at a constant speed; `smooth`: starts and stops gently at each keyframe"},
           s.interpolation, {"linear", "smooth"});
  v.vector({"surface_velocity_m_s",
            "of its surface beyond that, as of a belt that stays where it is; its part along the surface"},
           s.surface_velocity, any_number);
  v.number({"temperature_K", "heat passes between it and the fluid at it; only of a `wall`, in a scene with heat",
            "no heat passes"},
           s.temperature, non_negative);
  v.number({"until_s", "then it vanishes: a gate that opens", "it stays"}, s.until, positive);
  v.vector({"colour", "linear RGB in pictures"}, s.colour, unit_interval);
  v.choice({"material", "in pictures: `matte`, `plastic` (with a coat) or `metal`"}, s.material,
           {"matte", "plastic", "metal"});
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
  v.vector(
      {"position_m",
       "middle of the vent, above the ground; what comes in there is driven for a kernel's support (three spacings) "
       "along the direction, then free. A vent near the ground is rooted in it"},
      s.position, any_number);
  v.vector({"direction", "of the flow, of any length"}, s.direction, any_number);
  v.required_number({"radius_m", "of the vent, at least a spacing"}, s.radius, positive);
  v.required_number({"flow_rate_m3_s", "volume poured in a second"}, s.flow_rate, positive);
  v.number({"temperature_K", "it comes in with", "required where the material has heat, refused otherwise"},
           s.temperature, non_negative);
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
  v.table(
      {"ambient",
       "what free surfaces lose heat to, by convection here and by radiation where a material has an emissivity"},
      &present, [&] {
        v.number({"temperature_K", "of the air and of what is radiated to", "required"}, s.temperature, non_negative);
        v.number(
            {"heat_transfer_W_m2K", "h of convection, h (T - temperature_K): still air about 5 to 10, wind up to 100"},
            s.heat_transfer, non_negative);
      });
  if (present) ambient = s;
}

void visit_heat_source(SchemaVisitor& v, HeatSourceSettings& s) {
  v.vector({"position_m", "where it is at the start"}, s.position, any_number);
  v.required_number({"radius_m", "R: heats free surfaces nearer than this, weighted with (1 - r^2/R^2)^2"}, s.radius,
                    positive);
  v.number({"power_W", "all of it goes into the free surface within the radius",
            "give this, or temperature_K and heat_transfer_W_m2K"},
           s.power, non_negative);
  v.number({"temperature_K", "of a flame's gas", "see power_W"}, s.temperature, non_negative);
  v.number({"heat_transfer_W_m2K", "h from that gas, at its middle: h (temperature_K - T)", "see power_W"},
           s.heat_transfer, positive);
  v.vector({"velocity_m_s", "it moves with"}, s.velocity, any_number);
  v.number({"from_s", "it burns from this time on"}, s.from, non_negative);
  v.number({"until_s", "until this time", "to the end"}, s.until, positive);
}

void visit_particles(SchemaVisitor& v, ParticleSettings& s) {
  v.table(
      {"particles",
       "how finely bodies are divided: a cubic lattice fills them, and more particles the rims and fins that are too "
       "thin for it. Give `count` or `spacing_m`"},
      nullptr, [&] {
        v.integer({"count", "particles in all bodies together, met to 1 %", "see spacing_m"}, s.count, {1, 2e9});
        v.number({"spacing_m", "distance between particles", "follows from count"}, s.spacing, positive);
        v.number({"jitter", "random shift at the start, as a fraction of the spacing"}, s.jitter, {0.0, 0.49});
        v.integer({"seed", "of the jitter"}, s.seed, {0, 9.0e15});
        v.number({"smoothing_length_over_spacing", "h over the spacing; 1.2 gives about 58 neighbours"},
                 s.smoothing_length_over_spacing, {0.9, 3.0});
        v.boolean({"rest_position",
                   "caches carry where each particle was before the material moved, for textures that move with it "
                   "([look.crust])"},
                  s.rest_position);
      });
}

void visit_solver(SchemaVisitor& v, SolverSettings& s) {
  v.table({"solver", "numerical settings; the defaults suit most shots"}, nullptr, [&] {
    v.number({"sound_speed_m_s", "c of the equation of state; the density errs by about gH/c^2",
              "10 sqrt(2 g H), H the height of the scene, plus ten times the fastest start"},
             s.sound_speed, positive);
    v.number(
        {"shear_wave_speed_m_s",
         "stiffness sqrt(G/rho0) of the relaxed stress, with which any viscosity is stable; 0: the stress follows the "
         "strain rate at once and viscosity limits the time step",
         "the sound speed where a material is `smd`, else 0"},
        s.shear_wave_speed, non_negative);
    v.number({"artificial_viscosity", "alpha, damps sound"}, s.artificial_viscosity, {0.0, 10.0});
    v.number(
        {"density_diffusion",
         "delta, smooths pressure noise in fluids with little viscosity; 0.1 to 0.5, and from 0.4 on it shortens the "
         "step"},
        s.density_diffusion, {0.0, 1.0});
    v.boolean(
        {"corrected_divergence",
         "density by the corrected velocity gradient, exact at a free surface: keeps thin layers and the fronts of "
         "lava from swelling; of viscous scenes with `density` by continuity"},
        s.corrected_divergence);
    v.number({"hourglass_control",
              "share of the viscosity that acts on motions of the lattice that no velocity gradient sees; of viscous "
              "scenes"},
             s.hourglass_control, unit_interval);
    v.number({"xsph", "epsilon, how much particles move with their neighbours' velocity"}, s.xsph, unit_interval);
    v.choice(
        {"kernel",
         "W: `quintic_spline` reaches 3 h instead of 2 h, smoother and with three times the neighbours; `quadratic` "
         "keeps particles from clumping"},
        s.kernel, {"cubic_spline", "quintic_spline", "quadratic"});
    v.choice({"equation_of_state",
              "`linear`: p = c^2 (rho - rho0); `tait`: p = c^2 rho0/7 ((rho/rho0)^7 - 1), stiffer as it is compressed"},
             s.equation_of_state, {"linear", "tait"});
    v.number({"background_pressure_Pa",
              "added to p: spaces particles evenly where there is no free surface, and blows a free surface apart"},
             s.background_pressure, non_negative);
    v.choice(
        {"density",
         "`continuity`: integrated in time, right at free surfaces; `summation`: sum of m W, which never drifts but "
         "sees a free surface as thin; `normalised_summation`: that over sum of V W, which sees it as less thin"},
        s.density, {"continuity", "summation", "normalised_summation"});
    v.choice({"precision", "of the pair sums; the state is always double"}, s.precision, {"single", "double"});
  });
}

void visit_periodic(SchemaVisitor& v, std::optional<PeriodicSettings>& box) {
  bool is_periodic = box.has_value();
  PeriodicSettings periodic = box.value_or(PeriodicSettings{});
  v.table({"periodic",
           "a box that repeats: what leaves through a face comes in through the opposite one. Bodies start inside; "
           "obstacles and surfaces do not repeat"},
          &is_periodic, [&] {
            v.choice({"axes", "along which it repeats"}, periodic.axes, {"x", "y", "z", "xy", "xz", "yz", "xyz"});
            v.vector({"lower_m", "lowest corner; along other axes it does not matter", "required"}, periodic.lower,
                     any_number);
            v.vector({"upper_m", "highest corner", "required"}, periodic.upper, any_number);
          });
  if (is_periodic) box = periodic;
}

}  // namespace

void visit_simulation(SchemaVisitor& v, Scene& s) {
  visit_particles(v, s.particles);
  v.table({"gravity", "a uniform force"}, nullptr, [&] {
    v.vector({"acceleration_m_s2", "gravity"}, s.gravity, any_number);
  });
  visit_solver(v, s.solver);
  v.table({"time_step", "the adaptive time step"}, nullptr, [&] {
    v.number(
        {"courant",
         "C in dt = C min(h/(v + c), h^2 rho/(8 eta), sqrt(h/a)); with a relaxed stress sqrt(c^2 + 4/3 c_s^2) stands "
         "for c, c_s the shear_wave_speed_m_s, and eta sets no limit; conduction and density_diffusion limit dt "
         "besides"},
        s.time_step.courant, {0.0, 0.5, true});
    v.number({"min_s", "a smaller step is an error"}, s.time_step.min_time_step, positive);
  });
  v.table({"domain", "a particle that leaves this box is an error"}, nullptr, [&] {
    v.vector({"lower_m", "lowest corner", "ten times the scene's size below it"}, s.domain.lower, any_number);
    v.vector({"upper_m", "highest corner", "ten times the scene's size above it"}, s.domain.upper, any_number);
  });
  visit_periodic(v, s.periodic);
  visit_tables<MaterialSettings>(v, {"material", "what bodies are made of; at least one"}, s.materials,
                                 [&](MaterialSettings& m) { visit_material(v, m); });
  visit_tables<BodySettings>(v, {"body", "what flows from the start; at least one, or an [[emitter]]"}, s.bodies,
                             [&](BodySettings& b) { visit_body(v, b); });
  visit_tables<ColliderSettings>(v, {"collider", "what it meets; none is allowed"}, s.colliders,
                                 [&](ColliderSettings& c) { visit_collider(v, c); });
  visit_tables<EmitterSettings>(v, {"emitter", "a vent that pours; none is allowed"}, s.emitters,
                                [&](EmitterSettings& e) { visit_emitter(v, e); });
  visit_tables<OutflowSettings>(v, {"outflow", "a box that takes particles out of the shot; none is allowed"},
                                s.outflows, [&](OutflowSettings& o) { visit_outflow(v, o); });
  visit_ambient(v, s.ambient);
  visit_tables<HeatSourceSettings>(
      v, {"heat_source", "a flame or a lamp that heats free surfaces near it; none is allowed"}, s.heat_sources,
      [&](HeatSourceSettings& h) { visit_heat_source(v, h); });
}

}  // namespace smelt
