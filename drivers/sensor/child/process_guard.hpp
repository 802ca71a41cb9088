// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <sys/types.h>

namespace calibrd {

/// Ties this process to its parent: SIGTERM arrives when the parent dies. False when it is dead already.
/// `parent` is the process id the parent gave; a process whose parent died early has another one by now.
bool end_with_parent(pid_t parent);

/// From now on SIGTERM asks for a stop; who has not ended a second later (a driver that hangs) is ended by
/// SIGALRM.
void install_stop_signal();
bool is_stop_requested();

/// Lets the system end this process if it is still there in a second: set before calling into a driver for
/// the last time.
void limit_time_to_end();

}  // namespace calibrd
