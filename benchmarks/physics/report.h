// SPDX-License-Identifier: BSD-3-Clause
// The results of the suite for people and for programs.
#pragma once

#include <string>

#include "physics/suite.h"

namespace otg::physics {

/// One line for a run: result, scene, form, conditions, and every measure with a limit.
std::string lineOf(const Row& row);
/// The lines of all runs, then a table in Markdown: by scene how many passed, and the worst figure for each limit.
std::string tableOf(const SuiteResult& suite);
/// One JSON document.
std::string jsonOf(const SuiteResult& suite, const SuiteOptions& options);
/// Energy over time of the plain runs, one panel for each scene, as SVG or PNG by the name of the file, with gnuplot.
/// Returns what is wrong, or nothing: without gnuplot its input stays beside the file.
std::string plotEnergies(const SuiteResult& suite, const std::string& file);

}  // namespace otg::physics
