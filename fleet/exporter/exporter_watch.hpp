// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "api/metrics/metric.hpp"

namespace calibrd::fleet {

/// What an exporter counts, for metrics. Safe to use from any thread.
struct ExporterWatch {
  api::Gauge exporters;  ///< 1 once there is one
  api::Gauge connected;  ///< 1 while connected to the broker
  api::Gauge contested;  ///< 1 while another daemon speaks under the cell's name
  api::Counter connects;
  api::Counter sent;          ///< calibrations, one sent again counts again
  api::Counter acknowledged;  ///< calibrations a collector has stored
  api::Counter refused;       ///< answers that a calibration cannot be stored
  api::Gauge waiting;         ///< calibrations in the outbox, as last counted

  static constexpr int kNotCounted = -1;  ///< of `waiting`
  ExporterWatch() { waiting.set(kNotCounted); }
};

}  // namespace calibrd::fleet
