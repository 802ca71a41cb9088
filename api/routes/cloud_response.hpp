// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>
#include <utility>
#include <vector>

#include "api/clouds/cloud_file.hpp"
#include "api/routes/message.hpp"
#include "core/base/result.hpp"

namespace calibrd::api {

/// ?format= of a request for a cloud; without one PLY. Error: ApiError::bad_query.
Result<CloudFormat> read_cloud_format(const Request& request);

/// A cloud with its size and layout as headers. `provenance`: what it was made from, name and value: headers
/// too, and comments of a file that may have some.
Response cloud_response(CloudFormat format, const CloudData& data,
                        std::vector<std::pair<std::string, std::string>> provenance);

}  // namespace calibrd::api
