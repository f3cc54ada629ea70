#pragma once
/// Verbs whose last part is Python: reports and lessons.

#include <string>
#include <vector>

namespace firn::cli {

/// Runs `python -m WORDS…` with the interpreter that FIRN_PYTHON in the environment
/// names, else the one that the build was told of, and returns its exit status. Throws
/// InputError if there is no such interpreter.
int run_python_module(std::vector<std::string> words);

}  // namespace firn::cli
