#include "scenes/schema_parts.h"

#include <cmath>

namespace smelt {

void visit_surface(SchemaVisitor& v, Scene& s) {
  v.table({"surface", "the mesh around the particles"}, nullptr, [&] {
    v.number({"iso_value", "of the characteristic function, 1 deep inside and 0 outside"}, s.surface.iso_value,
             {0.01, 0.99});
    v.number({"cell_over_spacing",
              "edge of a grid cell over the particle spacing; at most 1.5 kernel_over_spacing. The least drop is "
              "about a cell wide"},
             s.surface.cell_over_spacing, {0.1, 2.0});
    v.number({"kernel_over_spacing",
              "smoothing length of the kernel over the particle spacing; at 1.4 sheets one particle thick come out 1.2 "
              "times as thick and threads with 1.6 times their volume, at 2 1.6 and 3 times"},
             s.surface.kernel_over_spacing, {0.6, 3.0});
    v.number({"thin_feature_gain",
              "how far drops, threads and sheets one particle thick are kept from shrinking; 0 lets them vanish"},
             s.surface.thin_feature_gain, unit_interval);
    v.boolean({"anisotropic", "kernels stretched along the surface: truer volumes and edges, at some cost in time"},
              s.surface.anisotropic);
    visit_int(v, {"smoothing_passes", "volume-preserving smoothing of the mesh"}, s.surface.smoothing_passes,
              {0, 1000});
    v.boolean({"ply", "also surface.NNNN.ply: velocity, temperature and viscosity at every vertex"},
              s.surface_outputs.ply);
    v.boolean({"fog_volume", "also a grid `density` in the VDB, 1 inside"}, s.surface_outputs.fog_volume);
    v.boolean({"vertex_colours", "colours in the OBJ from temperature: blue, white, red"},
              s.surface_outputs.vertex_colours);
    v.number({"colour_cold_K", "temperature that is blue"}, s.surface_outputs.colour_cold, non_negative);
    v.number({"colour_hot_K", "temperature that is red"}, s.surface_outputs.colour_hot, positive);
  });
}

namespace {

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
    v.number({"focal_length_m", "instead of vertical_fov_deg: 0.05 is a 50 mm lens", "see vertical_fov_deg"},
             s.focal_length, positive);
    v.number({"film_height_m", "what focal_length_m and f_number go with: 0.024 is a full frame"}, s.film_height,
             positive);
    v.number({"f_number", "focal length over the lens's diameter: what is out of focus blurs", "all is sharp"},
             s.f_number, positive);
    v.number({"focus_distance_m", "of the plane that is sharp, with f_number", "through the target"}, s.focus_distance,
             positive);
    v.number({"shutter",
              "how long it is open, of the time between frames: 0.5 is a film camera's; 0: nothing blurs by moving"},
             s.shutter, unit_interval);
    visit_int(v, {"width", "of the picture in pixels"}, s.width, {16, 16384});
    visit_int(v, {"height", "of the picture in pixels"}, s.height, {16, 16384});
    v.choice({"interpolation",
              "between keyframes: `linear`: at a constant speed; `smooth`: starts and stops gently at each keyframe"},
             s.interpolation, {"linear", "smooth"});
    visit_tables<CameraKeyframeSettings>(
        v,
        {"keyframes",
         "where it is at given times: `keyframes = [{ time_s = 0.0 }, { time_s = 2.0, eye_m = [3.0, 1.0, 2.0] }]`; "
         "what a keyframe leaves out is as above"},
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
    v.choice(
        {"kind",
         "`studio`: dim and even, before a grey cove; `sky`: sun and sky of a clear day, and no other lights unless "
         "there are [[light]]s; `image`: a panorama"},
        s.kind, {"studio", "sky", "image"});
    v.optional_text(
        {"image",
         "`image`: an equirectangular panorama, .exr or .hdr, from the scene's folder or smelt's own; its middle is "
         "towards -z",
         "required by `image`"},
        s.image);
    v.number({"strength", "factor on its radiance"}, s.strength, positive);
    v.number({"rotate_deg", "`image`: turns it counter-clockwise, seen from above"}, s.rotate_deg, any_number);
    v.number({"sun_elevation_deg", "`sky`: of the sun above the horizon; below -0.5 it is dusk"}, s.sun_elevation_deg,
             {-6.0, 90.0});
    v.number({"sun_azimuth_deg", "`sky`: from -z (0, north) over +x (90, east)"}, s.sun_azimuth_deg, any_number);
    v.number({"haze", "`sky`: how hazy the air is; 1 is clear, 5 is milky"}, s.haze, {0.1, 10.0});
    v.boolean({"visible", "the camera sees it instead of the grey cove", "true unless `studio`"}, s.visible);
  });
}

