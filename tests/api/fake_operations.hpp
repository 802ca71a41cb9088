// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "api/service/operations_service.hpp"

namespace calibrd::api {

/// A process whose answers a test sets.
class FakeOperations : public OperationsService {
 public:
  std::string metrics_text = "# HELP a b\n";
  std::vector<std::string> stalled;

  std::string metrics() const override { return metrics_text; }
  std::vector<std::string> stalled_threads() const override { return stalled; }
  CaptureArchive support_bundle() const override { return {"calibrd-support.tar", "tar bytes"}; }
};

}  // namespace calibrd::api
