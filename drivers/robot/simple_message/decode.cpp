// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "drivers/robot/simple_message/decode.hpp"

#include <string>
#include <utility>

#include "drivers/robot/simple_message/error.hpp"
#include "drivers/robot/simple_message/framer.hpp"

namespace calibrd::simple_message {
namespace {

struct Header {
  std::int32_t length, type, comm_type, reply_code;
};

Status check(const Header& header, std::size_t frame_size) {
  if (static_cast<std::size_t>(header.length) != frame_size - kLengthBytes) {
    return Error{SimpleMessageError::length_out_of_range, "length " + std::to_string(header.length)};
  }
  const bool is_reply = header.comm_type == static_cast<std::int32_t>(CommType::service_reply);
  const bool known = header.type != 0 && header.comm_type >= 1 && header.comm_type <= 3 &&
                     header.reply_code >= 0 && header.reply_code <= 2;
  if (known && (header.reply_code != 0) == is_reply) return Done{};
  return Error{SimpleMessageError::invalid_header,
               "message type " + std::to_string(header.type) + ", communication type " +
                   std::to_string(header.comm_type) + ", reply code " + std::to_string(header.reply_code)};
}

/// An empty body of that type; OtherMessage where the type is not listed.
template <std::size_t Index = 1>
Body empty_body(std::int32_t type) {
  if constexpr (Index == std::variant_size_v<Body>) {
    return OtherMessage{type, {}};
  } else {
    using Known = std::variant_alternative_t<Index, Body>;
    return type == Known::kType ? Body(Known{}) : empty_body<Index + 1>(type);
  }
}

class FieldReader {
 public:
  explicit FieldReader(ByteReader& in) : in_(in) {}

  void operator()(auto&... fields) { (read(fields), ...); }

 private:
  void read(std::int32_t& value) { value = in_.read_int(); }
  void read(double& value) { value = in_.read_real(); }
  void read(JointValues& values) { values = in_.read_joints(); }
  void read(decltype(JointFeedbackEx::records)& records) {
    for (JointFeedback& record : records) {
      JointFeedback::fields(record, *this);
      record.valid_fields &= kValidMask;
    }
  }

  ByteReader& in_;
};

struct BodyReader {
  ByteReader& in;

  template <class Known>
  void operator()(Known& body) const {
    Known::fields(body, FieldReader(in));
    if constexpr (requires { body.valid_fields; }) body.valid_fields &= kValidMask;
  }
  void operator()(OtherMessage& other) const { other.body.assign(in.rest().begin(), in.rest().end()); }
};

/// Size of a body on the wire.
class BodySize {
 public:
  explicit BodySize(std::size_t real_bytes) : real_bytes_(real_bytes) {}

  std::size_t of(const Body& body) {
    std::visit([this](const auto& known) { add_body(known); }, body);
    return bytes_;
  }
  void operator()(const auto&... fields) { (add(fields), ...); }

 private:
  template <class Known>
  void add_body(const Known& body) {
    Known::fields(body, *this);
  }
  void add_body(const OtherMessage& other) { bytes_ += other.body.size(); }
  void add(std::int32_t) { bytes_ += 4; }
  void add(double) { bytes_ += real_bytes_; }
  void add(const JointValues& values) { bytes_ += real_bytes_ * values.size(); }
  void add(const decltype(JointFeedbackEx::records)& records) {
    for (const JointFeedback& record : records) JointFeedback::fields(record, *this);
  }

  std::size_t real_bytes_;
  std::size_t bytes_ = 0;
};

Status check_size(const Body& body, std::int32_t type, std::size_t size, std::size_t real_bytes) {
  const std::size_t expected = BodySize(real_bytes).of(body);
  if (size == expected || std::holds_alternative<OtherMessage>(body)) return Done{};
  const Error error{SimpleMessageError::wrong_body_size,
                    "message type " + std::to_string(type) + " with a body of " + std::to_string(size) +
                        " bytes, " + std::to_string(expected) + " expected"};
  // Worth its own diagnosis: the other width of reals explains the size, and one setting cures it.
  if (size == BodySize(real_bytes == 4 ? 8 : 4).of(body)) {
    return Error{
        real_bytes == 4 ? SimpleMessageError::peer_sends_float64 : SimpleMessageError::peer_sends_float32,
        error.detail};
  }
  return error;
}

Status check_group_count(const Body& body) {
  const auto* feedback = std::get_if<JointFeedbackEx>(&body);
  if (!feedback ||
      (feedback->group_count >= 0 && std::cmp_less_equal(feedback->group_count, feedback->records.size()))) {
    return Done{};
  }
  return Error{SimpleMessageError::group_count_out_of_range,
               "group count " + std::to_string(feedback->group_count)};
}

}  // namespace

Result<Message> decode(std::span<const std::byte> frame, const WireFormat& format,
                       const ValueLimits& limits) {
  if (frame.size() < kHeaderBytes || frame.size() > kLengthBytes + kMaxLength) {
    return Error{SimpleMessageError::length_out_of_range,
                 "frame of " + std::to_string(frame.size()) + " bytes"};
  }
  ByteReader reader(frame, format);
  const Header header{reader.read_int(), reader.read_int(), reader.read_int(), reader.read_int()};
  if (const Status checked = check(header, frame.size()); !checked) return checked.error();

  Body body = empty_body(header.type);
  const Status size = check_size(body, header.type, reader.rest().size(), format.real_bytes);
  if (!size) return size.error();
  std::visit(BodyReader{reader}, body);

  if (const Status count = check_group_count(body); !count) return count.error();
  if (const Status values = check_values(body, limits); !values) return values.error();
  return Message{CommType{header.comm_type}, ReplyCode{header.reply_code}, std::move(body)};
}

}  // namespace calibrd::simple_message
