# SPDX-License-Identifier: BSD-3-Clause
"""The text of each page: one file of chapters/."""

import itertools
from dataclasses import dataclass, field
from importlib import resources

from firn_reports import page as reports

from . import STAGES, mathml, source

STAGE_FILES = [f"{n:02d}_{name}.html" for n, name in enumerate(STAGES, 1)]
EXTRAS = ["svd", "semi_implicit", "optimized", "exercises", "interactive"]


@dataclass
class Chapter:
    """One file of chapters/: title, lead, then the text, then what the optimized solver does."""

    name: str  # of the page
    title: str = ""
    lead: str = ""
    short: str = ""  # title for navigation
    text: str = ""
    optimized: str = ""
    stage: int = 0
    previous: tuple[str, str] | None = None  # (page, title)
    next: tuple[str, str] | None = None


@dataclass
class Section(reports.Section):
    """A section of a report that may also show source files."""

    sources: list[source.File] = field(default_factory=list)


def chapter(file: str, page: str) -> Chapter:
    """The text of a chapter for a page.

    Raises KeyError if its head names no title or lead.
    """
    head, *parts = (
        resources.files("firn_teach")
        .joinpath("chapters", file)
        .read_text(encoding="utf-8")
        .split("---\n")
    )
    facts = dict(line.split(": ", 1) for line in head.strip().splitlines())
    texts = [mathml.render(part) for part in parts] + ["", ""]
    return Chapter(
        page, facts["title"], facts["lead"], facts.get("short", facts["title"]), texts[0], texts[1]
    )


def chapters() -> list[Chapter]:
    """All pages but the index, in reading order, each with its neighbours."""
    pages = []
    for n, name in enumerate(STAGE_FILES, 1):
        pages.append(chapter(f"{n:02d}.html", name))
        pages[-1].stage = n
    pages += [chapter(f"{name}.html", f"{name}.html") for name in EXTRAS]
    for a, b in itertools.pairwise(pages):
        a.next, b.previous = (b.name, b.short), (a.name, a.short)
    pages[0].previous = ("index.html", "Overview")
    return pages
