// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string_view>

namespace calibrd {

/// Whether the nodes of a Collada file come to an end when every <instance_node> is followed: not more than
/// 128 deep, not more than 10 000 of them. Assimp (5.2) follows a node that instances itself until its stack
/// is full, and two nodes that instance each other twice until the memory is.
bool nodes_come_to_an_end(std::string_view collada);

}  // namespace calibrd
