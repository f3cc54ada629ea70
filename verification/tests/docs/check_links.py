#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Finds links and paths in the documentation that lead nowhere.

Checked in every *.md file of the project:
    [text](path#anchor)   the file exists and, if it is Markdown, has that heading
    `folder/file`         a path that begins with a folder of the project exists; * is a wildcard

Usage: check_links.py ROOT; prints one line per broken link and exits 1 if there is any.
"""

import re
import sys
from collections.abc import Iterator
from pathlib import Path

# Folders at the root that builds and runs make.
GENERATED = {"build", "out", "results"}
# A changelog names files that have moved.
PATHS_OF_THE_PAST = {"CHANGELOG.md"}

FENCE = re.compile(r"^(```|~~~).*?^\1[^\n]*$", re.MULTILINE | re.DOTALL)
LINK = re.compile(r"\]\(([^)\s]+)\)")
CODE = re.compile(r"`([^`\n]+)`")
PATH = re.compile(r"[\w.+-]+(/[\w.*+-]+)*/?")
HEADING = re.compile(r"^#+ (.*)$", re.MULTILINE)


def documents(root: Path) -> list[Path]:
    """Return every Markdown file that belongs to the project."""
    found = []
    for file in sorted(root.rglob("*.md")):
        first = file.relative_to(root).parts[0]
        if first not in GENERATED and not first.startswith((".", "build")):
            found.append(file)
    return found


def without_fences(text: str) -> str:
    """Fenced code becomes empty lines, so that line numbers stay right."""
    return FENCE.sub(lambda match: "\n" * match[0].count("\n"), text)


def anchor_of(heading: str) -> str:
    """GitHub's rule: lower case, punctuation dropped, blanks become hyphens."""
    text = re.sub(r"[^\w\s-]", "", heading.replace("`", "").strip().lower())
    return re.sub(r"\s", "-", text)


def anchors(file: Path) -> set[str]:
    """Return the anchors of all headings."""
    return {anchor_of(heading) for heading in HEADING.findall(without_fences(file.read_text()))}


def broken_link(file: Path, link: str) -> str | None:
    """Say what is wrong with a link of `file`, if anything."""
    if re.match(r"[a-z]+:", link):
        return None
    path, _, anchor = link.partition("#")
    target = file.parent / path if path else file
    if not target.exists():
        return f"link to {link}: no such file"
    if anchor and target.suffix == ".md" and anchor not in anchors(target):
        return f"link to {link}: no such heading"
    return None


def broken_path(root: Path, code: str) -> str | None:
    """Say what is wrong with `code` if it is meant as a path."""
    first = code.split("/")[0]
    if "/" not in code or not PATH.fullmatch(code) or not (root / first).is_dir():
        return None
    if first in GENERATED | {".", ".."} or any(root.glob(code.rstrip("/"))):
        return None
    return f"`{code}`: no such file"


def broken(root: Path) -> Iterator[str]:
    """Yield a line for each link or path that leads nowhere."""
    root = root.resolve()
    files = documents(root)
    if not files:
        yield f"{root}: no document found, nothing was checked"
    for file in files:
        for number, line in enumerate(without_fences(file.read_text()).split("\n"), start=1):
            faults = [broken_link(file, link) for link in LINK.findall(line)]
            if file.name not in PATHS_OF_THE_PAST:
                faults += [broken_path(root, code) for code in CODE.findall(line)]
            for fault in filter(None, faults):
                yield f"{file.relative_to(root)}:{number}: {fault}"


def main() -> int:
    """Print what is broken; 1 if anything is."""
    found = list(broken(Path(sys.argv[1])))
    for line in found:
        print(line)
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
