// Writes the meshes of our own making into the folder given: make_assets assets

#include "core/error.h"
#include "io/obj.h"
#include "surfacing/smooth_mesh.h"

#include <fmt/format.h>

#include "assets/chair.h"
#include "assets/extruded_text.h"
#include "assets/hand.h"
#include <cstdio>
#include <filesystem>

namespace {

/// Of the Debian package fonts-dejavu-core.
constexpr const char* font = "/usr/share/fonts/truetype/dejavu/DejaVuSans-Bold.ttf";

void write_mesh(const std::filesystem::path& path, smelt::TriangleMesh mesh) {
  smelt::SurfaceMesh surface;
  surface.normals = smelt::compute_vertex_normals(mesh);
  surface.mesh = std::move(mesh);
  smelt::write_obj(path, surface);
  fmt::print("{}: {} triangles, volume {:.6g}\n", path.string(), surface.mesh.triangles.size(),
             smelt::compute_volume(surface.mesh));
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) {
    fmt::print(stderr, "usage: make_assets FOLDER\n");
    return 2;
  }
  try {
    const std::filesystem::path folder = argv[1];
    write_mesh(folder / "chair.obj", smelt::make_chair(0.45));
    write_mesh(folder / "hand.obj", smelt::make_hand(0.012));
    write_mesh(folder / "letters.obj", smelt::make_extruded_text(font, "CGF 2007", 0.26, 0.03));
  } catch (const smelt::Error& error) {
    fmt::print(stderr, "{}\n", error.what());
    return 3;
  }
  return 0;
}
