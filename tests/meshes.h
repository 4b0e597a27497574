#pragma once
// Meshes for tests, small enough to know everything about.

#include "core/geometry/surface_mesh.h"
#include "tests/source_folder.h"

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <map>
#include <numbers>
#include <sstream>
#include <string>

namespace smelt {

/// A closed box, wound outward.
inline TriangleMesh make_box(const Vec3& lower, const Vec3& upper) {
  TriangleMesh mesh;
  for (int v = 0; v < 8; ++v)
    mesh.vertices.emplace_back(v & 1 ? upper.x() : lower.x(), v & 2 ? upper.y() : lower.y(),
                               v & 4 ? upper.z() : lower.z());
  mesh.triangles = {{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
                    {2, 6, 7}, {2, 7, 3}, {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
  return mesh;
}

/// Each triangle split into four.
inline TriangleMesh subdivide(const TriangleMesh& coarse) {
  TriangleMesh fine{coarse.vertices, {}};
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> middles;
  const auto middle = [&](std::uint32_t a, std::uint32_t b) {
    const auto [it, is_new] = middles.try_emplace(std::minmax(a, b), static_cast<std::uint32_t>(fine.vertices.size()));
    if (is_new) fine.vertices.push_back(0.5 * (coarse.vertices[a] + coarse.vertices[b]));
    return it->second;
  };
  for (const auto& [a, b, c] : coarse.triangles) {
    const std::uint32_t ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
    fine.triangles.insert(fine.triangles.end(), {{a, ab, ca}, {b, bc, ab}, {c, ca, bc}, {ab, bc, ca}});
  }
  return fine;
}

/// A sphere of 12 * 4^levels triangles.
inline TriangleMesh make_sphere(const Vec3& centre, double radius, int levels) {
  TriangleMesh mesh = make_box(Vec3::Constant(-1.0), Vec3::Constant(1.0));
  for (int level = 0; level < levels; ++level) mesh = subdivide(mesh);
  for (Vec3& v : mesh.vertices) v = centre + radius * v.normalized();
  return mesh;
}

/// A square plate 1 m wide and 0.03 m thick that lies along no axis.
inline TriangleMesh make_tilted_plate() {
  TriangleMesh mesh = make_box({-0.5, -0.015, -0.5}, {0.5, 0.015, 0.5});
  const Mat3 turn = (Eigen::AngleAxisd(0.4, Vec3::UnitX()) * Eigen::AngleAxisd(0.7, Vec3::UnitZ())).toRotationMatrix();
  for (Vec3& v : mesh.vertices) v = turn * v;
  return mesh;
}

/// A ball of 1 m radius with 98 spikes as long as that, each a fine edge wide at its foot and a point at its tip.
inline TriangleMesh make_spiky_ball() {
  TriangleMesh mesh = make_sphere(Vec3::Zero(), 1.0, 2);
  const std::size_t n_spikes = mesh.vertices.size();
  for (int level = 0; level < 2; ++level) mesh = subdivide(mesh);
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v)
    mesh.vertices[v] = (v < n_spikes ? 2.0 : 1.0) * mesh.vertices[v].normalized();
  return mesh;
}

inline TriangleMesh turned_inside_out(TriangleMesh mesh) {
  for (auto& t : mesh.triangles) std::swap(t[1], t[2]);
  return mesh;
}

/// Both meshes side by side in one.
inline TriangleMesh joined(TriangleMesh a, const TriangleMesh& b) {
  const auto first = static_cast<std::uint32_t>(a.vertices.size());
  a.vertices.insert(a.vertices.end(), b.vertices.begin(), b.vertices.end());
  for (const auto& t : b.triangles) a.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
  return a;
}

/// The winding number as the sum of solid angles over 4 pi. [Van Oosterom & Strackee 1983]
inline double winding_number(const TriangleMesh& mesh, const Vec3& p) {
  double angle = 0.0;
  for (const auto& t : mesh.triangles) {
    const Vec3 a = mesh.vertices[t[0]] - p, b = mesh.vertices[t[1]] - p, c = mesh.vertices[t[2]] - p;
    const double la = a.norm(), lb = b.norm(), lc = c.norm();
    angle += 2.0 * std::atan2(a.dot(b.cross(c)), la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb);
  }
  return angle / (4.0 * std::numbers::pi);
}

/// Vertices and triangles of a plain OBJ file in the source tree, faults and all.
inline TriangleMesh load_asset(const std::string& name) {
  std::ifstream file(source_folder().string() + "/assets/" + name);
  EXPECT_TRUE(file.good()) << name;
  TriangleMesh mesh;
  for (std::string line; std::getline(file, line);) {
    std::istringstream words(line);
    std::string keyword;
    words >> keyword;
    if (keyword == "v") {
      Vec3 v;
      words >> v.x() >> v.y() >> v.z();
      mesh.vertices.push_back(v);
    } else if (keyword == "f") {
      std::array<std::uint32_t, 3> t{};
      words >> t[0] >> t[1] >> t[2];
      mesh.triangles.push_back({t[0] - 1, t[1] - 1, t[2] - 1});
    }
  }
  return mesh;
}

/// The message of the exception of type `Expected` that `act` throws.
template <typename Expected, typename Act>
std::string message_of(Act act) {
  try {
    act();
  } catch (const Expected& e) {
    return e.what();
  }
  ADD_FAILURE() << "nothing was thrown";
  return {};
}

}  // namespace smelt
