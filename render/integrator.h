#pragma once
// What camera rays see: path tracing with one diffuse bounce and one reflection, eight samples at a time.

#include "render/sampling.h"
#include "render/shading_scene.h"

#include <array>
#include <span>

namespace smelt {

/// One camera ray (from the renderer's origin) and its random numbers.
struct CameraSample {
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
  Vec3f position = Vec3f::Zero();  ///< relative to the camera's eye [m]
};

/// Traces up to packet_size camera samples. Estimator per sample:
///  - diffuse: one lamp point and one cosine-distributed ray, taken where the light enters the body. With scattering
///  that is a
///    neighbouring point drawn from the normalised diffusion profile [Christensen and Burley 2015] or, through thin
///    parts, the far side; every weight's mean is at most 1, so no light is made.
///  - coat: one lamp point and one mirrored visible normal (GGX), combined by the power heuristic [Veach 1997].
///  - a surface met by either ray shows its own diffuse light from one lamp point or one sky direction; paths end
///  there.
/// Lambert's law and the coat's share are in `light`; the colour is in `albedo` alone, so that a filter can work on the
/// light.
std::array<SampleRadiance, packet_size> trace_packet(const ShadingScene& scene, std::span<const CameraSample> samples);

}  // namespace smelt
