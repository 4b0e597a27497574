#pragma once
// The description of a shot, as a scene file states it. Units are SI and kelvin; defaults are the initial values here.
// What each key means stands in scenes/simulation_schema.cpp and picture_schema.cpp, from which docs/scene.md is made.

#include "core/geometry/vec.h"
#include "core/sph/material.h"
#include "render/render_frame.h"
#include "render/scene_view.h"
#include "scenes/key_places.h"
#include "surfacing/surface.h"

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace smelt {

struct ShotSettings {
  /// Named settings for everything else (scenes/quality.h); done with once a scene is read.
  std::optional<std::string> quality;
  std::string name;
  int frames = 0;
  double fps = 24.0;
};

struct ParticleSettings {
  std::optional<std::int64_t> count;
  std::optional<double> spacing;
  double jitter = 0.0;
  std::int64_t seed = 0;
  double smoothing_length_over_spacing = 1.2;
  bool rest_position = false;
};

struct SolverSettings {
  std::optional<double> sound_speed;
  std::optional<double> shear_wave_speed;
  double artificial_viscosity = 0.2;
  double density_diffusion = 0.0;
  double hourglass_control = 1.0;
  bool corrected_divergence = false;
  double xsph = 0.3;
  std::string kernel = "cubic_spline";
  std::string equation_of_state = "linear";
  double background_pressure = 0.0;
  std::string density = "continuity";
  std::string precision = "single";
};

struct TimeStepSettings {
  double courant = 0.25;
  double min_time_step = 1e-9;
};

struct DomainSettings {
  std::optional<Vec3> lower;
  std::optional<Vec3> upper;
};

/// A box that repeats; both corners are required.
struct PeriodicSettings {
  std::string axes = "x";
  std::optional<Vec3> lower;
  std::optional<Vec3> upper;
};

/// The flow law as a scene states it; `Rheology` is what it comes to.
struct ViscositySettings {
  std::string law = "smd";
  std::optional<ThermalRange> viscosity;
  std::optional<ThermalRange> yield_stress;
  std::optional<ThermalRange> consistency;
  std::optional<double> index;
  std::optional<ThermalRange> jump_number;
  std::optional<ThermalRange> rest_viscosity;
};

struct MaterialSettings {
  std::string name;
  double density = 0.0;
  ViscositySettings viscosity;
  std::optional<HeatProperties> heat;
};

/// Where a mesh stands: scaled, rotated (about x, then y, then z), moved, then perhaps lowered on a height.
struct PlacementSettings {
  std::optional<double> scale;
  std::optional<double> height;
  Vec3 rotate_deg = Vec3::Zero();
  Vec3 translate = Vec3::Zero();
  std::optional<double> stand_at_y;
};

/// A temperature that runs linearly from the lowest to the highest point of a body.
struct VerticalRange {
  double bottom = 0.0;
  double top = 0.0;
};

struct BodySettings {
  std::string mesh;
  std::string material;
  PlacementSettings placement;
  Vec3 velocity = Vec3::Zero();
  std::optional<VerticalRange> temperature;
};

/// Where a collider is at one time, from where its placement puts it.
struct KeyframeSettings {
  double time = 0.0;
  Vec3 translate = Vec3::Zero();
  Vec3 rotate_deg = Vec3::Zero();
};

/// How a height field becomes a terrain.
struct TerrainSettings {
  std::optional<double> cell;
  double height_scale = 1.0;
  double lowest = 0.0;
  double highest = 1.0;
  int refine = 1;
  bool closed = true;
  std::optional<double> depth;
};

struct ColliderSettings {
  std::string mesh;
  std::optional<TerrainSettings> terrain;
  PlacementSettings placement;
  double ground_height = 0.0;
  double friction = 0.0;
  double restitution = 0.0;
  bool wall = true;
  Vec3 velocity = Vec3::Zero();
  Vec3 angular_velocity = Vec3::Zero();
  std::optional<Vec3> pivot;
  std::string interpolation = "linear";
  std::vector<KeyframeSettings> keyframes;
  std::optional<double> mass;
  std::optional<double> density;
  Vec3 surface_velocity = Vec3::Zero();
  std::optional<double> temperature;
  std::optional<double> until;

  /// It has a mass: what it meets pushes it back.
  bool rigid() const { return mass || density; }
  Vec3 colour{0.35, 0.36, 0.38};
  std::string material = "matte";
  double roughness = 0.4;
};

/// A vent.
struct EmitterSettings {
  std::string material;
  Vec3 position = Vec3::Zero();
  Vec3 direction{0.0, 1.0, 0.0};
  double radius = 0.0;
  double flow_rate = 0.0;
  std::optional<double> temperature;
  double start = 0.0;
  std::optional<double> end;
};

struct OutflowSettings {
  std::string removes = "inside";
  std::optional<Vec3> lower;
  std::optional<Vec3> upper;
};

/// What the free surface loses heat to.
struct AmbientSettings {
  std::optional<double> temperature;
  double heat_transfer = 0.0;
};

/// What heats the free surface near it: of given power, or a gas of given temperature.
struct HeatSourceSettings {
  Vec3 position = Vec3::Zero();
  double radius = 0.0;
  std::optional<double> power;
  std::optional<double> temperature;
  std::optional<double> heat_transfer;
  Vec3 velocity = Vec3::Zero();
  double from = 0.0;
  std::optional<double> until;
};

/// Where the camera is at one time.
struct CameraKeyframeSettings {
  double time = 0.0;
  std::optional<Vec3> eye;
  std::optional<Vec3> target;
  std::optional<double> vertical_fov_deg;
};

struct CameraSettings {
  std::optional<Vec3> eye;
  std::optional<Vec3> target;
  std::optional<double> vertical_fov_deg;
  std::optional<double> focal_length;
  double film_height = 0.024;
  std::optional<double> f_number;
  std::optional<double> focus_distance;
  double shutter = 0.0;
  std::string interpolation = "smooth";
  std::vector<CameraKeyframeSettings> keyframes;
  int width = 1280;
  int height = 720;
};

struct LightSettings {
  std::string shape = "rectangle";
  Vec3 position = Vec3::Zero();
  Vec3 target = Vec3::Zero();
  double width = 1.0;
  double height = 1.0;
  Vec3 radiance{8.0, 8.0, 8.0};
};

/// Light from far away.
struct EnvironmentSettings {
  std::string kind = "studio";
  std::string image;
  double strength = 1.0;
  double rotate_deg = 0.0;
  double sun_elevation_deg = 40.0;
  double sun_azimuth_deg = 135.0;
  double haze = 1.0;
  std::optional<bool> visible;
};

struct LookSettings {
  /// What is left out is the material's own.
  struct State {
    std::optional<Vec3> colour;
    std::optional<double> roughness;
    std::optional<double> scatter;
  };
  std::string material = "wax";
  State cold;
  State hot;
  std::optional<double> cold_K;
  std::optional<double> hot_K;
  std::optional<double> specular;
  double ior = 1.45;
  double exposure = 1.0;
  std::optional<std::string> tone_curve;
  std::optional<BlackBodyLook> black_body;
  std::optional<CrustLook> crust;
};

struct RenderSettings {
  int samples = RenderOptions{}.samples;
  int bounces = RenderOptions{}.bounces;
  double firefly_limit = 16.0;
  bool denoise = true;
  std::int64_t seed = 1;
  int png_bits = 8;
  bool exr = false;
};

/// Which files a surface becomes, beside the OBJ with its level set.
struct SurfaceOutputs {
  bool ply = false;         ///< surface.NNNN.ply, with velocity, temperature and viscosity per vertex
  bool fog_volume = false;  ///< grid `density` in the VDB
  bool vertex_colours =
      false;  ///< in the OBJ, from temperature: blue at colour_cold, through white, to red at colour_hot
  double colour_cold = 300.0, colour_hot = 400.0;  ///< [K]
};

struct Scene {
  ShotSettings shot;
  ParticleSettings particles;
  Vec3 gravity{0.0, -9.81, 0.0};
  SolverSettings solver;
  TimeStepSettings time_step;
  DomainSettings domain;
  std::optional<PeriodicSettings> periodic;
  std::vector<MaterialSettings> materials;
  std::vector<BodySettings> bodies;
  std::vector<ColliderSettings> colliders;
  std::vector<EmitterSettings> emitters;
  std::vector<OutflowSettings> outflows;
  std::optional<AmbientSettings> ambient;
  std::vector<HeatSourceSettings> heat_sources;
  SurfacingOptions surface;
  SurfaceOutputs surface_outputs;
  CameraSettings camera;
  std::vector<LightSettings> lights;
  EnvironmentSettings environment;
  LookSettings look;
  RenderSettings render;

  std::filesystem::path file;  ///< as it was named
  /// Folder of the scene file: mesh paths are looked up there first, then in smelt's own folder.
  std::filesystem::path folder;

  KeyPlaces places;
};

}  // namespace smelt
