// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "core/capture/png.hpp"

#include <spng.h>

#include <bit>
#include <cstring>
#include <fstream>
#include <memory>

#include "core/capture/capture_error.hpp"

namespace calibrd {
namespace {

constexpr std::uint32_t kMaxSide = 8192;
using Context = std::unique_ptr<spng_ctx, decltype(&spng_ctx_free)>;

Result<std::vector<char>> read_bytes(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  std::vector<char> bytes((std::istreambuf_iterator<char>(file)), std::istreambuf_iterator<char>());
  if (!file.good() && bytes.empty()) return fail(CaptureError::unreadable, path.string());
  return bytes;
}

std::uint16_t luminance(const std::uint16_t* rgb) {
  return static_cast<std::uint16_t>((299U * rgb[0] + 587U * rgb[1] + 114U * rgb[2] + 500U) / 1000U);
}

/// Decodes into 16-bit samples. Grey files are asked for as they are, so that 16-bit depth stays exact.
Result<PngImage> decode(spng_ctx* context, const std::string& name) {
  spng_ihdr header{};
  if (int error = spng_get_ihdr(context, &header))
    return fail(CaptureError::bad_png, name + " (" + spng_strerror(error) + ")");
  const bool grey = header.color_type == SPNG_COLOR_TYPE_GRAYSCALE;
  const bool wide = header.bit_depth == 16;
  // spng expands palettes and alpha to RGBA; grey is decoded at its own depth (PNG order with host
  // endianness).
  const int format = !grey ? SPNG_FMT_RGBA16 : wide ? SPNG_FMT_RAW : SPNG_FMT_G8;
  std::size_t size = 0;
  if (spng_decoded_image_size(context, format, &size) != 0) return fail(CaptureError::bad_png, name);
  std::vector<unsigned char> raw(size);
  if (int error = spng_decode_image(context, raw.data(), size, format, 0))
    return fail(CaptureError::bad_png, name + " (" + spng_strerror(error) + ")");

  PngImage image{
      static_cast<int>(header.width), static_cast<int>(header.height), wide ? 16 : 8, grey ? 1 : 3, {}};
  const std::size_t count = std::size_t{header.width} * header.height;
  image.pixels.resize(count);
  for (std::size_t i = 0; i < count; ++i) {
    if (grey && !wide) {
      image.pixels[i] = raw[i];
    } else if (grey) {  // SPNG_FMT_RAW is big endian, as in the file
      image.pixels[i] = static_cast<std::uint16_t>(raw[2 * i] << 8 | raw[2 * i + 1]);
    } else {
      std::uint16_t rgba[4];
      std::memcpy(rgba, raw.data() + 8 * i, sizeof rgba);
      const std::uint16_t value = luminance(rgba);
      image.pixels[i] = wide ? value : static_cast<std::uint16_t>(value / 257);
    }
  }
  return image;
}

}  // namespace

Result<PngImage> read_png(const std::filesystem::path& path) {
  auto bytes = read_bytes(path);
  if (!bytes) return bytes.error();
  const Context context(spng_ctx_new(0), &spng_ctx_free);
  spng_set_image_limits(context.get(), kMaxSide, kMaxSide);
  spng_set_png_buffer(context.get(), bytes->data(), bytes->size());
  return decode(context.get(), path.string());
}

Status write_png16(const std::filesystem::path& path, int width, int height,
                   std::span<const std::uint16_t> pixels) {
  const Context context(spng_ctx_new(SPNG_CTX_ENCODER), &spng_ctx_free);
  spng_set_option(context.get(), SPNG_ENCODE_TO_BUFFER, 1);
  spng_set_option(context.get(), SPNG_IMG_COMPRESSION_LEVEL, 3);
  spng_ihdr header{};
  header.width = static_cast<std::uint32_t>(width);
  header.height = static_cast<std::uint32_t>(height);
  header.bit_depth = 16;
  header.color_type = SPNG_COLOR_TYPE_GRAYSCALE;
  spng_set_ihdr(context.get(), &header);
  int error = spng_encode_image(context.get(), pixels.data(), pixels.size_bytes(), SPNG_FMT_PNG,
                                SPNG_ENCODE_FINALIZE);
  std::size_t size = 0;
  const std::unique_ptr<void, decltype(&std::free)> bytes(
      error == 0 ? spng_get_png_buffer(context.get(), &size, &error) : nullptr, &std::free);
  if (error != 0 || !bytes)
    return fail(CaptureError::unwritable, path.string() + " (" + spng_strerror(error) + ")");
  std::ofstream file(path, std::ios::binary);
  file.write(static_cast<const char*>(bytes.get()), static_cast<std::streamsize>(size));
  file.close();
  if (!file) return fail(CaptureError::unwritable, path.string());
  return Done{};
}

}  // namespace calibrd
