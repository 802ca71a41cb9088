// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "core/capture/ply_cloud.hpp"

#include <array>
#include <bit>
#include <charconv>
#include <cstdint>
#include <optional>
#include <sstream>
#include <string>

#include "core/capture/file_bytes.hpp"

namespace calibrd {
namespace {

class PlyErrorCategory final : public std::error_category {
 public:
  const char* name() const noexcept override { return "ply"; }
  std::string message(int value) const override {
    switch (static_cast<PlyError>(value)) {
      case PlyError::not_ply:
        return "this is not a PLY file; give a point cloud in binary little-endian PLY";
      case PlyError::bad_header:
        return "the PLY header cannot be understood; export the cloud again";
      case PlyError::not_binary_little_endian:
        return "only binary little-endian PLY can be read; export the cloud in that format";
      case PlyError::no_vertices:
        return "the PLY file has no element vertex in front; export the points as vertices";
      case PlyError::wrong_properties:
        return "the vertices need x, y and z as float (32 bit), in metres, and no list; export the cloud so";
      case PlyError::truncated:
        return "the file ends before its last point; copy or export it again";
    }
    return "unknown PLY error";
  }
};

Error fail(PlyError error, std::string detail) { return {make_error_code(error), std::move(detail)}; }

constexpr std::uintmax_t kMaxBytes = 1 << 30;

/// Where the floats of a vertex lie.
struct Layout {
  std::size_t count = 0;
  std::size_t stride = 0;                                 // bytes of a vertex
  std::array<std::optional<std::size_t>, 3> coordinates;  // bytes from its begin to x, y, z
  std::size_t data = 0;                                   // bytes from the file's begin to the first vertex
};

/// Bytes of a PLY scalar type; 0: unknown.
std::size_t size_of(const std::string& type) {
  for (const char* name : {"char", "uchar", "int8", "uint8"})
    if (type == name) return 1;
  for (const char* name : {"short", "ushort", "int16", "uint16"})
    if (type == name) return 2;
  for (const char* name : {"int", "uint", "int32", "uint32", "float", "float32"})
    if (type == name) return 4;
  return type == "double" || type == "float64" ? 8 : 0;
}

std::optional<std::size_t> to_count(const std::string& text) {
  std::size_t count = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), count);
  if (error != std::errc{} || end != text.data() + text.size() || text.empty()) return std::nullopt;
  return count;
}

/// Reads the header line by line; each line is one statement.
class Header {
 public:
  Status take(const std::string& line) {
    std::istringstream words(line);
    std::string keyword, first, second;
    words >> keyword >> first >> second;
    if (keyword == "format") return take_format(first, second);
    if (keyword == "element") return take_element(first, second);
    if (keyword == "property") return take_property(line, first, second);
    if (keyword == "comment" || keyword == "obj_info" || keyword.empty()) return Done{};
    return fail(PlyError::bad_header, line.substr(0, 80));
  }

  Result<Layout> finished(std::size_t data) {
    if (!has_format_) return fail(PlyError::bad_header, "no format");
    if (elements_ == 0) return fail(PlyError::no_vertices, "no element");
    for (const auto& place : layout_.coordinates)
      if (!place) return fail(PlyError::wrong_properties, "x, y or z is missing");
    layout_.data = data;
    return layout_;
  }

 private:
  Status take_format(const std::string& format, const std::string& version) {
    if (format != "binary_little_endian" || version != "1.0")
      return fail(PlyError::not_binary_little_endian, "format " + format + " " + version);
    has_format_ = true;
    return Done{};
  }

  Status take_element(const std::string& name, const std::string& number) {
    const auto count = to_count(number);
    if (!count) return fail(PlyError::bad_header, "element " + name + " " + number);
    if (++elements_ > 1) return Done{};
    if (name != "vertex") return fail(PlyError::no_vertices, "element " + name);
    layout_.count = *count;
    return Done{};
  }

  Status take_property(const std::string& line, const std::string& type, const std::string& name) {
    if (elements_ > 1) return Done{};
    const std::size_t size = size_of(type);
    if (elements_ == 0 || size == 0) return fail(PlyError::wrong_properties, line.substr(0, 80));
    if (name.size() == 1 && name[0] >= 'x' && name[0] <= 'z') {
      auto& place = layout_.coordinates[static_cast<std::size_t>(name[0] - 'x')];
      if ((type != "float" && type != "float32") || place) return fail(PlyError::wrong_properties, line);
      place = layout_.stride;
    }
    layout_.stride += size;
    return Done{};
  }

  Layout layout_;
  int elements_ = 0;
  bool has_format_ = false;
};

Result<Layout> read_header(const std::string& bytes) {
  Header header;
  bool is_first = true;
  for (std::size_t begin = 0; begin < bytes.size();) {
    const std::size_t end = bytes.find('\n', begin);
    if (end == std::string::npos) break;
    std::string line = bytes.substr(begin, end - begin);
    if (line.ends_with('\r')) line.pop_back();
    begin = end + 1;
    if (is_first && line != "ply") return fail(PlyError::not_ply, "it does not begin with \"ply\"");
    if (line == "end_header") return header.finished(begin);
    if (!is_first)
      if (auto taken = header.take(line); !taken) return taken.error();
    is_first = false;
  }
  if (is_first) return fail(PlyError::not_ply, "it does not begin with \"ply\"");
  return fail(PlyError::bad_header, "no end_header");
}

float float_at(const std::string& bytes, std::size_t place) {
  std::uint32_t bits = 0;
  for (std::size_t i = 0; i < 4; ++i)
    bits |= std::uint32_t{static_cast<unsigned char>(bytes[place + i])} << (8 * i);
  return std::bit_cast<float>(bits);
}

}  // namespace

const std::error_category& ply_error_category() {
  static const PlyErrorCategory category;
  return category;
}

Result<std::vector<Eigen::Vector3f>> read_ply(const std::filesystem::path& path) {
  const auto bytes = read_bytes(path, kMaxBytes);
  if (!bytes) return bytes.error();
  const auto layout = read_header(*bytes);
  if (!layout) return Error{layout.error().code, path.string() + " (" + layout.error().detail + ")"};
  const std::size_t complete = (bytes->size() - layout->data) / layout->stride;
  if (complete < layout->count)
    return fail(PlyError::truncated, path.string() + " (" + std::to_string(complete) + " of " +
                                         std::to_string(layout->count) + " points)");
  std::vector<Eigen::Vector3f> points(layout->count);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const std::size_t vertex = layout->data + i * layout->stride;
    for (std::size_t axis = 0; axis < 3; ++axis)
      points[i][static_cast<Eigen::Index>(axis)] = float_at(*bytes, vertex + *layout->coordinates[axis]);
  }
  return points;
}

}  // namespace calibrd
