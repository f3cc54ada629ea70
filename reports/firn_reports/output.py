# SPDX-License-Identifier: BSD-3-Clause
"""No page takes the place of an input or of somebody else's file."""

from collections.abc import Iterable, Sequence
from pathlib import Path

from . import InputError

# What the templates write into the head of every page.
MARK = b'<meta name="generator" content="Firn">'


def same_file(path: Path, other: Path) -> bool:
    """True if both names lead to one file."""
    return path.exists() and other.exists() and path.samefile(other)


def is_ours(page: Path) -> bool:
    """True for a page that Firn made."""
    with page.open("rb") as file:
        return MARK in file.read(1000)


def require_free(
    folder: Path, names: Sequence[str], inputs: Iterable[str | Path], force: bool
) -> None:
    """Raises InputError if writing these files into the folder would destroy something.

    That is an input, or a file that Firn did not write; `force` allows the latter. Files beside
    a page of ours, like its tables, are ours, too. The first name is that of the page.
    """
    sources = [Path(path) for path in inputs]
    for path in (folder / name for name in names):
        for source in sources:
            if same_file(path, source):
                raise InputError(
                    f"{path}: output: got an input, {source}, allowed: a file that is not read"
                )
    first = folder / names[0]
    if force or (first.is_file() and is_ours(first)):
        return
    for path in (folder / name for name in names):
        if path.exists():
            raise InputError(
                f"{path}: output: got an existing file that is no page of Firn, "
                "allowed: another folder, or --force to replace it"
            )
