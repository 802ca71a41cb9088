// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <boost/json/value.hpp>
#include <initializer_list>
#include <set>
#include <string>

#include "api/problem/api_error.hpp"
#include "api/routes/message.hpp"
#include "api/service/reports.hpp"

namespace calibrd::api {

/// An archive to be saved under its name, or the error.
Response archive_response(Result<CaptureArchive> archive);

Response json_response(int status, const boost::json::value& body);
/// `text`: the body as it is to be sent.
Response json_response(int status, std::string text);

/// RFC 9457 problem+json with `code` and `remedy`. Errors that are not ApiError become status 500, code
/// "internal", with their message as the detail.
Response problem(const Error& error);
Response problem(ApiError error, std::string detail = {});

/// Nothing when every query parameter of the request is one of `known`, else the error naming the nearest.
std::optional<Error> unknown_query(const Request& request, std::initializer_list<std::string> known);

}  // namespace calibrd::api
