#include "core/geometry/simplex_bvh.h"

#include "core/error.h"

#include <embree3/rtcore.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <utility>

namespace smelt {

/// The whole set's box turns most queries away; in 3D Embree answers the rest, in 1D and 2D sets are small enough to scan.
template <int Dim>
struct SimplexBvh<Dim>::Index {
  Box<Dim> bounds;
  RTCDevice device = nullptr;
  RTCScene scene = nullptr;

  ~Index() {
    if (scene) rtcReleaseScene(scene);
    if (device) rtcReleaseDevice(device);
  }
};

namespace {

void build_embree_scene(const std::vector<Simplex<3>>& triangles, RTCDevice& device, RTCScene& scene) {
  device = rtcNewDevice(nullptr);
  if (!device) throw InternalError("Embree refused to make a device");
  scene = rtcNewScene(device);
  rtcSetSceneFlags(scene, RTC_SCENE_FLAG_ROBUST);
  RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
  auto* vertices = static_cast<float*>(rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                                              3 * sizeof(float), 3 * triangles.size()));
  auto* indices = static_cast<std::uint32_t*>(rtcSetNewGeometryBuffer(
      geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 3 * sizeof(std::uint32_t), triangles.size()));
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    for (std::size_t k = 0; k < 3; ++k) {
      for (int axis = 0; axis < 3; ++axis)
        vertices[9 * t + 3 * k + static_cast<std::size_t>(axis)] = static_cast<float>(triangles[t][k][axis]);
      indices[3 * t + k] = static_cast<std::uint32_t>(3 * t + k);
    }
  }
  rtcCommitGeometry(geometry);
  rtcAttachGeometry(scene, geometry);
  rtcReleaseGeometry(geometry);
  // One thread, as its result may depend on how many there are. (Embree's own "threads=1" would hold all of oneTBB to one thread.)
  tbb::task_arena(1).execute([&] { rtcCommitScene(scene); });
  if (rtcGetDeviceError(device) != RTC_ERROR_NONE) throw InternalError("Embree failed to build a scene of triangles");
}

}  // namespace

template <int Dim>
SimplexBvh<Dim>::SimplexBvh(std::vector<Simplex<Dim>> simplices)
    : simplices_(std::move(simplices)), index_(std::make_unique<Index>()) {
  for (const auto& simplex : simplices_)
    for (const auto& corner : simplex) index_->bounds.extend(corner);
  if constexpr (Dim == 3)
    if (!simplices_.empty()) build_embree_scene(simplices_, index_->device, index_->scene);
}

template <int Dim>
SimplexBvh<Dim>::~SimplexBvh() = default;
template <int Dim>
SimplexBvh<Dim>::SimplexBvh(SimplexBvh&&) noexcept = default;
template <int Dim>
SimplexBvh<Dim>& SimplexBvh<Dim>::operator=(SimplexBvh&&) noexcept = default;

template <int Dim>
void SimplexBvh<Dim>::find_near(const Vec<Dim>& point, double radius, std::vector<std::uint32_t>& found) const {
  const Box<Dim>& bounds = index_->bounds;
  if ((point.array() < bounds.lower.array() - radius).any() || (point.array() > bounds.upper.array() + radius).any()) return;
  if constexpr (Dim == 3) {
    // Embree's boxes and distances are floats: widen the search by what rounding may take away.
    const double magnitude = std::max(bounds.lower.cwiseAbs().maxCoeff(), bounds.upper.cwiseAbs().maxCoeff());
    RTCPointQuery query{};
    query.x = static_cast<float>(point[0]);
    query.y = static_cast<float>(point[1]);
    query.z = static_cast<float>(point[2]);
    query.radius = static_cast<float>(1.0001 * radius + 1e-6 * magnitude);
    RTCPointQueryContext context;
    rtcInitPointQueryContext(&context);
    const auto collect = [](RTCPointQueryFunctionArguments* arguments) {
      static_cast<std::vector<std::uint32_t>*>(arguments->userPtr)->push_back(arguments->primID);
      return false;  // the radius stays as it is
    };
    const std::size_t first = found.size();
    rtcPointQuery(index_->scene, &query, &context, collect, &found);
    std::sort(found.begin() + static_cast<std::ptrdiff_t>(first), found.end());
  } else {
    for (std::size_t k = 0; k < simplices_.size(); ++k)
      if ((point - closest_point<Dim>(point, simplices_[k])).norm() <= radius) found.push_back(static_cast<std::uint32_t>(k));
  }
}

template <int Dim>
double SimplexBvh<Dim>::distance(const Vec<Dim>& point, double limit) const {
  const Box<Dim>& bounds = index_->bounds;
  if ((point.array() < bounds.lower.array() - limit).any() || (point.array() > bounds.upper.array() + limit).any()) return limit;
  if constexpr (Dim == 3) {
    struct Nearest {
      const std::vector<Simplex<3>>& simplices;
      Vec3 point;
      double distance, rounding;
    };
    const double magnitude = std::max(bounds.lower.cwiseAbs().maxCoeff(), bounds.upper.cwiseAbs().maxCoeff());
    Nearest nearest{simplices_, point, limit, 1e-6 * magnitude};
    RTCPointQuery query{};
    query.x = static_cast<float>(point[0]);
    query.y = static_cast<float>(point[1]);
    query.z = static_cast<float>(point[2]);
    query.radius = static_cast<float>(1.0001 * limit + nearest.rounding);
    RTCPointQueryContext context;
    rtcInitPointQueryContext(&context);
    const auto approach = [](RTCPointQueryFunctionArguments* arguments) {
      auto& found = *static_cast<Nearest*>(arguments->userPtr);
      const double distance = (found.point - closest_point<3>(found.point, found.simplices[arguments->primID])).norm();
      if (!(distance < found.distance)) return false;
      found.distance = distance;
      arguments->query->radius = static_cast<float>(1.0001 * distance + found.rounding);
      return true;  // the radius has shrunk
    };
    rtcPointQuery(index_->scene, &query, &context, approach, &nearest);
    return nearest.distance;
  } else {
    double nearest = limit;
    for (const Simplex<Dim>& simplex : simplices_) nearest = std::min(nearest, (point - closest_point<Dim>(point, simplex)).norm());
    return nearest;
  }
}

template class SimplexBvh<1>;
template class SimplexBvh<2>;
template class SimplexBvh<3>;

}  // namespace smelt
