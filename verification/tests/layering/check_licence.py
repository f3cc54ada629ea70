#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Finds source files without a licence line.

Usage: check_licence.py ROOT; prints one line per file and exits 1 if there is any.
"""

import subprocess
import sys
from pathlib import Path

LINE = "SPDX-License-Identifier: BSD-3-Clause"
SUFFIXES = {".c", ".cmake", ".cpp", ".css", ".h", ".hpp", ".js", ".py", ".sh"}


def sources(root: Path) -> list[Path]:
    """Return the source files that git tracks below `root`, or all of them without git."""
    listed = subprocess.run(
        ["git", "-C", str(root), "ls-files", "-z"], capture_output=True, text=True, check=False
    )
    names = listed.stdout.split("\0") if listed.returncode == 0 else []
    files = [root / name for name in names if name] or list(root.rglob("*"))
    return [f for f in files if f.is_file() and f.suffix in SUFFIXES]


def main() -> int:
    """Print the files that lack the line; 1 if any does or none was read."""
    files = sources(Path(sys.argv[1]))
    bare = [f for f in files if LINE not in "".join(f.read_text().splitlines(keepends=True)[:2])]
    for file in bare:
        print(f"{file}: no line {LINE}")
    if not files:
        print("no source file found, nothing was checked")
    return 1 if bare or not files else 0


if __name__ == "__main__":
    sys.exit(main())
