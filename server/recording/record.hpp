// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <filesystem>
#include <span>

#include "api/service/reports.hpp"
#include "core/base/result.hpp"
#include "core/capture/capture.hpp"

namespace calibrd {

/// A capture/1 folder with the robot's model in it, as a tar archive. capture.urdf: the URDF to pack.
/// `scratch`: where the folder lies meanwhile; made where it is missing. Error:
/// api::ApiError::capture_failed, the detail saying what went wrong.
Result<api::CaptureArchive> archive_capture(const Capture& capture,
                                            std::span<const std::filesystem::path> search_paths,
                                            const std::filesystem::path& scratch);

}  // namespace calibrd
