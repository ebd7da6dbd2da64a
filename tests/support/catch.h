// SPDX-License-Identifier: BSD-3-Clause
// Catch2 2.13 and 3.x under one include.
#pragma once
#ifdef OTG_CATCH3
#include <catch2/catch_all.hpp>
using Catch::Approx;  // as 2.13 has it
#else
#include <catch2/catch.hpp>
#endif
