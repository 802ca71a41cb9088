// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <spng.h>

#include <cstdlib>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

namespace calibrd::test {

/// A PNG of any kind. `samples` are the bytes of the rows: 16-bit samples in host order.
inline std::string png_of(unsigned width, unsigned height, spng_color_type color_type, int bit_depth,
                          const std::vector<unsigned char>& samples, bool interlaced = false) {
  const std::unique_ptr<spng_ctx, decltype(&spng_ctx_free)> context(spng_ctx_new(SPNG_CTX_ENCODER),
                                                                    &spng_ctx_free);
  spng_set_option(context.get(), SPNG_ENCODE_TO_BUFFER, 1);
  spng_ihdr header{};
  header.width = width;
  header.height = height;
  header.bit_depth = static_cast<std::uint8_t>(bit_depth);
  header.color_type = static_cast<std::uint8_t>(color_type);
  header.interlace_method = interlaced ? 1 : 0;
  spng_set_ihdr(context.get(), &header);
  int error =
      spng_encode_image(context.get(), samples.data(), samples.size(), SPNG_FMT_PNG, SPNG_ENCODE_FINALIZE);
  std::size_t size = 0;
  const std::unique_ptr<void, decltype(&std::free)> bytes(
      error == 0 ? spng_get_png_buffer(context.get(), &size, &error) : nullptr, &std::free);
  if (!bytes) throw std::runtime_error(spng_strerror(error));
  return {static_cast<const char*>(bytes.get()), size};
}

/// Rows of one 16-bit value each, in host order, as png_of takes them.
inline std::vector<unsigned char> samples16(const std::vector<std::uint16_t>& values) {
  const auto* bytes = reinterpret_cast<const unsigned char*>(values.data());
  return {bytes, bytes + 2 * values.size()};
}

}  // namespace calibrd::test
