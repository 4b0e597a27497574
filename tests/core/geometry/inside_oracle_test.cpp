// The two ways to tell the inside of a mesh, against each other; bench/inside_bench.cpp measures them.

#include "core/geometry/inside.h"
#include "tests/core/geometry/sampled_field.h"
#include "tests/meshes.h"

namespace smelt {
namespace {

/// Where the lattice sites of one mesh lie.
struct Agreement {
  int n_inside = 0;                    ///< by exact predicates
  int n_outside = 0;                   ///< by exact predicates
  int n_differ = 0;                    ///< the field says otherwise
  int n_wrong = 0;                     ///< of these, the solid angle sides with the field
  double furthest_that_differs = 0.0;  ///< from the surface [voxels]
};

Agreement compare(const TriangleMesh& mesh, double spacing, double voxel_size) {
  const InsideTest inside(mesh, spacing);
  const openvdb::FloatGrid::Ptr field = make_field(mesh, voxel_size, Vec3::Zero());
  const FieldSign sign(*field);
  Agreement agreement;
  std::vector<Crossing> crossings;
  const Box3& box = inside.bounds();
  for (double z = box.lower.z() - 0.5 * spacing; z < box.upper.z() + spacing; z += spacing)
    for (double y = box.lower.y() - 0.5 * spacing; y < box.upper.y() + spacing; y += spacing)
      for (double x = box.lower.x() - 0.5 * spacing; x < box.upper.x() + spacing; x += spacing) {
        const Vec3 site(x, y, z);
        const bool is_inside = inside.contains(site, crossings);
        ++(is_inside ? agreement.n_inside : agreement.n_outside);
        if (sign.contains(site) == is_inside) continue;
        ++agreement.n_differ;
        agreement.n_wrong += (std::abs(winding_number(mesh, site)) > 0.5) != is_inside;
        agreement.furthest_that_differs =
            std::max(agreement.furthest_that_differs, distance_to_surface(mesh, site) / voxel_size);
      }
  return agreement;
}

void expect_agreement(const TriangleMesh& mesh) {
  const double spacing = std::cbrt(compute_volume(mesh) / 10188.0);
  for (const double fraction : {1.0, 0.5, 0.25}) {
    const Agreement agreement = compare(mesh, spacing, fraction * spacing);
    // The interpolant of exact distances errs by sqrt(3)/2 voxels at most: a distance changes no faster than its point
    // moves.
    EXPECT_LT(agreement.furthest_that_differs, 1.0) << "voxel " << fraction << ", " << agreement.n_differ << " differ";
    EXPECT_EQ(agreement.n_wrong, 0) << "voxel " << fraction;
    EXPECT_NEAR(agreement.n_inside, 10188, 300);
    EXPECT_GT(agreement.n_outside, 10188);
  }
}

TEST(InsideOracle, AgreesWithOpenVdbOnTheBunny) {
  expect_agreement(load_asset("bunny.obj"));
}

TEST(InsideOracle, AgreesWithOpenVdbOnAThinPlate) {
  expect_agreement(make_tilted_plate());
}

TEST(InsideOracle, AgreesWithOpenVdbOnSpikes) {
  expect_agreement(make_spiky_ball());
}

}  // namespace
}  // namespace smelt
