// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string_view>

namespace calibrd::api {

// Files of this folder, put into the program when it is built (cmake/embed.cmake).
std::string_view embedded_openapi_json();
std::string_view embedded_docs_html();
std::string_view embedded_docs_js();
std::string_view embedded_docs_css();

}  // namespace calibrd::api
