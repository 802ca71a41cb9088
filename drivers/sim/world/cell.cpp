// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "drivers/sim/world/cell.hpp"

#include <cstring>

#include "drivers/sim/world/sim_error.hpp"

namespace calibrd::sim {
namespace {

/// Writes and reads with the same field lists: `field` overloads below are called for both.
struct ByteWriter {
  std::vector<std::byte> bytes;

  template <class T>
  void plain(const T& value) {
    static_assert(std::is_trivially_copyable_v<T>);
    const auto* from = reinterpret_cast<const std::byte*>(&value);
    bytes.insert(bytes.end(), from, from + sizeof(T));
  }
  std::size_t count(std::size_t n) {
    plain(static_cast<std::uint64_t>(n));
    return n;
  }
};

struct ByteReader {
  std::span<const std::byte> bytes;
  bool complete = true;

  template <class T>
  void plain(T& value) {
    static_assert(std::is_trivially_copyable_v<T>);
    if (bytes.size() < sizeof(T)) {
      complete = false;
      return;
    }
    std::memcpy(&value, bytes.data(), sizeof(T));
    bytes = bytes.subspan(sizeof(T));
  }
  std::size_t count(std::size_t) {
    std::uint64_t n = 0;
    plain(n);
    if (n > bytes.size()) complete = false;  // every element takes at least one byte
    return complete ? static_cast<std::size_t>(n) : 0;
  }
};

template <class Archive, class T>
  requires std::is_arithmetic_v<T> || std::is_enum_v<T>
void field(Archive& archive, T& value) {
  archive.plain(value);
}

template <class Archive, class T, int Rows, int Cols>
void field(Archive& archive, Eigen::Matrix<T, Rows, Cols>& matrix) {
  for (auto& value : matrix.reshaped()) archive.plain(value);
}

template <class Archive>
void field(Archive& archive, std::string& text) {
  text.resize(archive.count(text.size()));
  for (char& c : text) archive.plain(c);
}

template <class Archive>
void field(Archive& archive, std::array<std::uint32_t, 3>& indices) {
  archive.plain(indices);
}

template <class Archive, class T>
void field(Archive& archive, std::vector<T>& list);

template <class Archive, class... Fields>
void fields(Archive& archive, Fields&... all) {
  (field(archive, all), ...);
}

template <class Archive>
void field(Archive& archive, Mesh& m) {
  fields(archive, m.vertices, m.triangles, m.solid);
}
template <class Archive>
void field(Archive& archive, Surface& s) {
  fields(archive, s.albedo, s.texture, s.seed);
}
template <class Archive>
void field(Archive& archive, RobotLink& l) {
  fields(archive, l.name, l.parent_joint, l.mesh, l.surface);
}
template <class Archive>
void field(Archive& archive, RobotJoint& j) {
  fields(archive, j.name, j.movement, j.parent_link, j.child_link, j.T_parent_joint.matrix(), j.axis, j.position,
         j.multiplier, j.offset);
}
template <class Archive>
void field(Archive& archive, PositionRange& p) {
  fields(archive, p.name, p.lower, p.upper);
}
template <class Archive>
void field(Archive& archive, Object& o) {
  fields(archive, o.name, o.mesh, o.surface);
}
template <class Archive>
void field(Archive& archive, Cell& c) {
  fields(archive, c.robot.name, c.robot.base_link, c.robot.links, c.robot.joints, c.robot.positions, c.objects);
}

template <class Archive, class T>
void field(Archive& archive, std::vector<T>& list) {
  list.resize(archive.count(list.size()));
  for (T& element : list) field(archive, element);
}

}  // namespace

std::vector<std::byte> to_bytes(const Cell& cell) {
  ByteWriter writer;
  Cell copy = cell;  // the field lists serve both directions and so take no const
  field(writer, copy);
  return std::move(writer.bytes);
}

Result<Cell> cell_from_bytes(std::span<const std::byte> bytes) {
  ByteReader reader{bytes};
  Cell cell;
  field(reader, cell);
  if (!reader.complete || !reader.bytes.empty()) return sim_error(SimError::world_mismatch, "cell");
  return cell;
}

}  // namespace calibrd::sim
