// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "core/virtual_cell/link_scenes.hpp"

#include <stdexcept>

namespace calibrd {
namespace {

RTCScene build_scene(RTCDevice device, const TriangleMesh& mesh) {
  RTCScene scene = rtcNewScene(device);
  rtcSetSceneBuildQuality(scene, RTC_BUILD_QUALITY_HIGH);
  rtcSetSceneFlags(scene, RTC_SCENE_FLAG_ROBUST);  // no rays slip through between neighbouring triangles
  RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
  auto* vertices = static_cast<float*>(rtcSetNewGeometryBuffer(
      geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 3 * sizeof(float), mesh.vertices.size()));
  for (const auto& vertex : mesh.vertices) vertices = std::copy_n(vertex.data(), 3, vertices);
  auto* indices = static_cast<unsigned*>(rtcSetNewGeometryBuffer(
      geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 3 * sizeof(unsigned), mesh.triangles.size()));
  for (const auto& triangle : mesh.triangles) indices = std::copy_n(triangle.data(), 3, indices);
  rtcCommitGeometry(geometry);
  rtcAttachGeometry(scene, geometry);
  rtcReleaseGeometry(geometry);
  rtcCommitScene(scene);
  return scene;
}

Eigen::AlignedBox3f bounds_of(const TriangleMesh& mesh) {
  Eigen::AlignedBox3f box;
  for (const auto& vertex : mesh.vertices) box.extend(vertex);
  return box;
}

}  // namespace

LinkScenes::LinkScenes(const RobotModel& robot) : device_(rtcNewDevice(nullptr)) {
  if (device_ == nullptr) throw std::runtime_error("Embree could not be started on this machine");
  for (std::size_t i = 0; i < robot.links().size(); ++i) {
    const TriangleMesh& mesh = robot.links()[i].surface;
    if (mesh.triangles.empty()) continue;
    surfaces_.push_back({static_cast<int>(i), build_scene(device_, mesh), bounds_of(mesh)});
  }
}

LinkScenes::~LinkScenes() {
  for (const Surface& surface : surfaces_) rtcReleaseScene(surface.scene);
  rtcReleaseDevice(device_);
}

}  // namespace calibrd
