// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>
#include <vector>

#include "api/service/reports.hpp"

namespace calibrd::api {

/// What the HTTP interface asks of the process itself. Safe to call from any thread.
class OperationsService {
 public:
  virtual ~OperationsService() = default;

  /// Every metric, in Prometheus's text format 0.0.4. Quick: see CellService.
  virtual std::string metrics() const = 0;

  /// Names of threads that must go on and have not for ten seconds; empty: all is well. Quick.
  virtual std::vector<std::string> stalled_threads() const = 0;

  /// What somebody needs who is to help from afar, without secrets: a tar archive, some hundred kilobytes.
  virtual CaptureArchive support_bundle() const = 0;
};

}  // namespace calibrd::api
