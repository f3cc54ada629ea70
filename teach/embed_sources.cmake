# SPDX-License-Identifier: BSD-3-Clause
# Writes OUTPUT, a C++ file that holds the text of every file in SOURCES (paths from ROOT).
set(code "// Generated from reference/ by embed_sources.cmake.\n")
string(APPEND code "#include \"teach/sources.hpp\"\n\nnamespace firn::teach {\n\n")
string(APPEND code "const std::vector<SourceFile>& reference_sources() {\n")
string(APPEND code "  static const std::vector<SourceFile> files = {\n")
foreach(path IN LISTS SOURCES)
  file(READ "${ROOT}/${path}" text)
  string(APPEND code "      {\"${path}\", R\"firn_source(${text})firn_source\"},\n")
endforeach()
string(APPEND code "  };\n  return files;\n}\n\n}  // namespace firn::teach\n")
file(WRITE "${OUTPUT}" "${code}")
