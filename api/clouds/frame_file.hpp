// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>

#include "api/service/frame_reports.hpp"

namespace calibrd::api {

/// One part of the stream of frames: a length (4 bytes, little-endian), so many bytes of JSON, a length, so
/// many bytes of pixels. Pixels: `depth` and `predicted` (2 bytes each, little-endian), then `link` and
/// `class` (1 byte each), plane after plane, row-major. What the JSON holds: docs/api.md.
std::string frame_part(const SensorFrame& frame);

/// The same for a moment without a frame: JSON alone, with `code` and `detail` of the error, and no pixels.
std::string frame_part(const Error& error);

}  // namespace calibrd::api
