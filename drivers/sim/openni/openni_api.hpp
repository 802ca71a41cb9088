// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
// OpenNI2's driver header uses these two macros and leaves it to the driver to define them.
#define XN_NEW(type, argument) new type(argument)
#define XN_DELETE(pointer) delete (pointer)
#include <Driver/OniDriverAPI.h>
