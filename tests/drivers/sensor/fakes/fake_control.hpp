// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <string>

namespace calibrd::fake {

inline constexpr const char* kControlVariable = "FAKE_SENSOR_CONTROL";

/// How the fake driver behaves. The test writes it to the file named by FAKE_SENSOR_CONTROL, the driver reads
/// it when it is loaded and again before every frame.
struct Control {
  int devices = 1;          ///< plugged in
  std::string hang = "no";  ///< "create", "open", "close" or "wait": that call into the driver never returns
  int silent = 0;           ///< 1: open, but no frames
  int crash_after = 0;      ///< aborts after this many frames; 0: never
  int repeat = 1;           ///< how often each frame is delivered
  int skip = 0;             ///< frames left out after each delivered one (the index counts on)
  int frame_width = 0;      ///< of the frames, whatever mode was set; 0: as set
  int row_padding = 0;      ///< bytes after each row
  int mirrored = 0;         ///< 1: images are mirrored, the driver says so and cannot be told otherwise
  int infrared = 1;         ///< 1: has an infrared camera
  int color = 0;            ///< 1: has a colour camera
  int registers = 0;        ///< 1: can register depth to colour
  int image_shift_us = 0;   ///< timestamp of images minus that of depth
  int unit_100_um = 0;      ///< 1: offers the 100 µm format only
  int numbered = 1;         ///< 0: index and timestamp stay zero
};

/// Calls visit(name, field) for every field: what is written and what is read cannot differ.
template <class C, class Visitor>
void for_each_field(C& c, Visitor visit) {
  visit("devices", c.devices);
  visit("hang", c.hang);
  visit("silent", c.silent);
  visit("crash_after", c.crash_after);
  visit("repeat", c.repeat);
  visit("skip", c.skip);
  visit("frame_width", c.frame_width);
  visit("row_padding", c.row_padding);
  visit("mirrored", c.mirrored);
  visit("infrared", c.infrared);
  visit("color", c.color);
  visit("registers", c.registers);
  visit("image_shift_us", c.image_shift_us);
  visit("unit_100_um", c.unit_100_um);
  visit("numbered", c.numbered);
}

/// Replaces the file in one step: the driver never reads half of it.
inline void write_control(const std::string& path, const Control& control) {
  {
    std::ofstream file(path + ".new");
    for_each_field(control, [&](const char*, const auto& value) { file << value << '\n'; });
  }
  std::rename((path + ".new").c_str(), path.c_str());
}

inline Control read_control() {
  Control control;
  const char* path = std::getenv(kControlVariable);
  if (path == nullptr) return control;
  std::ifstream file(path);
  for_each_field(control, [&](const char*, auto& value) {
    auto read = value;
    if (file >> read) value = read;
  });
  return control;
}

}  // namespace calibrd::fake
