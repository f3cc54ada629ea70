// SPDX-License-Identifier: BSD-3-Clause
#pragma once
/// A results file on disk. Every append leaves a complete file behind: it is
/// written to a copy, which then takes the old one's name, so that a kill at any
/// moment loses at most the case under way.

#include <string>
#include <vector>

#include "io/results/results.hpp"

namespace firn::results {

class ResultsFile {
 public:
  /// Opens `path`, or creates it. `machine` states processor, compiler, commit and
  /// so on; an existing file must agree in `comparable` facts (by name), else
  /// InputError: figures of two builds or two machines do not belong in one file. So is an
  /// existing file of another kind, unless `force`, which replaces it.
  ResultsFile(std::string path, const Facts& machine, const std::vector<std::string>& comparable,
              bool force = false);

  /// True if the file has this case with a status that need not be measured again
  /// (`measured` or `invalid`).
  bool has(const std::string& suite, const std::string& name) const;

  /// Adds the case, in place of an older one of that name.
  void append(const Case& result);

  /// Adds the rows of one verification under `subject` ("optimized, float"), in
  /// place of older ones.
  void append_verification(const std::string& subject, const std::string& command,
                           const std::vector<Check>& checks);

  /// The same for the mutants.
  void append_mutants(const std::string& command, const std::vector<Mutant>& mutants);

  const std::string& path() const { return path_; }

 private:
  /// `keep`: what the file holds; else it starts empty.
  template <class Write>
  void rewrite(bool keep, const Write& write);

  std::string path_;
  int session_ = 0;  ///< /sessions/N: this process
};

}  // namespace firn::results
