# SPDX-License-Identifier: BSD-3-Clause
find_package(Threads REQUIRED)
otg_add_test(base unit SOURCES test_base.cpp LIBRARIES Threads::Threads)
otg_add_test(environment unit SOURCES test_environment.cpp)
