// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
// A client of OpenNI2 that knows nothing of calibrd: opens the first device (or the given URI), prints its mode and
// reads 30 frames of depth.
#include <OpenNI.h>

#include <cstdio>

namespace {

constexpr int kFrames = 30;
constexpr int kTimeout_ms = 5000;

int fail(const char* what) {
  std::fprintf(stderr, "%s: %s\n", what, openni::OpenNI::getExtendedError());
  openni::OpenNI::shutdown();
  return 1;
}

int read_frames(openni::VideoStream& depth) {
  openni::VideoStream* streams[] = {&depth};
  for (int i = 0; i < kFrames; ++i) {
    int ready = 0;
    if (openni::OpenNI::waitForAnyStream(streams, 1, &ready, kTimeout_ms) != openni::STATUS_OK)
      return fail("no frame came");
    openni::VideoFrameRef frame;
    if (depth.readFrame(&frame) != openni::STATUS_OK) return fail("cannot read a frame");
    const auto* pixels = static_cast<const openni::DepthPixel*>(frame.getData());
    const int centre = frame.getHeight() / 2 * frame.getWidth() + frame.getWidth() / 2;
    std::printf("frame %d at %llu us: centre %d mm\n", frame.getFrameIndex(),
                static_cast<unsigned long long>(frame.getTimestamp()), pixels[centre]);
  }
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  if (openni::OpenNI::initialize() != openni::STATUS_OK) return fail("cannot start OpenNI2");
  openni::Device device;
  if (device.open(argc > 1 ? argv[1] : openni::ANY_DEVICE) != openni::STATUS_OK) return fail("cannot open a device");
  openni::VideoStream depth;
  if (depth.create(device, openni::SENSOR_DEPTH) != openni::STATUS_OK) return fail("no depth stream");
  if (depth.start() != openni::STATUS_OK) return fail("cannot start the depth stream");
  const openni::VideoMode mode = depth.getVideoMode();
  std::printf("%s %s, %dx%d at %d Hz, pixel format %d\n", device.getDeviceInfo().getVendor(),
              device.getDeviceInfo().getName(), mode.getResolutionX(), mode.getResolutionY(), mode.getFps(),
              mode.getPixelFormat());
  if (const int failed = read_frames(depth)) return failed;
  depth.stop();
  depth.destroy();
  device.close();
  openni::OpenNI::shutdown();
  return 0;
}
