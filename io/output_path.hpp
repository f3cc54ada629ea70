// SPDX-License-Identifier: BSD-3-Clause
#pragma once
/// No output takes the place of something that the user may still need: neither of an input of
/// the same run nor of a file that is not ours.

#include <filesystem>
#include <string>
#include <vector>

namespace firn {

/// Throws InputError if `output`, or a file that is written on the way to it, is one of `inputs`.
/// Files are told apart by device and inode, so that links and other spellings do not hide one.
void require_no_input(const std::filesystem::path& output, const std::vector<std::string>& inputs);

/// What a verb writes. An existing file of the same kind may be replaced.
enum class OutputKind { trajectory, results, junit, lesson, error_map };

/// Is the file at `path` of that kind and written by us? Anything unreadable is not.
bool is_ours(const std::filesystem::path& path, OutputKind kind);

/// Throws InputError if there is a plain file at `output` that is not ours, unless `force`.
void require_replaceable(const std::filesystem::path& output, OutputKind kind, bool force);

}  // namespace firn
