// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <initializer_list>
#include <string>
#include <string_view>

namespace calibrd::api {

/// 9 digits behind the point, whatever the locale: 1e-9 m, 1e-9 rad; of mm and deg more than any controller
/// keeps. Without exponent and without minus zero.
std::string decimals(double value);

/// The numbers with `separator` between them.
std::string decimal_list(std::initializer_list<double> values, std::string_view separator);

/// One word to a POSIX shell: as it is where nothing in it has a meaning there, else in single quotes.
std::string shell_word(std::string_view word);

/// For an attribute in double quotes.
std::string xml_attribute(std::string_view value);

}  // namespace calibrd::api
