#include "render/texture.h"

#include "render/sampling.h"

#include <array>
#include <cmath>
#include <limits>

namespace smelt {

namespace {

std::uint32_t hash_lattice(int x, int y, int z) {
  return hash_u32(static_cast<std::uint32_t>(x) * 0x8da6b343U + static_cast<std::uint32_t>(y) * 0xd8163841U +
                  static_cast<std::uint32_t>(z) * 0xcb1ab31fU);
}

/// Dot product of `d` with one of the twelve directions to the edges of a cube.
float edge_gradient(std::uint32_t hash, float x, float y, float z) {
  const std::uint32_t h = hash & 15U;
  const float u = h < 8 ? x : y;
  const float v = h < 4 ? y : (h == 12 || h == 14 ? x : z);
  return ((h & 1U) != 0 ? -u : u) + ((h & 2U) != 0 ? -v : v);
}

float quintic(float t) {
  return t * t * t * (t * (t * 6.0f - 15.0f) + 10.0f);
}

float lerp(float a, float b, float t) {
  return a + t * (b - a);
}

}  // namespace

float gradient_noise(const Vec3f& x) {
  const float fx = std::floor(x.x()), fy = std::floor(x.y()), fz = std::floor(x.z());
  const int ix = static_cast<int>(fx), iy = static_cast<int>(fy), iz = static_cast<int>(fz);
  const float dx = x.x() - fx, dy = x.y() - fy, dz = x.z() - fz;
  const auto corner = [&](int i, int j, int k) {
    return edge_gradient(hash_lattice(ix + i, iy + j, iz + k), dx - static_cast<float>(i), dy - static_cast<float>(j),
                         dz - static_cast<float>(k));
  };
  const float u = quintic(dx), v = quintic(dy), w = quintic(dz);
  const float near = lerp(lerp(corner(0, 0, 0), corner(1, 0, 0), u), lerp(corner(0, 1, 0), corner(1, 1, 0), u), v);
  const float far = lerp(lerp(corner(0, 0, 1), corner(1, 0, 1), u), lerp(corner(0, 1, 1), corner(1, 1, 1), u), v);
  return lerp(near, far, w);
}

float fractal_noise(const Vec3f& x, int octaves) {
  float sum = 0.0f, height = 1.0f;
  Vec3f at = x;
  for (int k = 0; k < octaves; ++k) {
    sum += height * gradient_noise(at);
    height *= 0.5f;
    // Shifted, so that the lattices of two octaves never meet in one point.
    at = 2.0f * at + Vec3f(17.31f, 5.77f, 41.13f);
  }
  return sum;
}

CellSample cell_noise(const Vec3f& x) {
  const float fx = std::floor(x.x()), fy = std::floor(x.y()), fz = std::floor(x.z());
  const int ix = static_cast<int>(fx), iy = static_cast<int>(fy), iz = static_cast<int>(fz);
  float first = std::numeric_limits<float>::infinity(), second = first;
  CellSample sample;
  for (int k = -1; k <= 1; ++k)
    for (int j = -1; j <= 1; ++j)
      for (int i = -1; i <= 1; ++i) {
        const std::uint32_t hash = hash_lattice(ix + i, iy + j, iz + k);
        const auto part = [hash](int shift) { return static_cast<float>((hash >> shift) & 1023U) * (1.0f / 1024.0f); };
        const Vec3f d(fx + static_cast<float>(i) + part(0) - x.x(), fy + static_cast<float>(j) + part(10) - x.y(),
                      fz + static_cast<float>(k) + part(20) - x.z());
        const float d2 = d.squaredNorm();
        if (d2 < first) {
          second = first;
          first = d2;
          sample.cell = hash;
        } else if (d2 < second) {
          second = d2;
        }
      }
  sample.edge = 0.5f * (std::sqrt(second) - std::sqrt(first));
  return sample;
}

}  // namespace smelt
