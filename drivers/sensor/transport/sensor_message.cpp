// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "drivers/sensor/transport/sensor_message.hpp"

#include <algorithm>
#include <utility>

namespace calibrd {
namespace {

enum class Kind : std::uint8_t { hello = 1, streaming = 2, failure = 3 };
constexpr std::size_t kMaxString = 3500;

class Writer {
 public:
  explicit Writer(Kind kind) { integer(static_cast<std::uint8_t>(kind), 1); }

  void integer(std::uint64_t value, std::size_t bytes) {
    for (std::size_t i = 0; i < bytes; ++i) bytes_.push_back(static_cast<std::byte>(value >> (8 * i) & 0xff));
  }
  void string(const std::string& text) {
    const std::size_t length = std::min(text.size(), kMaxString);
    integer(length, 2);
    for (std::size_t i = 0; i < length; ++i) bytes_.push_back(static_cast<std::byte>(text[i]));
  }
  std::vector<std::byte> take() { return std::move(bytes_); }

 private:
  std::vector<std::byte> bytes_;
};

/// Reads past the end give zeros and spoil the result, which is asked for once, at the end.
class Reader {
 public:
  explicit Reader(std::span<const std::byte> bytes) : rest_(bytes) {}

  template <class T>
  T integer() {
    const auto taken = take(sizeof(T));
    std::uint64_t value = 0;
    for (std::size_t i = 0; i < taken.size(); ++i)
      value |= std::to_integer<std::uint64_t>(taken[i]) << (8 * i);
    return static_cast<T>(value);
  }
  std::string string() {
    const auto taken = take(integer<std::uint16_t>());
    std::string text(taken.size(), '\0');
    std::transform(taken.begin(), taken.end(), text.begin(),
                   [](std::byte b) { return static_cast<char>(b); });
    return text;
  }
  bool is_complete() const { return good_ && rest_.empty(); }

 private:
  std::span<const std::byte> take(std::size_t count) {
    good_ = good_ && count <= rest_.size();
    if (!good_) return {};
    const auto taken = rest_.first(count);
    rest_ = rest_.subspan(count);
    return taken;
  }
  std::span<const std::byte> rest_;
  bool good_ = true;
};

std::vector<std::byte> encode_body(const SensorHello& hello) {
  Writer writer(Kind::hello);
  writer.integer(hello.version, 4);
  return writer.take();
}

std::vector<std::byte> encode_body(const SensorStreaming& streaming) {
  Writer writer(Kind::streaming);
  writer.string(streaming.device);
  writer.string(streaming.notice);
  writer.integer(streaming.width, 2);
  writer.integer(streaming.height, 2);
  writer.integer(streaming.fps, 2);
  writer.integer(streaming.depth_unit_um, 4);
  return writer.take();
}

std::vector<std::byte> encode_body(const SensorFailure& failure) {
  Writer writer(Kind::failure);
  writer.integer(static_cast<std::uint16_t>(failure.error), 2);
  writer.string(failure.detail);
  return writer.take();
}

std::optional<SensorMessage> decode_body(Kind kind, Reader& reader) {
  switch (kind) {
    case Kind::hello:
      return SensorHello{reader.integer<std::uint32_t>()};
    case Kind::streaming: {
      SensorStreaming streaming;
      streaming.device = reader.string();
      streaming.notice = reader.string();
      streaming.width = reader.integer<std::uint16_t>();
      streaming.height = reader.integer<std::uint16_t>();
      streaming.fps = reader.integer<std::uint16_t>();
      streaming.depth_unit_um = reader.integer<std::uint32_t>();
      return streaming;
    }
    case Kind::failure: {
      const auto number = reader.integer<std::uint16_t>();
      if (number == 0 || number > kLastSensorError) return std::nullopt;
      return SensorFailure{static_cast<SensorError>(number), reader.string()};
    }
  }
  return std::nullopt;
}

}  // namespace

std::vector<std::byte> encode(const SensorMessage& message) {
  return std::visit([](const auto& body) { return encode_body(body); }, message);
}

std::optional<SensorMessage> decode(std::span<const std::byte> bytes) {
  Reader reader(bytes);
  const auto kind = static_cast<Kind>(reader.integer<std::uint8_t>());
  auto message = decode_body(kind, reader);
  if (!reader.is_complete()) return std::nullopt;
  return message;
}

}  // namespace calibrd
