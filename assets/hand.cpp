#include "assets/hand.h"

#include "assets/implicit_mesh.h"
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

namespace smelt {

namespace {

/// A shaft of radius `radius` from `from` to `to` with a ball at either end.
struct Bone {
  Vec3 from, to;
  double radius;
};

constexpr double knob = 1.3;    ///< radius of a ball over that of its shaft
constexpr double fillet = 0.3;  ///< how far bones blend, over the radius

constexpr double degrees = std::numbers::pi / 180.0;
constexpr double tilt = 62.0 * degrees;  ///< of the palm, back from upright
const Vec3 wrist(0.0, 0.52, 0.0);

/// From the hand's own axes (x towards the thumb, y along the fingers, z out of the palm) into the world.
Vec3 turn(const Vec3& v) {
  return {v[0], std::cos(tilt) * v[1] + std::sin(tilt) * v[2], -std::sin(tilt) * v[1] + std::cos(tilt) * v[2]};
}

/// Along a finger that points `aside` degrees towards the thumb and is bent `curl` degrees out of the palm's plane.
Vec3 finger_direction(double aside, double curl) {
  const double a = aside * degrees, c = curl * degrees;
  return turn(Vec3(std::cos(c) * std::sin(a), std::cos(c) * std::cos(a), std::sin(c)));
}

/// A chain of bones, each bent on by `bend` degrees from the one before.
void add_chain(std::vector<Bone>& bones, Vec3 from, double aside, double curl, double bend,
               const std::vector<double>& lengths, double radius) {
  for (const double length : lengths) {
    const Vec3 to = from + length * finger_direction(aside, curl);
    bones.push_back({from, to, radius});
    from = to;
    curl += bend;
    radius *= 0.93;
  }
}

std::vector<Bone> make_bones() {
  std::vector<Bone> bones;
  // Radius and ulna.
  bones.push_back({Vec3(0.075, 0.06, 0.0), wrist + Vec3(0.06, 0.0, 0.0), 0.05});
  bones.push_back({Vec3(-0.075, 0.06, 0.0), wrist + Vec3(-0.06, 0.0, 0.0), 0.046});
  // The wrist: two rows of small bones.
  for (int row = 0; row < 2; ++row)
    for (int i = 0; i < 4; ++i) {
      const Vec3 at = wrist + turn(Vec3(0.105 - 0.07 * i, 0.05 + 0.07 * row, 0.0));
      bones.push_back({at, at, 0.038});
    }
  // Index to little finger: bone of the palm, then three of the finger.
  add_chain(bones, wrist + turn(Vec3(0.100, 0.13, 0.0)), 16.0, 4.0, 22.0, {0.30, 0.19, 0.125, 0.09}, 0.040);
  add_chain(bones, wrist + turn(Vec3(0.033, 0.14, 0.0)), 4.0, 2.0, 22.0, {0.30, 0.21, 0.140, 0.10}, 0.040);
  add_chain(bones, wrist + turn(Vec3(-0.035, 0.13, 0.0)), -9.0, 4.0, 22.0, {0.28, 0.19, 0.130, 0.095}, 0.038);
  add_chain(bones, wrist + turn(Vec3(-0.100, 0.12, 0.0)), -23.0, 8.0, 22.0, {0.25, 0.15, 0.105, 0.08}, 0.036);
  // The thumb, across the palm.
  add_chain(bones, wrist + turn(Vec3(0.115, 0.05, 0.02)), 62.0, 22.0, 20.0, {0.20, 0.16, 0.12}, 0.042);
  return bones;
}

double bone_distance(const Bone& bone, const Vec3& x) {
  const Vec3 axis = bone.to - bone.from;
  const double length2 = axis.squaredNorm();
  const double along = length2 > 0.0 ? std::clamp((x - bone.from).dot(axis) / length2, 0.0, 1.0) : 0.0;
  const double shaft = (x - bone.from - along * axis).norm() - bone.radius;
  const double ends = std::min((x - bone.from).norm(), (x - bone.to).norm()) - knob * bone.radius;
  return std::min(shaft, ends);
}

/// The lesser of two distances, rounded where they differ by less than `width`.
double blend(double a, double b, double width) {
  const double t = std::max(width - std::abs(a - b), 0.0) / width;
  return std::min(a, b) - 0.25 * width * t * t;
}

}  // namespace

TriangleMesh make_hand(double cell) {
  const std::vector<Bone> bones = make_bones();
  const auto distance = [&](const Vec3& x) {
    double nearest = std::numeric_limits<double>::infinity();
    for (const Bone& bone : bones) {
      const double d = bone_distance(bone, x);
      nearest = std::isinf(nearest) ? d : blend(nearest, d, fillet * bone.radius);
    }
    return nearest;
  };
  Box3 box;
  box.lower = Vec3::Constant(-1.5);
  box.upper = Vec3::Constant(1.5);
  return make_implicit_mesh(distance, box, cell, 4);
}

}  // namespace smelt
