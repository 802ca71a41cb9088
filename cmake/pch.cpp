// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
// A target must have a source; those of CalibrdPch.cmake are about their precompiled headers.
