// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "drivers/sensor/child/device_choice.hpp"

#include <fnmatch.h>

namespace calibrd {
namespace {

constexpr std::string_view kSerialPrefix = "serial:";

}  // namespace

DeviceChoice::DeviceChoice(std::string_view device) : wanted_(device) {
  if (device.empty()) return;
  if (device.starts_with(kSerialPrefix)) {
    by_ = By::serial;
    wanted_ = device.substr(kSerialPrefix.size());
  } else {
    // '?' alone makes no pattern: it starts the query part of URIs such as freenect2://0?serial=…
    by_ = device.find('*') == std::string_view::npos ? By::uri : By::pattern;
  }
}

bool DeviceChoice::admits_uri(const std::string& uri) const {
  if (by_ == By::uri) return uri == wanted_;
  if (by_ == By::pattern) return ::fnmatch(wanted_.c_str(), uri.c_str(), 0) == 0;
  return true;
}

bool DeviceChoice::admits_serial(const std::string& serial) const {
  return by_ != By::serial || serial == wanted_;
}

std::optional<std::string> DeviceChoice::exact_uri() const {
  if (by_ != By::uri) return std::nullopt;
  return wanted_;
}

}  // namespace calibrd
