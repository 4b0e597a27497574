#include "render/embree_scene.h"

#include "core/error.h"

#include <embree3/rtcore.h>
#include <tbb/task_arena.h>

namespace smelt {

struct EmbreeScene::Handles {
  RTCDevice device = nullptr;
  RTCScene scene = nullptr;
  int n_meshes = 0;

  void check(const char* doing) const {
    const RTCError error = rtcGetDeviceError(device);
    if (error == RTC_ERROR_NONE) return;
    if (error == RTC_ERROR_OUT_OF_MEMORY)
      fail("render: out of memory while {}; use a coarser surface or smaller picture", doing);
    throw InternalError(fmt::format("render: Embree error {} while {}", static_cast<int>(error), doing));
  }
};

EmbreeScene::EmbreeScene() : handles_(std::make_unique<Handles>()) {
  handles_->device = rtcNewDevice(nullptr);
  handles_->check("opening the ray tracer");
  handles_->scene = rtcNewScene(handles_->device);
  // Robust: no ray may slip through the seam of two triangles.
  rtcSetSceneFlags(handles_->scene, RTC_SCENE_FLAG_ROBUST);
}

EmbreeScene::~EmbreeScene() {
  if (handles_->scene != nullptr) rtcReleaseScene(handles_->scene);
  if (handles_->device != nullptr) rtcReleaseDevice(handles_->device);
}

int EmbreeScene::add_mesh(const TriangleMesh& mesh, const Vec3& origin, std::span<const Vec3f> velocity,
                          float shutter) {
  const int number = handles_->n_meshes++;
  if (mesh.triangles.empty()) return number;
  RTCGeometry geometry = rtcNewGeometry(handles_->device, RTC_GEOMETRY_TYPE_TRIANGLE);
  const bool moving = shutter > 0.0f && !velocity.empty();
  rtcSetGeometryTimeStepCount(geometry, moving ? 2 : 1);
  for (unsigned step = 0; step < (moving ? 2u : 1u); ++step) {
    auto* vertices = static_cast<float*>(rtcSetNewGeometryBuffer(
        geometry, RTC_BUFFER_TYPE_VERTEX, step, RTC_FORMAT_FLOAT3, 3 * sizeof(float), mesh.vertices.size()));
    handles_->check("copying a mesh");
    const float time = moving ? (static_cast<float>(step) - 0.5f) * shutter : 0.0f;
    for (std::size_t v = 0; v < mesh.vertices.size(); ++v)
      for (int i = 0; i < 3; ++i) {
        const auto at_rest = static_cast<float>(mesh.vertices[v][i] - origin[i]);
        *vertices++ = moving ? at_rest + velocity[v][i] * time : at_rest;
      }
  }
  auto* indices = static_cast<std::uint32_t*>(rtcSetNewGeometryBuffer(
      geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 3 * sizeof(std::uint32_t), mesh.triangles.size()));
  handles_->check("copying a mesh");
  for (const auto& triangle : mesh.triangles) {
    for (const std::uint32_t index : triangle) *indices++ = index;
  }
  rtcCommitGeometry(geometry);
  rtcAttachGeometryByID(handles_->scene, geometry, static_cast<unsigned>(number));
  rtcReleaseGeometry(geometry);
  return number;
}

int EmbreeScene::add_spheres(std::span<const Vec3> centres, double radius, const Vec3& origin) {
  const int number = handles_->n_meshes++;
  if (centres.empty()) return number;
  RTCGeometry geometry = rtcNewGeometry(handles_->device, RTC_GEOMETRY_TYPE_SPHERE_POINT);
  auto* spheres = static_cast<float*>(rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT4,
                                                              4 * sizeof(float), centres.size()));
  handles_->check("copying particles");
  for (const Vec3& centre : centres) {
    for (int i = 0; i < 3; ++i) *spheres++ = static_cast<float>(centre[i] - origin[i]);
    *spheres++ = static_cast<float>(radius);
  }
  rtcCommitGeometry(geometry);
  rtcAttachGeometryByID(handles_->scene, geometry, static_cast<unsigned>(number));
  rtcReleaseGeometry(geometry);
  return number;
}

void EmbreeScene::commit() {
  // One thread builds the hierarchy: two could order its leaves differently from run to run, and so the pictures.
  // (Embree's own "threads=1" would hold all of oneTBB to one thread.)
  tbb::task_arena(1).execute([&] { rtcCommitScene(handles_->scene); });
  handles_->check("building the ray hierarchy");
}

namespace {

/// Fills Embree's ray layout; returns whether any ray is active.
bool load(const RayPacket& rays, RTCRay8& out, std::array<int, packet_size>& valid) {
  bool any = false;
  for (std::size_t i = 0; i < packet_size; ++i) {
    const Ray& ray = rays[i];
    valid[i] = ray.active && ray.meshes ? -1 : 0;
    any = any || valid[i] != 0;
    out.org_x[i] = ray.origin.x();
    out.org_y[i] = ray.origin.y();
    out.org_z[i] = ray.origin.z();
    out.dir_x[i] = ray.direction.x();
    out.dir_y[i] = ray.direction.y();
    out.dir_z[i] = ray.direction.z();
    out.tnear[i] = ray.t_near;
    out.tfar[i] = ray.t_far;
    out.time[i] = ray.time;
    out.mask[i] = ~0U;
    out.id[i] = 0;
    out.flags[i] = 0;
  }
  return any;
}

}  // namespace

HitPacket EmbreeScene::intersect(const RayPacket& rays, bool coherent) const {
  HitPacket hits;
  RTCRayHit8 packet;
  alignas(32) std::array<int, packet_size> valid;
  if (!load(rays, packet.ray, valid)) return hits;
  for (std::size_t i = 0; i < packet_size; ++i)
    packet.hit.geomID[i] = packet.hit.instID[0][i] = RTC_INVALID_GEOMETRY_ID;
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  if (coherent) context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
  rtcIntersect8(valid.data(), handles_->scene, &context, &packet);
  for (std::size_t i = 0; i < packet_size; ++i) {
    if (valid[i] == 0 || packet.hit.geomID[i] == RTC_INVALID_GEOMETRY_ID) continue;
    hits[i] = {static_cast<int>(packet.hit.geomID[i]),
               packet.hit.primID[i],
               packet.ray.tfar[i],
               packet.hit.u[i],
               packet.hit.v[i],
               {packet.hit.Ng_x[i], packet.hit.Ng_y[i], packet.hit.Ng_z[i]}};
  }
  return hits;
}

std::array<bool, packet_size> EmbreeScene::occluded(const RayPacket& rays) const {
  std::array<bool, packet_size> blocked{};
  RTCRay8 packet;
  alignas(32) std::array<int, packet_size> valid;
  if (!load(rays, packet, valid)) return blocked;
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  rtcOccluded8(valid.data(), handles_->scene, &context, &packet);
  for (std::size_t i = 0; i < packet_size; ++i) blocked[i] = valid[i] != 0 && packet.tfar[i] < 0.0f;
  return blocked;
}

}  // namespace smelt
