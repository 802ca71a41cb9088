// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "core/virtual_cell/virtual_cell.hpp"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <limits>

#include "core/virtual_cell/link_scenes.hpp"
#include "core/virtual_cell/nearest_surface.hpp"
#include "core/virtual_cell/ray_tables.hpp"

namespace calibrd {
namespace {

using Box2 = Eigen::AlignedBox2f;
constexpr float kNear_m = 0.01F;

/// Where the directions (x, y, 1) to a link can lie; an infinite box when part of it is beside or behind the
/// sensor.
Box2 directions_to(const Eigen::AlignedBox3f& bounds, const Eigen::Isometry3f& T_sensor_link) {
  Box2 directions;
  for (int corner = 0; corner < 8; ++corner) {
    const Eigen::Vector3f p =
        T_sensor_link * bounds.corner(static_cast<Eigen::AlignedBox3f::CornerType>(corner));
    if (p.z() < kNear_m) {
      constexpr float kAll = std::numeric_limits<float>::max();
      return {Eigen::Vector2f(-kAll, -kAll), Eigen::Vector2f(kAll, kAll)};
    }
    directions.extend(Eigen::Vector2f(p.x() / p.z(), p.y() / p.z()));
  }
  return directions;
}

RTCRayHit8 make_rays(const RayTable::Packet& packet, const Eigen::Matrix3f& R_base_sensor,
                     const Eigen::Vector3f& origin) {
  RTCRayHit8 rays;
  for (int k = 0; k < RayTable::kPacketSize; ++k) {
    const Eigen::Vector3f direction = R_base_sensor * Eigen::Vector3f(packet.x[k], packet.y[k], 1.0F);
    rays.ray.org_x[k] = origin.x();
    rays.ray.org_y[k] = origin.y();
    rays.ray.org_z[k] = origin.z();
    rays.ray.dir_x[k] = direction.x();
    rays.ray.dir_y[k] = direction.y();
    rays.ray.dir_z[k] = direction.z();
    rays.ray.tnear[k] = kNear_m;
    rays.ray.tfar[k] = std::numeric_limits<float>::infinity();
    rays.ray.time[k] = 0;
    rays.ray.mask[k] = 0xFFFFFFFFU;
    rays.ray.flags[k] = 0;
    rays.hit.geomID[k] = RTC_INVALID_GEOMETRY_ID;
    rays.hit.instID[0][k] = RTC_INVALID_GEOMETRY_ID;
  }
  return rays;
}

/// Nothing hit in rows [first, end), or to the last one.
void clear_rows(int first, int end, VirtualMeasurement& out) {
  const auto from = static_cast<std::ptrdiff_t>(first) * out.width,
             to = static_cast<std::ptrdiff_t>(std::min(end, out.height)) * out.width;
  std::fill(out.depth_m.begin() + from, out.depth_m.begin() + to, 0.0F);
  std::fill(out.normal.begin() + from, out.normal.begin() + to, Eigen::Vector3f::Zero());
  std::fill(out.link.begin() + from, out.link.begin() + to, std::int16_t{-1});
}

}  // namespace

struct VirtualCell::Impl {
  Impl(const RobotModel& model, std::shared_ptr<const LinkScenes> shared_links,
       std::shared_ptr<RayTables> shared_tables)
      : robot(&model), links(std::move(shared_links)), ray_tables(std::move(shared_tables)) {
    scene = rtcNewScene(links->device());
    rtcSetSceneFlags(scene, RTC_SCENE_FLAG_ROBUST | RTC_SCENE_FLAG_DYNAMIC);
    for (const LinkScenes::Surface& surface : links->surfaces()) {
      RTCGeometry instance = rtcNewGeometry(links->device(), RTC_GEOMETRY_TYPE_INSTANCE);
      rtcSetGeometryInstancedScene(instance, surface.scene);
      rtcSetGeometryTimeStepCount(instance, 1);
      rtcAttachGeometryByID(scene, instance, static_cast<unsigned>(instances.size()));
      instances.push_back(instance);
    }
  }
  ~Impl() {
    for (RTCGeometry instance : instances) rtcReleaseGeometry(instance);
    rtcReleaseScene(scene);
  }
  Impl(const Impl&) = delete;
  Impl& operator=(const Impl&) = delete;

