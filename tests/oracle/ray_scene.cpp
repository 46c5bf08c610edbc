#include "oracle/ray_scene.h"

#if __has_include(<embree4/rtcore.h>)
#include <embree4/rtcore.h>
#else
#include <embree3/rtcore.h>
#endif

#include <algorithm>
#include <cstring>
#include <glm/geometric.hpp>
#include <limits>

#include "occlod/base.h"

namespace occlod::test {
namespace {

void intersect(RTCScene scene, RTCRayHit& ray) {
#if RTC_VERSION_MAJOR >= 4
  rtcIntersect1(scene, &ray);
#else
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  rtcIntersect1(scene, &context, &ray);
#endif
}

RTCRayHit ray_from(const glm::vec3& o, const glm::vec3& d, float t_min) {
  RTCRayHit ray{};
  ray.ray = {o.x, o.y, o.z, t_min, d.x, d.y, d.z, 0.0F, std::numeric_limits<float>::infinity(), ~0U, 0, 0};
  ray.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  return ray;
}

// Builds on the calling thread: the same tree every time.
struct Device {
  Device() : handle(rtcNewDevice("threads=1")) {
    if (handle == nullptr)
      throw Error({"Embree", "", "gives no device", "look at what rtcGetDeviceError says on this machine"});
  }
  ~Device() { rtcReleaseDevice(handle); }
  Device(const Device&) = delete;
  Device& operator=(const Device&) = delete;

  RTCDevice handle;
};

// A copy, with the padding behind the last element that Embree asks for.
template <class T>
void fill(RTCGeometry geometry, RTCBufferType type, RTCFormat format, std::span<const T> data) {
  void* buffer = rtcSetNewGeometryBuffer(geometry, type, 0, format, sizeof(T), data.size());
  std::memcpy(buffer, data.data(), data.size_bytes());
}

}  // namespace

class RayScene::Embree {
 public:
  Embree(std::span<const glm::vec3> positions, std::span<const Triangle> triangles)
      : scene_(rtcNewScene(device_.handle)) {
    rtcSetSceneFlags(scene_, RTC_SCENE_FLAG_ROBUST);
    RTCGeometry geometry = rtcNewGeometry(device_.handle, RTC_GEOMETRY_TYPE_TRIANGLE);
    if (!triangles.empty()) {
      fill(geometry, RTC_BUFFER_TYPE_VERTEX, RTC_FORMAT_FLOAT3, positions);
      fill(geometry, RTC_BUFFER_TYPE_INDEX, RTC_FORMAT_UINT3, triangles);
    }
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(scene_, geometry);
    rtcReleaseGeometry(geometry);
    rtcCommitScene(scene_);
  }
  ~Embree() { rtcReleaseScene(scene_); }
  Embree(const Embree&) = delete;
  Embree& operator=(const Embree&) = delete;

  [[nodiscard]] RTCScene scene() const { return scene_; }

 private:
  Device device_;
  RTCScene scene_;
};

RayScene::RayScene(std::span<const glm::vec3> positions, std::span<const Triangle> triangles)
    : positions_(positions.begin(), positions.end()),
      triangles_(triangles.begin(), triangles.end()),
      embree_(std::make_unique<Embree>(positions_, triangles_)) {}

RayScene::~RayScene() = default;

RayScene::Hit RayScene::first_triangle(const glm::vec3& origin, const glm::vec3& direction) const {
  RTCRayHit ray = ray_from(origin, direction, 0.0F);
  intersect(embree_->scene(), ray);
  if (ray.hit.geomID == RTC_INVALID_GEOMETRY_ID) return {};
  return {ray.hit.primID, ray.ray.tfar};
}

double RayScene::first_hit(const glm::dvec3& origin, const glm::dvec3& direction, double t_min) const {
  RTCRayHit ray = ray_from(glm::vec3(origin), glm::vec3(direction), static_cast<float>(t_min));
  intersect(embree_->scene(), ray);
  if (ray.hit.geomID == RTC_INVALID_GEOMETRY_ID) return std::numeric_limits<double>::infinity();
  const Triangle& t = triangles_[ray.hit.primID];
  const glm::dvec3 a = glm::dvec3(positions_[t.x]) - origin, b = glm::dvec3(positions_[t.y]) - origin,
                   c = glm::dvec3(positions_[t.z]) - origin;
  const glm::dvec3 normal = glm::cross(b - a, c - a);
  // A hit is between the corners along the ray, however grazing it is.
  const glm::dvec3 along = glm::dvec3(glm::dot(a, direction), glm::dot(b, direction), glm::dot(c, direction)) /
                           glm::dot(direction, direction);
  const double across = glm::dot(normal, direction);
  const double hit = across == 0.0 ? double{ray.ray.tfar} : glm::dot(normal, a) / across;
  return std::clamp(hit, std::min({along.x, along.y, along.z}), std::max({along.x, along.y, along.z}));
}

}  // namespace occlod::test
