// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/innovations.hpp"

#include <array>

namespace calibrd::bench {
namespace {

// Cell, stamp, six of the innovation, the lower triangle of the covariance, the common share.
using Record = std::array<double, 2 + 6 + 21 + 1>;

}  // namespace

void InnovationWriter::write(std::uint32_t cell, double stamp_s, const DriftWatch::Innovation& innovation) {
  Record record{static_cast<double>(cell), stamp_s};
  std::size_t at = 2;
  for (int i = 0; i < 6; ++i) record[at++] = innovation.supported_shift[i];
  for (int row = 0; row < 6; ++row)
    for (int column = 0; column <= row; ++column) record[at++] = innovation.supported_covariance(row, column);
  record[at] = innovation.common_share;
  file_.write(reinterpret_cast<const char*>(record.data()), sizeof(record));
}

std::vector<RecordedInnovation> read_innovations(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  std::vector<RecordedInnovation> all;
  Record record{};
  while (file.read(reinterpret_cast<char*>(record.data()), sizeof(record))) {
    RecordedInnovation one;
    one.cell = static_cast<std::uint32_t>(record[0]);
    one.stamp_s = record[1];
    std::size_t at = 2;
    for (int i = 0; i < 6; ++i) one.innovation.supported_shift[i] = record[at++];
    for (int row = 0; row < 6; ++row)
      for (int column = 0; column <= row; ++column)
        one.innovation.supported_covariance(row, column) = one.innovation.supported_covariance(column, row) =
            record[at++];
    one.innovation.common_share = record[at];
    all.push_back(one);
  }
  return all;
}

}  // namespace calibrd::bench
