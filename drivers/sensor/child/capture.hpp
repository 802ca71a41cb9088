// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <memory>
#include <string>
#include <vector>

#include "drivers/sensor/child/frame_pairing.hpp"
#include "drivers/sensor/child/hold_up.hpp"
#include "drivers/sensor/child/openni_device.hpp"
#include "drivers/sensor/child/openni_stream.hpp"
#include "drivers/sensor/child/parent_link.hpp"
#include "drivers/sensor/transport/frame_ring.hpp"

namespace calibrd {

/// The streams of one device, from the driver into the ring.
class Capture {
 public:
  explicit Capture(const StreamRequest& request) : request_(request) {}

  /// Opens the device and starts its streams. The library must outlive this.
  Status open(const OpenNi& library);

  /// Delivers frames until a stop is requested (Done) or the device fails or its recording ends (why).
  Status run(FrameRingWriter& ring, ParentLink& parent);

 private:
  Status open_depth();
  void open_image();
  bool register_depth(bool to_color);
  Result<std::unique_ptr<OpenNiStream>> image_stream(bool is_color);
  Status start();
  SensorStreaming description() const;

  struct Arrival {
    openni::VideoFrameRef frame;
    std::uint64_t sequence;
    std::chrono::steady_clock::time_point stamp;
  };
  using Pairing = FramePairing<Arrival, openni::VideoFrameRef>;

  /// Waits for a stream to have a frame, at most until something else is due. False: nothing came.
  Result<bool> receive(Pairing& pairing);
  void accept(bool is_image, Pairing& pairing);
  Status deliver(Pairing::Pair& pair, FrameRingWriter& ring, ParentLink& parent);
  void note_pairing(bool is_paired, ParentLink& parent);
  Status check_device(bool is_idle) const;

  StreamRequest request_;
  std::unique_ptr<OpenNiDevice> device_;
  std::unique_ptr<OpenNiStream> depth_, image_;
  std::string notice_;
  FrameNumbering numbering_;
  HoldUp hold_up_;
  std::vector<std::uint16_t> depth_pixels_, image_pixels_;
  int last_index_ = 0;
  int bad_in_a_row_ = 0;
  int alone_in_a_row_ = 0;
};

}  // namespace calibrd
