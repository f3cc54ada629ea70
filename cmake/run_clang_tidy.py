# SPDX-License-Identifier: BSD-3-Clause
"""Runs clang-tidy over the files of compile_commands.json, two at a time; exits 1 on findings.

Generated files and the folders that are no code of ours are left out. A file whose content,
headers and checks have not changed since it passed is skipped (stamps in BUILD/tidy).
"""

import argparse
import concurrent.futures
import hashlib
import json
import os
import re
import subprocess
import sys
from pathlib import Path


def arguments() -> argparse.Namespace:
    """The options of the command line."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--clang-tidy", required=True)
    parser.add_argument("--build", type=Path, required=True)
    parser.add_argument("--source", type=Path, required=True)
    parser.add_argument("--only", default="")
    return parser.parse_args()


def one_by_one(commands: list[dict[str, str]]) -> list[dict[str, str]]:
    """The commands with every unity file replaced by the files that it includes."""
    expanded = []
    for command in commands:
        unity = Path(command["directory"], command["file"])
        if not re.fullmatch(r"unity_\d+_cxx\.cxx", unity.name):
            expanded.append(command)
            continue
        for file in re.findall(r'^#include "([^"]+)"', unity.read_text(), re.MULTILINE):
            expanded.append(
                {
                    **command,
                    "file": file,
                    "command": command["command"].replace(command["file"], file),
                }
            )
    return expanded


def own_headers(file: Path, source: Path, seen: set[Path]) -> set[Path]:
    """The project's headers that the file includes, directly or not."""
    for name in re.findall(r'^\s*#\s*include\s*"([^"]+)"', file.read_text(), re.MULTILINE):
        for header in (source / name, file.parent / name):
            if header.is_file() and header not in seen:
                seen.add(header)
                own_headers(header, source, seen)
    return seen


def fingerprint(file: Path, source: Path) -> str:
    """Hash of the file, its headers and the checks."""
    digest = hashlib.sha256((source / ".clang-tidy").read_bytes())
    for part in [file, *sorted(own_headers(file, source, set()))]:
        digest.update(part.read_bytes())
    return digest.hexdigest()


def main() -> int:
    """Exit status: 1 if there are findings."""
    a = arguments()
    a.source, a.build = a.source.resolve(), a.build.resolve()
    stamps = a.build / "tidy"
    stamps.mkdir(exist_ok=True)
    commands = one_by_one(json.loads((a.build / "compile_commands.json").read_text()))
    (stamps / "compile_commands.json").write_text(json.dumps(commands))
    files = sorted({Path(c["directory"], c["file"]).resolve() for c in commands})
    files = [
        f
        for f in files
        if f.is_relative_to(a.source)
        and not f.is_relative_to(a.build)
        and re.search(a.only, f.relative_to(a.source).as_posix())
    ]
    if not files:
        print("tidy: no file to look at")
        return 1

    def look(file: Path) -> tuple[Path, int, str]:
        """(file, exit status, findings) of one file."""
        stamp = stamps / file.relative_to(a.source).as_posix().replace("/", "__")
        key = fingerprint(file, a.source)
        if stamp.is_file() and stamp.read_text() == key:
            return file, 0, ""
        run = subprocess.run(
            [a.clang_tidy, "-p", str(stamps), "--quiet", str(file)],
            capture_output=True,
            text=True,
            check=False,
        )
        if run.returncode == 0:
            stamp.write_text(key)
        return file, run.returncode, run.stdout + run.stderr

    failed = 0
    with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
        for file, status, text in pool.map(look, files):
            if status:
                failed += 1
                print(text)
            print(
                f"tidy: {'FINDINGS' if status else 'clean'} {file.relative_to(a.source)}",
                flush=True,
            )
    print(f"tidy: {len(files)} files, {failed} with findings")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
