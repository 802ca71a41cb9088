// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace calibrd {

/// Raises this process's limit of open files so that `connections` leave enough for everything else, as far
/// as the system's hard limit allows. Returns how many connections the limit is enough for.
int make_room_for_connections(int connections);

/// As many as were asked for, or as many as the system allows, which the log then says.
int room_for_connections(int connections);

}  // namespace calibrd
