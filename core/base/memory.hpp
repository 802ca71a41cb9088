// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdlib>  // __GLIBC__
#if defined(__GLIBC__)
#include <malloc.h>
#endif

namespace calibrd {

/// Has freed memory kept for the next calibration rather than given back and fetched page by page again,
/// which takes a fifth of a calibration's time. For main(), before threads start; does nothing without glibc.
inline void keep_freed_memory() {
#if defined(__GLIBC__)
  constexpr int kKept = 64 << 20, kLargest = 32 << 20;
  mallopt(M_TRIM_THRESHOLD, kKept);
  mallopt(M_MMAP_THRESHOLD, kLargest);
#endif
}

}  // namespace calibrd
