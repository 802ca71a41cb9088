// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <optional>
#include <string>
#include <string_view>

namespace calibrd {

/// How `device` of the settings chooses among the devices OpenNI2 lists.
class DeviceChoice {
 public:
  explicit DeviceChoice(std::string_view device);

  /// Whether a device of this URI is one to try. With a serial number every device is: it is read when
  /// opened.
  bool admits_uri(const std::string& uri) const;
  /// Whether an opened device that says this serial number is the one.
  bool admits_serial(const std::string& serial) const;
  /// A full URI, which may be opened though it is not listed (drivers of network sensors list nothing).
  std::optional<std::string> exact_uri() const;

 private:
  enum class By { any, uri, pattern, serial };
  By by_ = By::any;
  std::string wanted_;
};

}  // namespace calibrd
