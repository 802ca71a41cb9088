// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "core/capture/png.hpp"

#include <spng.h>

#include <cstring>
#include <fstream>
#include <memory>

#include "core/capture/capture_error.hpp"
#include "core/capture/capture_rules.hpp"
#include "core/capture/file_bytes.hpp"

namespace calibrd {
namespace {

constexpr std::uint32_t kMaxSide = 8192;
constexpr std::uintmax_t kMaxPngBytes = 1U << 30U;
constexpr std::size_t kMaxChunkBytes = 64U << 20U;  // of side data, unpacked
using Context = std::unique_ptr<spng_ctx, decltype(&spng_ctx_free)>;

std::uint16_t luminance(const std::uint16_t* rgb) {
  return static_cast<std::uint16_t>((299U * rgb[0] + 587U * rgb[1] + 114U * rgb[2] + 500U) / 1000U);
}

Error bad_png(const std::string& name, int error) {
  return fail(CaptureError::bad_png, name + " (" + spng_strerror(error) + ")");
}

/// One 16-bit value per pixel from what spng unpacked in `format`.
std::vector<std::uint16_t> to_grey16(const std::vector<unsigned char>& raw, int format, bool wide,
                                     std::size_t count) {
  std::vector<std::uint16_t> pixels(count);
  for (std::size_t i = 0; i < count; ++i) {
    if (format == SPNG_FMT_G8) {
      pixels[i] = raw[i];
    } else if (format == SPNG_FMT_RAW) {  // big endian, as in the file
      pixels[i] = static_cast<std::uint16_t>(raw[2 * i] << 8 | raw[2 * i + 1]);
    } else {
      std::uint16_t rgba[4];
      std::memcpy(rgba, raw.data() + 8 * i, sizeof rgba);
      const std::uint16_t value = luminance(rgba);
      pixels[i] = wide ? value : static_cast<std::uint16_t>(value / 257);  // 8 bits were spread over 16
    }
  }
  return pixels;
}

Result<PngImage> decode(spng_ctx* context, const std::string& name, const CameraModel* camera) {
  spng_ihdr header{};
  if (int error = spng_get_ihdr(context, &header)) return bad_png(name, error);
  PngImage image{static_cast<int>(header.width),
                 static_cast<int>(header.height),
                 header.bit_depth == 16 ? 16 : 8,
                 header.color_type == SPNG_COLOR_TYPE_GRAYSCALE ? 1 : 3,
                 {}};
  if (camera != nullptr)
    if (auto ok = check_image_size(image.width, image.height, *camera, name); !ok) return ok.error();
  // Grey is asked for at its own depth, so that 16-bit depth stays exact; spng expands palettes and alpha to
  // RGBA.
  const bool wide = image.bit_depth == 16;
  const int format = image.channels == 3 ? SPNG_FMT_RGBA16 : wide ? SPNG_FMT_RAW : SPNG_FMT_G8;
  std::size_t size = 0;
  if (int error = spng_decoded_image_size(context, format, &size)) return bad_png(name, error);
  std::vector<unsigned char> raw(size);
  if (int error = spng_decode_image(context, raw.data(), size, format, 0)) return bad_png(name, error);
  if (int error = spng_decode_chunks(context)) return bad_png(name, error);  // whole to its end?
  image.pixels = to_grey16(raw, format, wide, std::size_t{header.width} * header.height);
  return image;
}

}  // namespace

Result<PngImage> read_png(const std::filesystem::path& path, const CameraModel* camera) {
  const auto bytes = read_bytes(path, kMaxPngBytes);
  if (!bytes) return bytes.error();
  const Context context(spng_ctx_new(0), &spng_ctx_free);
  spng_set_image_limits(context.get(), kMaxSide, kMaxSide);
  spng_set_chunk_limits(context.get(), kMaxChunkBytes, kMaxChunkBytes);
  spng_set_png_buffer(context.get(), bytes->data(), bytes->size());
  return decode(context.get(), path.string(), camera);
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
