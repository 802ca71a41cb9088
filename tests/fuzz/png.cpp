// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
// A PNG image of a recording, read as one of a camera that has its size, or another. Input: which camera,
// then the file.
#include "core/capture/png.hpp"
#include "tests/core/robot/scratch_folder.hpp"
#include "tests/fuzz/fuzz.hpp"

namespace {

/// As the file's header has it, within what a test may unpack.
int side_in(std::string_view file, std::size_t at) {
  int side = 0;
  for (std::size_t i = at; i < at + 4 && i < file.size(); ++i)
    side = (side << 8 | static_cast<unsigned char>(file[i])) & 0xff;
  return side;
}

}  // namespace

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace calibrd;
  static const test::ScratchFolder scratch;
  fuzz::Input input(data, size);
  const bool fits = (input.byte() & 1U) == 0;
  CameraModel camera;
  camera.width = fits ? side_in(input.text(), 16) : 16;
  camera.height = fits ? side_in(input.text(), 20) : 12;
  const auto image = read_png(scratch.write("image.png", input.text()), &camera);
  if (!image) {
    fuzz::require(!image.error().message().empty(), "an error says something");
    return 0;
  }
  fuzz::require(image->width == camera.width && image->height == camera.height,
                "an image of the camera's size");
  fuzz::require(image->pixels.size() == static_cast<std::size_t>(camera.width * camera.height),
                "a value for each pixel");
  fuzz::require(image->bit_depth == 8 || image->bit_depth == 16, "8 or 16 bits");
  if (image->bit_depth == 8)
    for (const auto pixel : image->pixels) fuzz::require(pixel <= 255, "8-bit files keep their values");
  return 0;
}
