// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "drivers/sim/render/noise_field.hpp"
#include "drivers/sim/render/sample_grid.hpp"

namespace calibrd::sim {

/// What a simulated sensor works out once for its camera: costly to make, never changed, shared by all
/// scenes.
struct SensorTables {
  explicit SensorTables(const CameraParameters& camera) : grid(camera) {}
  SampleGrid grid;
  NoiseField white{false}, correlated{true};
};

}  // namespace calibrd::sim
