// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "api/metrics/metrics_text.hpp"

namespace calibrd {

/// Writes what the kernel says of this process (/proc/self), by the names Prometheus gives such figures. What
/// cannot be read is left out.
void write_process_metrics(api::MetricsText& text);

}  // namespace calibrd
