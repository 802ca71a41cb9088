// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "drivers/sensor/child/capture.hpp"

#include <algorithm>
#include <array>

#include "drivers/sensor/child/process_guard.hpp"

namespace calibrd {
namespace {

using namespace std::chrono_literals;
using std::chrono::steady_clock;

constexpr auto kLongestWait = 100ms;  // also the slowest heartbeat, and the delay of SIGTERM
constexpr int kMostBadFrames = 10;    // a damaged USB transfer is a lost frame, a row of them is a wrong mode
constexpr int kMostAloneFrames = 90;
constexpr int kAssumedFps = 30;

std::chrono::microseconds period_of(const VideoMode& mode) {
  return std::chrono::microseconds(1s) / (mode.fps > 0 ? mode.fps : kAssumedFps);
}

std::uint32_t unit_um(PixelFormat format) { return format == PixelFormat::depth_100_um ? 100 : 1000; }

std::array<PixelFormat, 2> depth_formats(int preferred_unit_um) {
  if (preferred_unit_um == 100) return {PixelFormat::depth_100_um, PixelFormat::depth_1_mm};
  return {PixelFormat::depth_1_mm, PixelFormat::depth_100_um};
}

constexpr std::array kInfraredFormats{PixelFormat::grey16, PixelFormat::grey8};
constexpr std::array kColorFormats{PixelFormat::grey8, PixelFormat::rgb888, PixelFormat::yuyv,
                                   PixelFormat::yuv422};

std::string size_text(const StreamRequest& r) {
  return std::to_string(r.width) + "x" + std::to_string(r.height) + " at " + std::to_string(r.fps);
}

}  // namespace

Status Capture::open(const OpenNi& library) {
  auto device = OpenNiDevice::open(library, request_);
  if (!device) return device.error();
  device_ = std::move(*device);
  if (auto opened = open_depth(); !opened) return opened;
  open_image();
  return start();
}

Status Capture::open_depth() {
  if (!device_->handle().hasSensor(openni::SENSOR_DEPTH))
    return sensor_error(SensorError::no_depth_stream, device_->description());
  const auto offers = device_->modes(openni::SENSOR_DEPTH);
  const auto mode = choose_mode(offers, request_.width, request_.height, request_.fps,
                                depth_formats(request_.depth_unit_um));
  if (!mode)
    return sensor_error(SensorError::mode_not_offered,
                        size_text(request_) + "; " + device_->description() + " offers " + describe(offers));
  auto stream = OpenNiStream::create(*device_, openni::SENSOR_DEPTH, *mode, request_.mirror);
  if (!stream) return stream.error();
  depth_ = std::move(*stream);
  return Done{};
}

/// Without its image the sensor still calibrates, so what is wrong with the image is a notice, not a failure.
void Capture::open_image() {
  const bool is_color = request_.image == ImageKind::color;
  const bool is_registered = register_depth(is_color);
  if (request_.image == ImageKind::none) return;
  auto stream = is_color && !is_registered
                    ? Result<std::unique_ptr<OpenNiStream>>(sensor_error(
                          SensorError::stream_failed, "the device does not register depth to colour"))
                    : image_stream(is_color);
  if (stream)
    image_ = std::move(*stream);
  else
    notice_ = "depth without image: " + stream.error().detail;
}

/// Depth in the colour camera's pixel grid, or in its own, whatever the driver's default is.
bool Capture::register_depth(bool to_color) {
  openni::Device& device = device_->handle();
  const auto mode = to_color ? openni::IMAGE_REGISTRATION_DEPTH_TO_COLOR : openni::IMAGE_REGISTRATION_OFF;
  // Asked first: some drivers accept what they do not do.
  return device.isImageRegistrationModeSupported(mode) &&
         device.setImageRegistrationMode(mode) == openni::STATUS_OK;
}

Result<std::unique_ptr<OpenNiStream>> Capture::image_stream(bool is_color) {
  const auto sensor = is_color ? openni::SENSOR_COLOR : openni::SENSOR_IR;
  const auto offers = device_->modes(sensor);
  const std::span<const PixelFormat> formats =
      is_color ? std::span<const PixelFormat>(kColorFormats) : std::span<const PixelFormat>(kInfraredFormats);
  auto mode = choose_mode(offers, request_.width, request_.height, depth_->mode().fps, formats);
  if (!mode) mode = choose_mode(offers, request_.width, request_.height, 0, formats);
  if (!mode)
    return sensor_error(SensorError::mode_not_offered,
                        std::string("the device's ") + (is_color ? "colour" : "infrared") +
                            " camera offers no grey image of the depth image's size, but " +
                            describe(offers));
  return OpenNiStream::create(*device_, sensor, *mode, request_.mirror);
}

/// The image first: a recording runs as soon as one stream does, and a depth frame needs its partner.
Status Capture::start() {
  if (image_)
    if (auto started = image_->start(); !started) return started;
  depth_pixels_.resize(static_cast<std::size_t>(request_.width) * static_cast<std::size_t>(request_.height));
  image_pixels_.resize(image_ ? depth_pixels_.size() : 0);
  return depth_->start();
}

SensorStreaming Capture::description() const {
  const VideoMode& mode = depth_->mode();
  return {.device = device_->description(),
          .notice = notice_,
          .width = static_cast<std::uint16_t>(mode.width),
          .height = static_cast<std::uint16_t>(mode.height),
          .fps = static_cast<std::uint16_t>(mode.fps),
          .depth_unit_um = unit_um(mode.format)};
}

Status Capture::run(FrameRingWriter& ring, ParentLink& parent) {
  Pairing pairing(image_ != nullptr, period_of(depth_->mode()));
  parent.send(description());
  auto idle_at = steady_clock::now();
  while (!is_stop_requested()) {
    ring.beat();
    hold_up_.look(steady_clock::now());
    const auto received = receive(pairing);
    if (!received) return received.error();
    // Time counts only once nothing is left to read: a late process must not take its own delay for the
    // image's.
    if (!*received) idle_at = steady_clock::now();
    while (auto pair = pairing.next(idle_at))
      if (auto delivered = deliver(*pair, ring, parent); !delivered) return delivered;
    if (auto checked = check_device(!*received); !checked) return checked;
  }
  return Done{};
}

Result<bool> Capture::receive(Pairing& pairing) {
  std::array<openni::VideoStream*, 2> streams{image_ ? &image_->handle() : &depth_->handle(),
                                              &depth_->handle()};
  auto wait = kLongestWait;
  if (const auto deadline = pairing.deadline())
    wait =
        std::clamp(std::chrono::ceil<std::chrono::milliseconds>(*deadline - steady_clock::now()), 0ms, wait);
  int ready = -1;
  const auto status = openni::OpenNI::waitForAnyStream(streams.data(), image_ ? 2 : 1, &ready,
                                                       static_cast<int>(wait.count()));
  if (status == openni::STATUS_TIME_OUT) return false;
  if (status != openni::STATUS_OK) return openni_error(SensorError::stream_failed, device_->description());
  accept(image_ && ready == 0, pairing);
  return true;
}

void Capture::accept(bool is_image, Pairing& pairing) {
  const auto stamp = steady_clock::now();
  auto frame = (is_image ? image_ : depth_)->read();
  hold_up_.look(stamp);
  if (!frame.isValid() || !hold_up_.is_over(stamp)) return;
  const Moment moment = moment_of(frame);
  if (is_image) return pairing.add_image(frame, moment);
  last_index_ = moment.index;
  if (const auto sequence = numbering_.number(moment))
    pairing.add_depth({frame, *sequence, stamp}, moment, stamp);
}

Status Capture::deliver(Pairing::Pair& pair, FrameRingWriter& ring, ParentLink& parent) {
  if (auto copied = depth_->copy(pair.depth.frame, depth_pixels_); !copied)
    return ++bad_in_a_row_ > kMostBadFrames ? copied : Status(Done{});
  bad_in_a_row_ = 0;
  const bool has_image = pair.image && image_->copy(*pair.image, image_pixels_);
  ring.publish(
      {.depth = depth_pixels_,
       .image = has_image ? std::span<const std::uint16_t>(image_pixels_) : std::span<const std::uint16_t>(),
       .sequence = pair.depth.sequence,
       .stamp = pair.depth.stamp,
       .depth_unit_um = unit_um(depth_->mode().format)});
  parent.wake();
  if (image_) note_pairing(has_image, parent);
  return Done{};
}

/// Tells once when images come that fit no depth frame, and once when they fit again.
void Capture::note_pairing(bool is_paired, ParentLink& parent) {
  const bool was_told = alone_in_a_row_ >= kMostAloneFrames;
  alone_in_a_row_ = is_paired ? 0 : std::min(alone_in_a_row_ + 1, kMostAloneFrames);
  const bool is_alone = alone_in_a_row_ >= kMostAloneFrames;
  if (is_alone == was_told) return;
  notice_ =
      is_alone ? "depth without image: no image comes that matches the depth frames in time and size" : "";
  parent.send(description());
}

Status Capture::check_device(bool is_idle) const {
  if (device_->is_disconnected()) return sensor_error(SensorError::disconnected, device_->description());
  const int recorded = depth_->recorded_frames();
  const bool is_over = device_->has_ended() || (recorded > 0 && last_index_ >= recorded);
  if (is_idle && is_over && !request_.loop)
    return sensor_error(SensorError::recording_ended, request_.recording);
  return Done{};
}

}  // namespace calibrd
