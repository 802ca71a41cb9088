// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <boost/beast/core/error.hpp>
#include <boost/beast/http/message.hpp>
#include <boost/beast/http/parser.hpp>
#include <boost/beast/http/string_body.hpp>
#include <optional>

#include "api/http/http_server.hpp"
#include "api/problem/api_error.hpp"

namespace calibrd::api {

using RequestParser = boost::beast::http::request_parser<boost::beast::http::string_body>;

/// No request larger than the settings allow is read into memory.
void set_limits(RequestParser& parser, const HttpServerSettings& settings);

/// The request as the routes see it, but for its body; nothing when its target cannot be decoded.
std::optional<Request> request_of(
    const boost::beast::http::request<boost::beast::http::string_body>& message);

/// The problem a client is told when its request could not be read; nothing when nobody is there to be told.
std::optional<ApiError> problem_of(boost::beast::error_code why);

}  // namespace calibrd::api
