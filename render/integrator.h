#pragma once
// What camera rays see: path tracing, eight samples at a time.

#include "render/sampling.h"
#include "render/shading_scene.h"

#include <array>
#include <limits>
#include <span>

namespace smelt {

/// Which pair of random numbers serves which decision of the caller.
enum CameraDimension : std::uint32_t { dim_pixel, dim_lens, dim_time, first_surface_dimension };

/// One camera ray (relative to the renderer's origin) and its random numbers.
struct CameraSample {
  Vec3f origin = Vec3f::Zero();
  float time = 0.5f;  ///< within the shutter's, in [0, 1]
  Vec3f direction = Vec3f::UnitZ();
  PixelSampler sampler{0, 0, 0, 1, 0};
  bool meshes = true;  ///< false: the ray is known to miss all meshes
};

/// What one camera ray saw, in parts: radiance is albedo * light + specular + emission, all linear RGB.
struct SampleRadiance {
  SurfaceKind kind = SurfaceKind::none;
  Vec3f light = Vec3f::Zero();  ///< diffusely reflected radiance that a white surface would show
  Vec3f albedo = Vec3f::Zero();
  Vec3f specular = Vec3f::Zero();
  Vec3f emission = Vec3f::Zero();  ///< also the backdrop
  Vec3f normal = Vec3f::Zero();
  Vec3f position = Vec3f::Zero();                               ///< relative to the camera's eye [m]
  float fade = 1.0f;                                            ///< of the floor into the backdrop; 1 where nothing is
  Vec3f colour = Vec3f::Zero();                                 ///< albedo, of metals too
  Vec3f velocity = Vec3f::Zero();                               ///< [m/s]
  float temperature = std::numeric_limits<float>::quiet_NaN();  ///< [K], of the skin; not a number where there is none
  float clamped = 0.0f;                                         ///< luminance that the firefly limit took away
};

/// How far paths are followed.
struct PathOptions {
  int n_bounces = 2;           ///< surfaces after the first one, at least 1
  float firefly_limit = 0.0f;  ///< largest luminance that one path may bring from its bounces; 0: no limit
  bool both_lobes = true;      ///< each sample follows body and coat; false: one of them, by chance
};

/// Traces up to packet_size camera samples. Estimator per sample, at the first surface for body and coat each, or for
/// one of them by chance:
///  - a light (render/light_set.h) and a ray of the lobe's own distribution (cosine; visible GGX normals), combined by
///    the power heuristic [Veach 1997]. The body's begin where the light enters it: with scattering that is a
///    neighbouring point drawn from the normalised diffusion profile [Christensen and Burley 2015] or, through thin
///    parts, the far side; every weight's mean is at most 1, so no light is made.
///  - what the rays meet is lit and left in the same way, seen as its diffusing body, or as a metal, `n_bounces` times;
///    from the third surface on paths end by Russian roulette. The last surface draws one light or one ray to the sky.
/// Unbiased for light paths of that length, but for `firefly_limit`: it darkens, by the sum of `clamped`.
/// Lambert's law and the coat's share are in `light`; the colour is in `albedo` alone, so that a filter can work on the
/// light.
std::array<SampleRadiance, packet_size> trace_packet(const ShadingScene& scene, std::span<const CameraSample> samples,
                                                     const PathOptions& options);

}  // namespace smelt
