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

std::uint32_t number_at(std::string_view file, std::size_t at) {
  std::uint32_t number = 0;
  for (std::size_t i = at; i < at + 4; ++i) number = number << 8 | static_cast<unsigned char>(file[i]);
  return number;
}

/// CRC-32 as PNG has it (ISO 3309).
std::uint32_t checksum(std::string_view bytes) {
  std::uint32_t crc = 0xffffffff;
  for (const char c : bytes) {
    crc ^= static_cast<unsigned char>(c);
    for (int bit = 0; bit < 8; ++bit) crc = crc >> 1 ^ (crc & 1U ? 0xedb88320U : 0U);
  }
  return ~crc;
}

void put_checksums_right(std::string& file) {
  constexpr std::size_t kSignature = 8, kAround = 12;  // length, type and checksum of a chunk
  for (std::size_t at = kSignature; at + kAround <= file.size();) {
    const std::size_t length = number_at(file, at);
    if (length > file.size() - at - kAround) return;
    const std::uint32_t crc = checksum(std::string_view(file).substr(at + 4, 4 + length));
    for (std::size_t i = 0; i < 4; ++i) file[at + 8 + length + i] = static_cast<char>(crc >> (24 - 8 * i));
    at += kAround + length;
  }
}

}  // namespace

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace calibrd;
  static const test::ScratchFolder scratch;
  fuzz::Input input(data, size);
  const std::uint8_t variant = input.byte();
  const bool fits = (variant & 1U) == 0;
  std::string file(input.text());
  if (variant & 2U) put_checksums_right(file);
  CameraModel camera;
  camera.width = fits ? side_in(file, 16) : 16;
  camera.height = fits ? side_in(file, 20) : 12;
  const auto image = read_png(scratch.write("image.png", file), &camera);
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
