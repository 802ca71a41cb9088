// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "drivers/sim/controller/motion_messages.hpp"

#include <bit>
#include <stdexcept>

namespace calibrd::sim {
namespace {

constexpr std::size_t kHead = 16, kControlBody = 52, kPointBody = 136;

class Reader {
 public:
  Reader(ByteOrder order, std::span<const std::uint8_t> bytes) : order_(order), bytes_(bytes) {}

  std::int32_t integer() { return static_cast<std::int32_t>(word()); }
  double real() { return static_cast<double>(std::bit_cast<float>(word())); }
  TenJoints reals() {
    TenJoints values{};
    for (double& value : values) value = real();
    return values;
  }

 private:
  std::uint32_t word() {
    std::uint32_t value = 0;
    for (std::size_t i = 0; i < 4; ++i) value = value << 8 | bytes_[order_ == ByteOrder::big ? i : 3 - i];
    bytes_ = bytes_.subspan(4);
    return value;
  }

  ByteOrder order_;
  std::span<const std::uint8_t> bytes_;
};

}  // namespace

std::optional<Bytes> cut_message(ByteOrder order, Bytes& bytes) {
  if (bytes.size() < 4) return std::nullopt;
  const std::int32_t length = Reader(order, bytes).integer();
  if (length < 12 || length > 1024) throw std::runtime_error("no message has this length");
  const std::size_t size = 4 + static_cast<std::size_t>(length);
  if (bytes.size() < size) return std::nullopt;
  const auto end = bytes.begin() + static_cast<std::ptrdiff_t>(size);
  Bytes message(bytes.begin(), end);
  bytes.erase(bytes.begin(), end);
  return message;
}

std::optional<MotionRequest> read_motion_request(ByteOrder order, std::span<const std::uint8_t> message) {
  if (message.size() < kHead) return std::nullopt;
  Reader reader(order, message.subspan(4));
  MotionRequest request;
  request.type = reader.integer();
  reader.integer();  // communication type and reply code: MotoROS does not look at them
  reader.integer();
  if (request.type == MotionRequest::kControl && message.size() == kHead + kControlBody) {
    request.group = reader.integer();
    request.sequence = reader.integer();
    request.command = reader.integer();
    return request;
  }
  if (request.type != MotionRequest::kPoint || message.size() != kHead + kPointBody) return std::nullopt;
  request.group = reader.integer();
  request.sequence = reader.integer();
  request.valid_fields = reader.integer();
  request.time_s = reader.real();
  request.positions = reader.reals();
  request.velocities = reader.reals();
  return request;
}

}  // namespace calibrd::sim
