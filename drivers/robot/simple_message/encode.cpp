// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "drivers/robot/simple_message/encode.hpp"

#include "drivers/robot/simple_message/framer.hpp"

namespace calibrd::simple_message {
namespace {

class FieldWriter {
 public:
  explicit FieldWriter(ByteWriter& out) : out_(out) {}

  void operator()(const auto&... fields) { (write(fields), ...); }

 private:
  void write(std::int32_t value) { out_.write_int(value); }
  void write(double value) { out_.write_real(value); }
  void write(const JointValues& values) { out_.write_joints(values); }
  void write(const decltype(JointFeedbackEx::records)& records) {
    for (const JointFeedback& record : records) JointFeedback::fields(record, *this);
  }

  ByteWriter& out_;
};

struct BodyWriter {
  ByteWriter& out;

  template <class Known>
  void operator()(const Known& body) const {
    Known::fields(body, FieldWriter(out));
  }
  void operator()(const OtherMessage& other) const { out.write_bytes(other.body); }
};

struct TypeOf {
  template <class Known>
  std::int32_t operator()(const Known&) const {
    return Known::kType;
  }
  std::int32_t operator()(const OtherMessage& other) const { return other.type; }
};

}  // namespace

std::vector<std::byte> encode(const Message& message, const WireFormat& format) {
  ByteWriter body(format);
  std::visit(BodyWriter{body}, message.body);

  ByteWriter frame(format);
  frame.write_int(static_cast<std::int32_t>(kHeaderBytes - kLengthBytes + body.bytes().size()));
  frame.write_int(std::visit(TypeOf{}, message.body));
  frame.write_int(static_cast<std::int32_t>(message.comm_type));
  frame.write_int(static_cast<std::int32_t>(message.reply_code));
  frame.write_bytes(body.bytes());
  return frame.bytes();
}

}  // namespace calibrd::simple_message
