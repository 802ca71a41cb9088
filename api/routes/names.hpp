// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>

#include "api/service/motion_reports.hpp"
#include "api/service/reports.hpp"

namespace calibrd::api {

/// The names the HTTP interface uses; stable.
const char* name_of(PoseState state);
const char* name_of(JobStatus status);
const char* name_of(MotionStatus status);
/// "2026-01-02T03:04:05.678Z"
std::string rfc3339(SystemTime time);

}  // namespace calibrd::api
