#pragma once
// What a picture is made of besides the fluid: camera, lights, sky, the look of the material, the ground, the
// colliders.

#include "core/geometry/triangle_mesh.h"
#include "core/geometry/vec.h"
#include "core/image.h"

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

namespace smelt {

/// A pinhole camera or a thin lens. `up` need not be perpendicular to the view, only not parallel to it.
struct Camera {
  Vec3 eye{2.2, 1.15, 4.2};        ///< [m]
  Vec3 target{0.0, 0.45, 0.0};     ///< [m], in the middle of the picture
  Vec3 up{0.0, 1.0, 0.0};          ///< direction
  double vertical_fov_deg = 18.0;  ///< full angle from the bottom to the top edge, in (0, 180)
  int width = 1280;                ///< [pixels]
  int height = 720;                ///< [pixels]
  double aperture = 0.0;           ///< diameter of the lens [m]; 0: a pinhole, all is sharp
  double focus_distance = 0.0;     ///< of the plane that is sharp, along the view [m]; 0: through the target
  double shutter = 0.0;            ///< how long it is open, about the frame's time [s]; 0: an instant
};

enum class LightShape { rectangle, disk };

/// A flat lamp that shines from one side, towards `target`, with the same radiance in every direction (Lambertian).
/// Seen in reflections and by the light it throws, never by the camera itself.
struct AreaLight {
  LightShape shape = LightShape::rectangle;
  Vec3 position{0.0, 3.0, 0.0};      ///< centre [m]
  Vec3 target{0.0, 0.0, 0.0};        ///< the lamp faces this point [m]
  double width = 1.0;                ///< horizontal side of the rectangle, or the diameter of the disk [m]
  double height = 1.0;               ///< other side of the rectangle [m]; a disk does not read it
  Vec3f radiance{8.0f, 8.0f, 8.0f};  ///< linear RGB [W m^-2 sr^-1, up to the exposure]
};

/// Light from far away: radiance by elevation, blended smoothly from `ground` (straight down) over `horizon` to
/// `zenith`. Three equal colours make a constant sky.
struct Sky {
  Vec3f zenith{0.42f, 0.47f, 0.56f};
  Vec3f horizon{0.22f, 0.23f, 0.25f};
  Vec3f ground{0.10f, 0.10f, 0.10f};
};

/// A disk in the sky, infinitely far away.
struct Sun {
  Vec3 direction{0.0, 1.0, 0.0};           ///< towards it
  double angular_radius_deg = 0.2666;      ///< [degrees], in (0, 10]
  Vec3f radiance{2.2e4f, 2.1e4f, 1.9e4f};  ///< linear RGB
};

/// Light from far away by an image of all directions, equirectangular: its top row straight up, its middle towards -z,
/// +x to the right of it. Taken instead of the Sky.
struct Environment {
  std::shared_ptr<const RadianceImage> image;
  double rotate_deg = 0.0;  ///< turns it counter-clockwise, seen from above
  float strength = 1.0f;    ///< factor on its radiance
};

/// What the camera sees behind everything: a studio cove, not a source of light. From `low` to `high` with the view's
/// elevation.
struct Backdrop {
  Vec3f low{0.125f, 0.128f, 0.135f};   ///< radiance at and below low_deg
  Vec3f high{0.022f, 0.024f, 0.028f};  ///< radiance at and above high_deg
  double low_deg = -9.0;               ///< elevation of the view, negative below the horizon, in [-90, 90]
  double high_deg = 2.0;               ///< above low_deg
};

/// A material's appearance at one temperature.
struct Wax {
  Vec3f base_colour{0.8f, 0.7f, 0.55f};  ///< linear RGB albedo under the coat, in [0, 1]
  float roughness = 0.5f;                ///< of the coat, in (0, 1]; the GGX width is its square
  float scatter_m = 0.008f;              ///< how far red light wanders under the surface [m]; 0: none
};

/// What light does at a surface.
enum class MaterialKind {
  wax,   ///< a rough dielectric coat over a diffusing body, with light scattered under the surface
  rock,  ///< the same, opaque
  metal  ///< mirrors alone: `base_colour` is the reflectance at normal incidence
};

/// The surface glows as its temperature says.
struct BlackBodyLook {
  float emissivity = 0.95f;     ///< in (0, 1]
  float white_cd_m2 = 2500.0f;  ///< luminance that counts as a radiance of 1 [cd/m^2]: sunlit white 30000, dusk 100
};

/// Plates with cracks, in coordinates of the unmoved material.
struct CrustLook {
  float plate_m = 1.0f;     ///< size of the plates [m]
  float crack = 0.1f;       ///< width of cracks over the plates' size where it has set, in (0, 0.5]
  float cooler_K = 350.0f;  ///< how much cooler than the fluid its crust is [K]
  float relief = 0.5f;      ///< height of the relief, 0: smooth; in [0, 2]
};

/// The look of the fluid. Between `cold_K` and `hot_K` the cold and the hot state blend smoothly; a fluid without
/// temperatures is cold.
struct Look {
  MaterialKind material = MaterialKind::wax;
  Wax cold{{0.81f, 0.70f, 0.49f}, 0.55f, 0.008f};
  Wax hot{{0.68f, 0.215f, 0.018f}, 0.10f, 0.030f};
  Vec3f scatter_tint{1.0f, 0.55f,
                     0.30f};  ///< scatter distance of red, green and blue, relative to `scatter_m`, in (0, 1]
  float specular = 1.0f;      ///< strength of the coat's reflection: 1 physical, 0 none; in [0, 1]
  float ior = 1.45f;          ///< index of refraction of the coat, > 1
  float cold_K = 300.0f;
  float hot_K = 400.0f;
  std::optional<BlackBodyLook> black_body;  ///< needs temperatures
  std::optional<CrustLook> crust;           ///< needs rest positions
};

/// An endless floor that melts into the backdrop with distance, so that no horizon shows.
struct Ground {
  bool enabled = true;
  double height = 0.0;                 ///< y of the floor [m]
  Vec3f colour{0.27f, 0.265f, 0.26f};  ///< linear RGB albedo, in [0, 1]
  Vec3 centre{0.0, 0.0, 0.0};          ///< distances are counted from here, horizontally [m]
  double fade_start = 2.0;             ///< pure floor up to here [m]
  double fade_end = 9.0;               ///< pure backdrop from here on [m]
};

/// A collider to be seen. `normals` has one entry per vertex (smooth) or none (facets), `velocity` one or none (still).
struct ColliderView {
  TriangleMesh mesh;
  std::vector<Vec3f> normals;
  std::vector<Vec3f> velocity;        ///< [m/s]
  Vec3f colour{0.35f, 0.36f, 0.38f};  ///< linear RGB albedo, or reflectance of a metal, in [0, 1]
  MaterialKind material = MaterialKind::rock;
  float roughness = 0.5f;  ///< of its coat, or of the metal, in (0, 1]
  float specular = 0.0f;   ///< strength of its coat's reflection, in [0, 1]
};

/// How radiance that no display can show is brought back.
enum class ToneCurve {
  neutral,  ///< bright colours keep their hue and bleach
  film      ///< each colour fills up by itself, as in film: red turns to orange, yellow and white
};

struct RenderScene {
  Camera camera;
  std::vector<AreaLight> lights;
  Sky sky;
  std::optional<Sun> sun;
  std::optional<Environment> environment;
  Backdrop backdrop;
  bool show_environment = false;  ///< the camera sees the sky, sun and environment instead of the backdrop
  Look look;
  Ground ground;
  std::vector<ColliderView> colliders;
  double exposure = 1.0;  ///< radiance is multiplied by this before tone mapping, > 0
};

/// Camera, lights and ground that show a body of these bounds [m] well, standing on the floor at `bounds.lower.y`: a
/// three-quarter view with room for a puddle, a soft key from the left, a warm rim from behind. An empty box gives the
/// view of a metre cube at the origin.
RenderScene default_scene(const Box3& bounds);

/// 7680 x 4320: what film work asks for at most.
inline constexpr std::int64_t max_picture_pixels = 7680LL * 4320LL;

/// Throws Error for the first thing in the scene that cannot be rendered: a size or angle out of range, a light without
/// area, a camera that looks nowhere, a resolution beyond memory, a collider with bad indices. Says which and what is
/// allowed.
void check_scene(const RenderScene& scene);

}  // namespace smelt
