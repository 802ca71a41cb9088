// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
// A recording. Input: capture.json, then, after a line "%png", an image depth_001.png; depth_000.png (16x12)
// and robot.urdf are there. What was read can be written, and what was written can be read.
#include "core/capture/capture.hpp"

#include "core/capture/png.hpp"
#include "tests/core/robot/scratch_folder.hpp"
#include "tests/fuzz/fuzz.hpp"

namespace {

using namespace calibrd;
namespace fs = std::filesystem;

constexpr int kWidth = 16, kHeight = 12;

struct Folder : test::ScratchFolder {
  Folder() {
    write("robot.urdf", "<robot name=\"r\"><link name=\"base_link\"/></robot>");
    std::vector<std::uint16_t> depth(kWidth * kHeight);
    for (std::size_t i = 0; i < depth.size(); ++i) depth[i] = static_cast<std::uint16_t>(1000 + 3 * i);
    fuzz::require(write_png16(path() / "depth_000.png", kWidth, kHeight, depth).has_value(),
                  "an image to start with");
  }
};

void check(const Capture& capture) {
  fuzz::require(fs::is_regular_file(capture.urdf), "the robot model is there");
  fuzz::require(!capture.views.empty(), "a recording has views");
  for (const View& view : capture.views) {
    fuzz::require(view.depth.width == capture.camera.width && view.depth.height == capture.camera.height,
                  "depth of the camera's size");
    fuzz::require(view.joint_positions_rad.size() == capture.joint_names.size(), "a position for each joint");
    for (const double position : view.joint_positions_rad)
      fuzz::require(std::isfinite(position), "finite joints");
    if (view.image) fuzz::require(view.image->width == view.depth.width, "an image of the same pixels");
  }
}

void check_again(const Capture& capture, const fs::path& folder) {
  std::error_code ignored;
  fs::remove_all(folder, ignored);
  const Status written = write_capture(folder, capture, capture.urdf.string());
  if (!written) std::fprintf(stderr, "%s\n", written.error().message().c_str());
  fuzz::require(written.has_value(), "what was read can be written");
  const auto again = read_capture(folder, {});
  if (!again) std::fprintf(stderr, "%s\n", again.error().message().c_str());
  fuzz::require(again && again->views.size() == capture.views.size(), "what was written can be read");
}

}  // namespace

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const Folder scratch;
  fuzz::Input input(data, size);
  scratch.write("capture.json", input.until("\n%png\n"));
  if (!input.empty()) scratch.write("depth_001.png", input.text());
  const auto capture = read_capture(scratch.path(), {});
  if (!capture) {
    fuzz::require(!capture.error().message().empty(), "an error says something");
    return 0;
  }
  check(*capture);
  check_again(*capture, scratch.path() / "again");
  return 0;
}
