// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
// The document of the interface says what the code does.
#include <fstream>
#include <set>
#include <sstream>

#include "tests/api/routes/route_test.hpp"

namespace calibrd::api {
namespace {

namespace json = boost::json;

class OpenApi : public RouteTest {
 protected:
  OpenApi() : document_(json::parse(get("/openapi.json").body).as_object()) {}

  const json::object& paths() const { return document_.at("paths").as_object(); }

  const json::object document_;
};

std::string upper(std::string_view text) {
  std::string all(text);
  for (char& c : all) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  return all;
}

TEST_F(OpenApi, HoldsEveryRouteAndNoOther) {
  std::set<std::string> documented, routed;
  for (const auto& path : paths())
    for (const auto& operation : path.value().as_object())
      documented.insert(upper(operation.key()) + " " + std::string(path.key()));
  for (const auto& route : router().routes()) routed.insert(route.method + " " + path_of(route));
  EXPECT_EQ(documented, routed);
}

/// No requirement at all: open to all.
std::string documented_scope(const json::value& operation) {
  const auto& security = operation.at("security").as_array();
  return security.empty() ? "open" : std::string(security.at(0).at("bearer").at(0).as_string());
}

TEST_F(OpenApi, AsksForTheScopeThatTheRouteTakes) {
  for (const auto& route : router().routes()) {
    std::string method = route.method;
    for (char& c : method) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    EXPECT_EQ(documented_scope(paths().at(path_of(route)).at(method)), name_of(route.scope))
        << path_of(route);
  }
}

TEST_F(OpenApi, EveryOperationHasANameOfItsOwn) {
  std::set<std::string> names;
  for (const auto& path : paths())
    for (const auto& operation : path.value().as_object())
      EXPECT_TRUE(names.insert(std::string(operation.value().at("operationId").as_string())).second)
          << path.key();
}

TEST_F(OpenApi, KnowsEveryErrorCode) {
  std::set<std::string> documented, known;
  const auto& problem = document_.at("components").at("schemas").at("Problem").as_object();
  for (const auto& code : problem.at("properties").at("code").at("enum").as_array())
    documented.insert(std::string(code.as_string()));
  for (int error = 1; error <= static_cast<int>(ApiError::internal); ++error)
    known.insert(problem_entry(static_cast<ApiError>(error)).code);
  EXPECT_EQ(documented, known);
}

/// Codes are listed where their status is.
TEST_F(OpenApi, ListsCodesBelowTheirStatus) {
  std::map<std::string, int> statuses;
  for (int error = 1; error <= static_cast<int>(ApiError::internal); ++error) {
    const auto& entry = problem_entry(static_cast<ApiError>(error));
    statuses[entry.code] = entry.status;
  }
  for (const auto& [name, response] : document_.at("components").at("responses").as_object()) {
    const auto& schema = response.at("content").at("application/problem+json").at("schema").at("allOf").at(1);
    const auto& properties = schema.at("properties");
    for (const auto& code : properties.at("code").at("enum").as_array())
      EXPECT_EQ(statuses[std::string(code.as_string())], properties.at("status").at("const"))
          << name << " " << code;
    EXPECT_TRUE(name.starts_with(std::to_string(properties.at("status").at("const").to_number<int>())))
        << name;
  }
}

TEST_F(OpenApi, IsTheFileOfTheRepository) {
  std::stringstream file;
  file << std::ifstream(CALIBRD_SOURCE_DIR "/api/openapi/openapi.json").rdbuf();
  EXPECT_EQ(get("/openapi.json").body, file.str());
  EXPECT_EQ(header("Content-Type"), "application/json");
}

TEST_F(OpenApi, ThePageNeedsNoOtherHostAndNoInlineScript) {
  for (const auto* path : {"/docs", "/docs/docs.js", "/docs/docs.css"}) {
    const auto text = get(path).body;
    EXPECT_NE(header("Content-Security-Policy").find("default-src 'none'"), std::string::npos);
    for (const auto* word : {"http://", "https://", "innerHTML", "style=", "onclick", "@import"})
      EXPECT_EQ(text.find(word), std::string::npos) << path << " holds " << word;
  }
}

}  // namespace
}  // namespace calibrd::api
