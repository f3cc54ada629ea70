// SPDX-License-Identifier: BSD-3-Clause
#pragma once
/// Verbs that end in a Python program: reports and lessons.

#include <string>
#include <vector>

namespace firn::cli {

/// Runs `python -m WORDS…` with the interpreter that FIRN_PYTHON in the environment
/// names, else the one given to CMake, and returns its exit status. Throws
/// InputError if there is no such interpreter.
int run_python_module(std::vector<std::string> words);

}  // namespace firn::cli
