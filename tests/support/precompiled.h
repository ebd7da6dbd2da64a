// SPDX-License-Identifier: BSD-3-Clause
// Headers of other projects that most tests include. They are compiled once. A test includes what it uses all the same.
#pragma once

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstring>
#include <map>
#include <memory>
#include <random>
#include <set>
#include <string>
#include <thread>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <ode/ode.h>

#include "support/catch.h"
