// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <filesystem>
#include <string>
#include <vector>

namespace CLI {
class App;
}

namespace calibrd {

struct CalibrateOptions {
  std::filesystem::path capture_dir;
  std::vector<std::filesystem::path> models;
  std::string guess;                   ///< a JSON file or x,y,z,qx,qy,qz,qw; empty: none
  std::vector<std::string> workspace;  ///< "x,y,z" or "NAME=x,y,z", m, base frame
  std::string method = "full";
  std::string
      roi;  ///< x0,y0,z0,x1,y1,z1 in the sensor frame, m; empty: around the robot. Paper's method only
  std::string sampling;  ///< uniform, three-sensors; empty: uniform. Paper's method only
  bool depth_only = false;
  bool suggest = false;       ///< also say where to move the robot next
  double table_height_m = 0;  ///< base frame; what is suggested stays above it
  bool json = false;          ///< accepted for clarity's sake: the output is always JSON
};

void add_calibrate_options(CLI::App& command, CalibrateOptions& options);

/// Calibrates a recording without a daemon and prints one JSON object. Exit status: 0 accepted, 3 rejected or
/// uncertain (the JSON says why), 2 unusable input (message on stderr, nothing on stdout).
int run_calibrate(const CalibrateOptions& options);

}  // namespace calibrd
