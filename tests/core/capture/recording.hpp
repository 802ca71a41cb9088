// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>
#include <vector>

#include "core/capture/capture.hpp"
#include "core/capture/capture_error.hpp"
#include "core/capture/png.hpp"
#include "tests/core/robot/scratch_folder.hpp"

namespace calibrd::test {

/// The smallest recording a person could write by hand: 8x8 pixels, two joints.
inline std::string good_document() {
  return R"({"format": "capture/1", "note": "by hand",
  "robot": {"urdf": "robot.urdf", "base_link": "base", "joint_names": ["a", "b"]},
  "sensor": {"id": "s", "width": 8, "height": 8, "fx": 10, "fy": 11.5, "cx": 3.5, "cy": 4, "depth_scale_m": 0.001},
  "frames": [{"depth": "depth.png", "image": "image.png", "joint_positions_rad": [0.5, -1], "stamp_s": 2.5}]})";
}

inline std::vector<std::uint16_t> counting(std::size_t count, unsigned first, unsigned step) {
  std::vector<std::uint16_t> values(count);
  for (std::size_t i = 0; i < count; ++i) values[i] = static_cast<std::uint16_t>(first + step * i);
  return values;
}

/// A folder that holds a good recording, to be spoilt.
class Recording {
 public:
  Recording() {
    folder_.write("capture.json", good_document());
    folder_.write("robot.urdf", "<robot name='r'><link name='base'/></robot>");
    put_image("depth.png", 1000);
    put_image("image.png", 20);
  }

  const ScratchFolder& folder() const { return folder_; }
  std::filesystem::path path(const std::string& name = "") const {
    return name.empty() ? folder_.path() : folder_.path() / name;
  }

  void put_image(const std::string& name, unsigned first, int width = 8, int height = 8) const {
    const auto pixels =
        counting(static_cast<std::size_t>(width) * static_cast<std::size_t>(height), first, 3);
    if (!write_png16(path(name), width, height, pixels)) throw std::runtime_error("cannot write " + name);
  }

  /// Replaces text of capture.json; it must be there.
  void change(const std::string& from, const std::string& to) {
    const auto place = document_.find(from);
    if (place == std::string::npos) throw std::runtime_error("not in the document: " + from);
    document_.replace(place, from.size(), to);
    folder_.write("capture.json", document_);
  }

  Result<Capture> read(const std::vector<std::filesystem::path>& models = {}) const {
    return read_capture(path(), models);
  }

 private:
  ScratchFolder folder_;
  std::string document_ = good_document();
};

}  // namespace calibrd::test
