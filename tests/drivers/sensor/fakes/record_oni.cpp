// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
// record_oni FILE COUNT: records COUNT depth frames, and infrared with them, of the first device to an .oni
// file.
#include <OpenNI.h>

#include <cstdio>
#include <cstdlib>

#include "tests/drivers/sensor/fakes/test_pattern.hpp"

namespace {

constexpr int kTimeout_ms = 5000;

void expect(openni::Status status, const char* what) {
  if (status == openni::STATUS_OK) return;
  std::fprintf(stderr, "%s: %s\n", what, openni::OpenNI::getExtendedError());
  std::exit(1);
}

void open_stream(openni::VideoStream& stream, const openni::Device& device, openni::SensorType sensor,
                 openni::PixelFormat format) {
  expect(stream.create(device, sensor), "create");
  openni::VideoMode mode;
  mode.setPixelFormat(format);
  mode.setResolution(calibrd::fake::kWidth, calibrd::fake::kHeight);
  mode.setFps(calibrd::fake::kFps);
  expect(stream.setVideoMode(mode), "mode");
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 3) return 2;
  expect(openni::OpenNI::initialize(), "initialize");
  openni::Device device;
  expect(device.open(openni::ANY_DEVICE), "open");
  openni::VideoStream depth, infrared;
  open_stream(depth, device, openni::SENSOR_DEPTH, openni::PIXEL_FORMAT_DEPTH_1_MM);
  open_stream(infrared, device, openni::SENSOR_IR, openni::PIXEL_FORMAT_GRAY16);

  openni::Recorder recorder;
  expect(recorder.create(argv[1]), "recorder");
  expect(recorder.attach(depth), "attach depth");
  expect(recorder.attach(infrared), "attach infrared");
  expect(recorder.start(), "record");
  expect(infrared.start(), "start infrared");
  expect(depth.start(), "start depth");

  openni::VideoStream* streams[] = {&depth, &infrared};
  openni::VideoFrameRef frame;
  for (int left = std::atoi(argv[2]); left > 0;) {
    int ready = 0;
    expect(openni::OpenNI::waitForAnyStream(streams, 2, &ready, kTimeout_ms), "wait");
    expect(streams[ready]->readFrame(&frame), "read");
    if (ready == 0) --left;
  }
  recorder.stop();
  recorder.destroy();
  std::_Exit(0);  // the file is complete; closing the device races with the driver's thread in OpenNI2
}