void visit_look_state(SchemaVisitor& v, std::string_view name, std::string_view meaning, LookSettings::State& state) {
  v.table({name, meaning}, nullptr, [&] {
    v.vector({"colour", "linear RGB under the coat; of a metal, what it reflects", "the material's"}, state.colour,
             unit_interval);
    v.number({"roughness", "of the coat: small is wet, large is matt", "the material's"}, state.roughness, {0.01, 1.0});
    v.number({"scatter_m", "how far red light wanders under the surface of wax", "the material's"}, state.scatter,
             non_negative);
  });
}

void visit_glow(SchemaVisitor& v, LookSettings& s) {
  bool glows = s.black_body.has_value();
  BlackBodyLook body = s.black_body.value_or(BlackBodyLook{});
  v.table(
      {"black_body",
       "the surface glows as its temperature says, and lights what is around it. Lava has it in any case"},
      &glows, [&] {
        visit_float(v, {"emissivity", "share of a black body's light"}, body.emissivity, {0.0, 1.0, true});
        visit_float(
            v,
            {"white_cd_m2",
             "luminance that counts as a radiance of 1: 30000 in the sun, 100 at dusk; rock of 1400 K gives off 2400"},
            body.white_cd_m2, positive);
      });
  if (glows) s.black_body = body;
}

void visit_crust(SchemaVisitor& v, LookSettings& s) {
  bool given = s.crust.has_value();
  CrustLook crust = s.crust.value_or(CrustLook{});
  v.table({"crust", "plates with cracks, which move with the material; needs particles.rest_position"}, &given, [&] {
    visit_float(v, {"plate_m", "size of the plates"}, crust.plate_m, positive);
    visit_float(
        v,
        {"crack",
         "width of the cracks over the size of the plates where it has set; two and a half times that where it is "
         "liquid"},
        crust.crack, {0.0, 0.5, true});
    visit_float(v, {"cooler_K", "how much cooler than the fluid under it a plate is"}, crust.cooler_K, non_negative);
    visit_float(v, {"relief", "height of plates and grain; 0: smooth"}, crust.relief, {0.0, 2.0});
  });
  if (given) s.crust = crust;
}

}  // namespace

void visit_render(SchemaVisitor& v, Scene& s) {
  visit_camera(v, s.camera);
  visit_tables<LightSettings>(v,
                              {"light", "area lights; with none, a soft key from the left and a warm rim from behind"},
                              s.lights, [&](LightSettings& l) {
                                v.choice({"shape", "flat lamp"}, l.shape, {"rectangle", "disk"});
                                v.vector({"position_m", "centre"}, l.position, any_number);
                                v.vector({"target_m", "the lamp faces this point"}, l.target, any_number);
                                v.number({"width_m", "or diameter"}, l.width, positive);
                                v.number({"height_m", "of a rectangle"}, l.height, positive);
                                v.vector({"radiance", "linear RGB"}, l.radiance, non_negative);
                              });
  visit_environment(v, s.environment);
  v.table({"look", "how the fluid looks, blended from cold to hot by its temperature"}, nullptr, [&] {
    v.choice(
        {"material",
         "`wax` and `plastic`: a coat over a body that light wanders through; `rock`: opaque; `metal`; `lava`: rock "
         "that glows"},
        s.look.material, {"wax", "plastic", "rock", "metal", "lava"});
    v.number({"cold_K", "where the cold look ends", "the first material's heat.cold_K"}, s.look.cold_K, non_negative);
    v.number({"hot_K", "where the hot look begins", "the first material's heat.hot_K"}, s.look.hot_K, non_negative);
    v.number({"specular", "strength of the coat's reflection", "1; of rock and lava 0.5"}, s.look.specular,
             unit_interval);
    v.number({"ior", "index of refraction of the coat"}, s.look.ior, {1.01, 3.0});
    v.number({"exposure", "brightness before tone mapping"}, s.look.exposure, positive);
    v.choice(
        {"tone_curve",
         "what becomes of colours too bright for a display; `neutral`: they keep their hue and bleach; `film`: red "
         "turns to orange, yellow and white",
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
    v.number(
        {"firefly_limit",
         "luminance, as displayed, that one path may bring from its bounces; what it takes away stands in run.json. 0: "
         "no limit"},
        s.render.firefly_limit, non_negative);
    v.boolean({"denoise", "filter what noise is left"}, s.render.denoise);
    v.integer({"seed", "of the noise"}, s.render.seed, {0, 4294967295.0});
    visit_int(v, {"png_bits", "8 or 16 bits a channel"}, s.render.png_bits, {8, 16});
    v.boolean({"exr",
               "frames/frame.0001.exr too: linear, with layers albedo, depth, normal, position, temperature, velocity"},
              s.render.exr);
  });
}

}  // namespace smelt