  void trace(const RayTable::Packet& packet, int column, int row, const Eigen::Isometry3f& T_base_sensor,
             const std::vector<Eigen::Matrix3f>& R_sensor_link, VirtualMeasurement& out) const;

  const RobotModel* robot;
  std::shared_ptr<const LinkScenes> links;
  RTCScene scene = nullptr;
  std::vector<RTCGeometry> instances;  // one per surface of `links`
  std::vector<Pose> T_base_link;       // one per link of the robot
  std::shared_ptr<RayTables> ray_tables;
  mutable std::shared_ptr<const RayTable> rays;
};

void VirtualCell::Impl::trace(const RayTable::Packet& packet, int column, int row,
                              const Eigen::Isometry3f& T_base_sensor,
                              const std::vector<Eigen::Matrix3f>& R_sensor_link,
                              VirtualMeasurement& out) const {
  alignas(32) static constexpr int kAllValid[RayTable::kPacketSize] = {-1, -1, -1, -1, -1, -1, -1, -1};
  alignas(32) RTCRayHit8 hits = make_rays(packet, T_base_sensor.linear(), T_base_sensor.translation());
  embree::intersect8(kAllValid, scene, hits);
  for (int k = 0; k < RayTable::kPacketSize; ++k) {
    const unsigned instance = hits.hit.instID[0][k];
    const int u = column * RayTable::kPacketWidth + k % RayTable::kPacketWidth;
    const int v = row * RayTable::kPacketHeight + k / RayTable::kPacketWidth;
    if (instance == RTC_INVALID_GEOMETRY_ID || u >= out.width || v >= out.height) continue;
    const std::size_t pixel =
        static_cast<std::size_t>(v) * static_cast<std::size_t>(out.width) + static_cast<std::size_t>(u);
    const Eigen::Vector3f in_link(hits.hit.Ng_x[k], hits.hit.Ng_y[k], hits.hit.Ng_z[k]);
    const Eigen::Vector3f normal = (R_sensor_link[instance] * in_link).normalized();
    const Eigen::Vector3f direction(packet.x[k], packet.y[k], 1.0F);
    out.depth_m[pixel] = hits.ray.tfar[k];  // directions have z = 1, so the ray parameter is the depth
    out.normal[pixel] = normal.dot(direction) > 0 ? Eigen::Vector3f(-normal) : normal;
    out.link[pixel] = static_cast<std::int16_t>(links->surfaces()[instance].link);
  }
}

VirtualCell::VirtualCell(const RobotModel& robot)
    : impl_(
          std::make_unique<Impl>(robot, std::make_shared<LinkScenes>(robot), std::make_shared<RayTables>())) {
  set_joints(std::vector<double>(robot.position_count(), 0.0));
}
VirtualCell::VirtualCell(const VirtualCell& other)
    : impl_(std::make_unique<Impl>(*other.impl_->robot, other.impl_->links, other.impl_->ray_tables)) {
  place(other.impl_->T_base_link);
}
VirtualCell::~VirtualCell() = default;
VirtualCell::VirtualCell(VirtualCell&&) noexcept = default;
VirtualCell& VirtualCell::operator=(VirtualCell&&) noexcept = default;

void VirtualCell::set_joints(std::span<const double> positions) {
  place(impl_->robot->forward_kinematics(positions));
}

void VirtualCell::place(std::vector<Pose> T_base_link) {
  impl_->T_base_link = std::move(T_base_link);
  for (std::size_t i = 0; i < impl_->instances.size(); ++i) {
    const auto link = static_cast<std::size_t>(impl_->links->surfaces()[i].link);
    const Eigen::Matrix4f matrix = impl_->T_base_link[link].matrix().cast<float>();
    rtcSetGeometryTransform(impl_->instances[i], 0, RTC_FORMAT_FLOAT4X4_COLUMN_MAJOR, matrix.data());
    rtcCommitGeometry(impl_->instances[i]);
  }
  rtcCommitScene(impl_->scene);
}

SurfaceHit VirtualCell::hit_along(const Eigen::Vector3d& direction_sensor, const Pose& T_base_sensor) const {
  const Eigen::Vector3f origin = T_base_sensor.translation().cast<float>();
  const Eigen::Vector3f direction = (T_base_sensor.linear() * direction_sensor).cast<float>();
  RTCRayHit hit{};
  hit.ray.org_x = origin.x();
  hit.ray.org_y = origin.y();
  hit.ray.org_z = origin.z();
  hit.ray.dir_x = direction.x();
  hit.ray.dir_y = direction.y();
  hit.ray.dir_z = direction.z();
  hit.ray.tnear = kNear_m;
  hit.ray.tfar = std::numeric_limits<float>::infinity();
  hit.ray.mask = 0xFFFFFFFFU;
  hit.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  hit.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
  embree::intersect1(impl_->scene, hit);
  if (hit.hit.geomID == RTC_INVALID_GEOMETRY_ID) return {};
  const auto link = static_cast<std::size_t>(impl_->links->surfaces()[hit.hit.instID[0]].link);
  const Eigen::Matrix3d R_sensor_link =
      T_base_sensor.linear().transpose() * impl_->T_base_link[link].linear();
  const Eigen::Vector3f in_link(hit.hit.Ng_x, hit.hit.Ng_y, hit.hit.Ng_z);
  const Eigen::Vector3f normal = (R_sensor_link.cast<float>() * in_link).normalized();
  return {hit.ray.tfar, normal.dot(direction_sensor.cast<float>()) > 0 ? Eigen::Vector3f(-normal) : normal};
}

std::optional<SurfacePoint> VirtualCell::nearest_surface(const Eigen::Vector3d& point_base,
                                                         double within_m) const {
  std::optional<SurfacePoint> nearest;
  for (const LinkScenes::Surface& surface : impl_->links->surfaces()) {
    const auto link = static_cast<std::size_t>(surface.link);
    const Pose& T_base_link = impl_->T_base_link[link];
    const Eigen::Vector3d point_link = T_base_link.inverse() * point_base;
    const auto found = nearest_on_link(surface, impl_->robot->links()[link].surface, point_link.cast<float>(),
                                       static_cast<float>(within_m));
    if (!found) continue;
    within_m = (found->cast<double>() - point_link).norm();
    nearest = SurfacePoint{surface.link, T_base_link * found->cast<double>(), within_m};
  }
  return nearest;
}

const RobotModel& VirtualCell::robot() const { return *impl_->robot; }

std::shared_ptr<const PixelRays> VirtualCell::pixel_rays(const CameraModel& camera) const {
  const std::shared_ptr<const RayTable> table = impl_->ray_tables->of(camera);
  return {table, &table->pixel_rays()};
}

const std::vector<Pose>& VirtualCell::link_poses() const { return impl_->T_base_link; }

void VirtualCell::measure(const CameraModel& camera, const Pose& T_base_sensor,
                          VirtualMeasurement& out) const {
  const std::size_t pixels = static_cast<std::size_t>(camera.width) * static_cast<std::size_t>(camera.height);
  out.width = camera.width;
  out.height = camera.height;
  out.depth_m.resize(pixels);
  out.normal.resize(pixels);
  out.link.resize(pixels);
  if (!impl_->rays || !impl_->rays->fits(camera)) impl_->rays = impl_->ray_tables->of(camera);

  std::vector<Eigen::Matrix3f> R_sensor_link;
  std::vector<Box2> reach;
  for (const LinkScenes::Surface& surface : impl_->links->surfaces()) {
    const Pose T_sensor_link =
        T_base_sensor.inverse() * impl_->T_base_link[static_cast<std::size_t>(surface.link)];
    R_sensor_link.push_back(T_sensor_link.linear().cast<float>());
    reach.push_back(directions_to(surface.bounds, T_sensor_link.cast<float>()));
  }
  const Eigen::Isometry3f T = T_base_sensor.cast<float>();
  const RayTable& rays = *impl_->rays;
  tbb::parallel_for(tbb::blocked_range<int>(0, rays.rows(), 8), [&](const tbb::blocked_range<int>& rows) {
    clear_rows(rows.begin() * RayTable::kPacketHeight, rows.end() * RayTable::kPacketHeight, out);
    for (int row = rows.begin(); row < rows.end(); ++row) {
      for (int column = 0; column < rays.columns(); ++column) {
        const RayTable::Packet& packet = rays.packet(column, row);
        const auto meets = [&](const Box2& box) { return box.intersects(packet.bounds); };
        if (std::ranges::any_of(reach, meets)) impl_->trace(packet, column, row, T, R_sensor_link, out);
      }
    }
  });
}

}  // namespace calibrd
