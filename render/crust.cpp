#include "render/crust.h"

#include "render/sampling.h"
#include "render/sky.h"
#include "render/texture.h"

namespace smelt {

CrustSample sample_crust(const CrustLook& look, const Vec3f& rest, float solid) {
  const Vec3f x = rest / look.plate_m;
  // Edges bent by noise: straight ones look cut, not broken.
  const Vec3f bent = x + 0.35f * Vec3f(gradient_noise(1.7f * x), gradient_noise(1.7f * x + Vec3f::Constant(31.4f)),
                                       gradient_noise(1.7f * x + Vec3f::Constant(57.9f)));
  const CellSample large = cell_noise(bent);
  const CellSample small = cell_noise(2.7f * bent + Vec3f::Constant(11.3f));
  const float width = look.crack * (1.0f + 1.5f * (1.0f - solid));
  const float rough = fractal_noise(5.0f * x, 3);
  CrustSample sample;
  // Small cracks run through large plates where these have not set yet.
  const float large_cover = smooth_step(0.0f, width, large.edge);
  const float small_cover = smooth_step(0.0f, width, small.edge);
  sample.cover = large_cover * (1.0f - (1.0f - small_cover) * (0.35f + 0.5f * (1.0f - solid)));
  const float lift = unit_float(large.cell) - 0.5f;
  sample.height =
      look.relief * look.plate_m * (0.25f * large_cover * (1.0f + lift) + 0.06f * small_cover + 0.12f * rough);
  sample.tone = 0.8f * rough + 0.6f * lift;
  return sample;
}

float crust_cooling(const CrustLook& look, float cover, float solid) {
  return look.cooler_K * cover * (0.4f + 0.6f * solid);
}

}  // namespace smelt
