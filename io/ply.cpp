#include "io/ply.h"

#include "core/error.h"
#include "io/atomic_file.h"

#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <string_view>
#include <vector>

namespace smelt {
namespace {

static_assert(std::endian::native == std::endian::little, "the file is written as it lies in memory");

/// Appends a float of a vertex after a look at it.
void append(std::string& bytes, const std::filesystem::path& path, std::size_t vertex, std::string_view name,
            float value) {
  if (!std::isfinite(value))
    fail("{}: {} of vertex {} is {} and cannot be written; a surface must be finite, look at its particles",
         path.string(), name, vertex, value);
  char raw[sizeof value];
  std::memcpy(raw, &value, sizeof value);
  bytes.append(raw, sizeof value);
}

std::string make_header(const SurfaceMesh& surface) {
  std::string header = fmt::format(
      "ply\nformat binary_little_endian 1.0\ncomment smelt surface: metres, metres a second, kelvin, pascal seconds\n"
      "element vertex {}\n",
      surface.mesh.vertices.size());
  for (const char* name : {"x", "y", "z", "nx", "ny", "nz", "vx", "vy", "vz"})
    header += fmt::format("property float {}\n", name);
  if (!surface.temperature.empty()) header += "property float temperature\n";
  if (!surface.viscosity.empty()) header += "property float viscosity\n";
  return header + fmt::format("element face {}\nproperty list uchar int vertex_indices\nend_header\n",
                              surface.mesh.triangles.size());
}

}  // namespace

void write_ply(const std::filesystem::path& path, const SurfaceMesh& surface) {
  const TriangleMesh& mesh = surface.mesh;
  const std::size_t n = mesh.vertices.size();
  CHECK_EQ(surface.normals.size(), n);
  CHECK_EQ(surface.velocity.size(), n);
  if (n > static_cast<std::size_t>(std::numeric_limits<std::int32_t>::max()))
    fail("{}: {} vertices are more than PLY can index; take coarser cells", path.string(), n);
  std::string bytes = make_header(surface);
  bytes.reserve(bytes.size() + 44 * n + 13 * mesh.triangles.size());
  for (std::size_t v = 0; v < n; ++v) {
    const Vec3f x = mesh.vertices[v].cast<float>();
    for (const auto& [name, value] : {std::pair<const char*, const Vec3f*>{"position", &x},
                                      {"normal", &surface.normals[v]},
                                      {"velocity", &surface.velocity[v]}})
      for (int a = 0; a < 3; ++a) append(bytes, path, v, name, (*value)[a]);
    if (!surface.temperature.empty()) append(bytes, path, v, "temperature", surface.temperature[v]);
    if (!surface.viscosity.empty()) append(bytes, path, v, "viscosity", surface.viscosity[v]);
  }
  for (const auto& t : mesh.triangles) {
    char raw[13] = {3};
    std::memcpy(raw + 1, t.data(), 12);
    bytes.append(raw, sizeof raw);
  }
  write_file_atomically(path, bytes);
}

}  // namespace smelt
