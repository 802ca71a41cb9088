// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "tests/fuzz/response_check.hpp"

#include <boost/json/parse.hpp>
#include <boost/json/value.hpp>

#include "tests/fuzz/fuzz.hpp"

namespace calibrd::fuzz {

void check_response(const api::Response& response) {
  require(response.status >= 200 && response.status < 500, "no request makes the server fail");
  bool is_json = false;
  for (const auto& [name, value] : response.headers) {
    require((name + value).find_first_of("\r\n") == std::string::npos, "no header of two lines");
    is_json = is_json || (name == "Content-Type" && value.find("json") != std::string::npos);
  }
  if (!is_json) return;
  boost::system::error_code failure;
  const auto body = boost::json::parse(response.body, failure);
  require(!failure, "a JSON answer is JSON, in UTF-8");
  if (response.status >= 400)
    require(body.is_object() && body.get_object().contains("code") && body.get_object().contains("remedy"),
            "a problem has a code and a remedy");
}

}  // namespace calibrd::fuzz
