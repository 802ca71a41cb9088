// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
// The state stream of simple_message, in both byte orders and widths of reals, and the answers of the motion
// port. Input: variant, size of the pieces, then the bytes of the connection.
#include "drivers/robot/motion/motion_codec.hpp"
#include "drivers/robot/simple_message_codec.hpp"
#include "tests/fuzz/link_drive.hpp"

namespace {

using namespace calibrd;
namespace sm = simple_message;

constexpr std::size_t kJoints = 7;

sm::WireFormat format_of(std::uint8_t variant) {
  return {variant & 1U ? sm::ByteOrder::big : sm::ByteOrder::little, variant & 2U ? 8U : 4U};
}

std::unique_ptr<StateCodec> make_codec(std::uint8_t variant) {
  std::vector<JointRange> ranges;
  if (variant & 4U) ranges = {{-3, 3}, {-2, 2}};
  return std::make_unique<SimpleMessageCodec>(
      SimpleMessageSettings{format_of(variant), {100, 100}, variant & 8U ? 1 : 0, kJoints, ranges});
}

void read_answers(std::span<const std::byte> bytes, std::uint8_t variant) {
  MotionCodec codec(format_of(variant), 0);
  const auto answers = codec.decode(bytes);
  if (!answers) return fuzz::require(!answers.error().message().empty(), "an error says something");
  for (const auto& answer : *answers) fuzz::require(!in_words(answer).empty(), "an answer has words");
}

}  // namespace

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  calibrd::fuzz::Input input(data, size);
  const std::uint8_t variant = input.byte();
  calibrd::fuzz::drive_link(input, make_codec, variant, {kJoints, 100});
  input.byte();  // the size of the pieces
  read_answers(input.bytes(), variant);
  return 0;
}
