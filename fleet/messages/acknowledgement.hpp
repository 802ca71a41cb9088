// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace calibrd::fleet {

/// What a collector says of calibrations of one cell.
struct Acknowledgement {
  struct Refused {
    std::string calibration_id;
    std::string reason;
  };
  std::vector<std::string> stored;  ///< ids; they are on the database's disk
  std::vector<Refused> refused;     ///< cannot be stored as they are, however often they are sent
};

std::string acknowledgement_json(const Acknowledgement& acknowledgement);

/// Nothing where it is none.
std::optional<Acknowledgement> parse_acknowledgement(std::string_view text);

}  // namespace calibrd::fleet
