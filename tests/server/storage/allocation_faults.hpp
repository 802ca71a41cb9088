// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace calibrd {

/// Lets one allocation of this thread fail, of those made while a scope of this kind is open: of C++'s
/// operator new, and of SQLite once hook_sqlite() was called.
class AllocationsCount {
 public:
  AllocationsCount();
  ~AllocationsCount();

  /// The n-th from now on, counted from 1; 0: none.
  static void fail(int n);
  static bool has_failed();
  /// Before SQLite is used.
  static void hook_sqlite();
};

}  // namespace calibrd
