// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "api/metrics/metrics_text.hpp"
#include "api/service/cell_service.hpp"

namespace calibrd::api {

/// Writes what the cell tells of itself now: the reports every other client gets, so that metrics and answers
/// cannot contradict each other. Quick.
void write_cell_metrics(const CellService& service, MetricsText& text);

}  // namespace calibrd::api
