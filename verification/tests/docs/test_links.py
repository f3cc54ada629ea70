#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""The link check must be able to fail: every kind of link is broken once in a tree of its own."""

import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

SCRIPT = Path(__file__).with_name("check_links.py")

# line of docs/page.md, what is said of it (None: it is right)
CASES = [
    ("[a](other.md)", None),
    ("[a](../firn/state.hpp)", None),
    ("[a](missing.md)", "link to missing.md: no such file"),
    ("[a](other.md#a-heading-of-text)", None),
    ("[a](other.md#another)", "link to other.md#another: no such heading"),
    ("[a](#here)", None),
    ("[a](#nowhere)", "link to #nowhere: no such heading"),
    ("[a](https://example.org/missing)", None),
    ("`firn/state.hpp` and `firn/`", None),
    ("`firn/*.hpp`", None),
    ("`firn/gone.hpp`", "`firn/gone.hpp`: no such file"),
    ("`firn/*.cpp`", "`firn/*.cpp`: no such file"),
    ("`/firn/diagnostics`, `m/s`, `firn check` and `build/release`", None),
    ("```sh\ncat `firn/gone.hpp`\n```", None),
]


def tree(folder: Path, line: str) -> None:
    for path in ("docs/other.md", "firn/state.hpp", "build/x", "CHANGELOG.md"):
        (folder / path).parent.mkdir(parents=True, exist_ok=True)
        (folder / path).touch()
    (folder / "docs/other.md").write_text("# A heading, of `text`\n")
    (folder / "CHANGELOG.md").write_text("`firn/gone.hpp` is now `firn/state.hpp`\n")
    (folder / "docs/page.md").write_text(f"# Here\n{line}\n")


def check(folder: Path) -> tuple[int, list[str]]:
    done = subprocess.run(
        [sys.executable, str(SCRIPT), str(folder)], capture_output=True, text=True, check=False
    )
    return done.returncode, done.stdout.splitlines()


class Links(unittest.TestCase):
    def test_every_case(self) -> None:
        for line, fault in CASES:
            with self.subTest(line=line), tempfile.TemporaryDirectory() as folder:
                tree(Path(folder), line)
                expected = (1, [f"docs/page.md:2: {fault}"]) if fault else (0, [])
                assert check(Path(folder)) == expected

    def test_a_tree_without_documents_is_not_a_pass(self) -> None:
        with tempfile.TemporaryDirectory() as folder:
            assert check(Path(folder))[0] == 1


if __name__ == "__main__":
    unittest.main()
