// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <pthread.h>

#include <string>

namespace calibrd {

/// Names the calling thread for `top -H`, gdb and /proc/PID/task/*/comm; the kernel keeps 15 bytes.
inline void name_thread(const std::string& name) {
  pthread_setname_np(pthread_self(), name.substr(0, 15).c_str());
}

}  // namespace calibrd
