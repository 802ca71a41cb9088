// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string_view>

namespace calibrd {

/// How calibrd starts calibrd-sensor: file descriptors at fixed numbers, nothing else open but standard in,
/// out and error; the first argument names the parent, the rest are those of to_arguments().
inline constexpr int kMessageFd = 3;  ///< datagram socket, child to parent
inline constexpr int kRingFd = 4;     ///< memory of the frame ring
inline constexpr int kWakeFd = 5;     ///< eventfd, raised for each frame
inline constexpr int kFirstUnusedFd = 6;
inline constexpr std::string_view kParentArgument = "--parent=";

}  // namespace calibrd
