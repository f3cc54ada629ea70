# SPDX-License-Identifier: BSD-3-Clause
"""What a page is made of: a verdict, tiles of numbers, sections of figures, tables and logs."""

import base64
import csv
import io
import re
from collections.abc import Sequence
from dataclasses import dataclass, field
from importlib import resources
from pathlib import Path
from typing import Any

import jinja2

from . import output


@dataclass
class Figure:
    """A picture with its title, as SVG or PNG."""

    title: str
    svg: str = ""
    png: bytes = b""
    caption: str = ""
    command: str = ""  # what measures this again
    wide: bool = False

    @property
    def png_url(self) -> str:
        """The PNG as a data URL."""
        return "data:image/png;base64," + base64.b64encode(self.png).decode()


@dataclass
class Table:
    """A table, which a page also offers as CSV."""

    name: str  # file name of its CSV, without the ending
    title: str
    columns: list[str]  # units in brackets
    rows: list[list[Any]]  # a Mark shows as a coloured word, Code as a command
    caption: str = ""
    command: str = ""
    open: bool = False  # long tables are folded

    def csv(self) -> str:
        """The table as CSV, a header line first."""
        buffer = io.StringIO()
        writer = csv.writer(buffer, lineterminator="\n")
        writer.writerow(self.columns)
        writer.writerows(
            [["" if v is None else getattr(v, "text", v) for v in row] for row in self.rows]
        )
        return buffer.getvalue()

    @property
    def csv_url(self) -> str:
        """The CSV as a data URL."""
        return (
            "data:text/csv;charset=utf-8;base64," + base64.b64encode(self.csv().encode()).decode()
        )


@dataclass
class Mark:
    """A word with a meaning: good, bad or warn."""

    text: str
    kind: str

    def __str__(self) -> str:
        return self.text


@dataclass
class Code:
    """A command or path in a table cell."""

    text: str

    def __str__(self) -> str:
        return self.text


@dataclass
class Tile:
    """A number at the top of a page."""

    label: str
    value: str
    note: str = ""
    kind: str = ""
    target: str = ""  # id of the section that tells more
    command: str = ""  # what measures this again


@dataclass
class Section:
    """A part of a page; `id` is its anchor."""

    id: str
    title: str
    intro: str = ""
    figures: list[Figure] = field(default_factory=list)
    tables: list[Table] = field(default_factory=list)
    logs: list[tuple[str, str]] = field(default_factory=list)  # (title, text)
    command: str = ""

    def empty(self) -> bool:
        """True if the section has nothing to show."""
        return not (self.figures or self.tables or self.logs or self.intro)


@dataclass
class Page:
    """Everything that write() puts on a page."""

    title: str
    subtitle: str = ""
    verdict: Mark | None = None
    sentence: str = ""
    tiles: list[Tile] = field(default_factory=list)
    look_at: list[tuple[str, str]] = field(default_factory=list)  # (text, section id)
    hero: Figure | None = None
    sections: list[Section] = field(default_factory=list)
    command: str = ""


def number(value: Any, digits: int = 4) -> Any:
    """A number as a reader wants it: 12 345, 0.0123, 3.2e-14."""
    if value is None:
        return "–"
    if isinstance(value, (str, Mark, Code)):
        return value
    if isinstance(value, bool):
        return "yes" if value else "no"
    if isinstance(value, int):
        return f"{value:,}".replace(",", "\u202f")
    if value != value:
        return "not a number"
    if value == 0 or 1e-3 <= abs(value) < 1e5:
        return f"{value:.{digits}g}"
    text = f"{value:.{max(digits - 1, 1)}g}"
    return re.sub(r"e([+-])0*(\d)", lambda m: "e" + m[1].replace("+", "") + m[2], text)


def environment(package: str) -> jinja2.Environment:
    """Jinja2 for the templates of a package, with `number` and the kinds of values of a table."""
    result = jinja2.Environment(
        loader=jinja2.PackageLoader(package),
        autoescape=True,
        trim_blocks=True,
        lstrip_blocks=True,
        undefined=jinja2.StrictUndefined,
    )
    result.filters["number"] = number
    result.tests["mark"] = lambda value: isinstance(value, Mark)
    result.tests["code"] = lambda value: isinstance(value, Code)
    result.tests["numeric"] = lambda value: (
        isinstance(value, (int, float)) and not isinstance(value, bool)
    )
    return result


def style_sheet() -> str:
    """The CSS that every page has."""
    return resources.files("firn_reports").joinpath("templates/page.css").read_text("utf-8")


def write(
    page: Page,
    directory: str | Path,
    pictures: dict[str, bytes] | None = None,
    inputs: Sequence[str | Path] = (),
    force: bool = False,
) -> Path:
    """DIR/index.html, one file; pictures and the CSV of every table also stand beside it.

    Raises InputError if one of these is one of the inputs, or a file of others (see `force`).
    """
    directory, pictures = Path(directory), pictures or {}
    page.sections = [section for section in page.sections if not section.empty()]
    template = environment("firn_reports").get_template("page.html.jinja")
    html = template.render(page=page, css=style_sheet())
    tables = [table for section in page.sections for table in section.tables]
    names = ["index.html", *pictures, *(f"csv/{table.name}.csv" for table in tables)]
    output.require_free(directory, names, inputs, force)
    directory.mkdir(parents=True, exist_ok=True)
    (directory / "index.html").write_text(html, encoding="utf-8")
    for name, picture in pictures.items():
        (directory / name).write_bytes(picture)
    if tables:
        (directory / "csv").mkdir(exist_ok=True)
    for table in tables:
        (directory / "csv" / f"{table.name}.csv").write_text(table.csv(), encoding="utf-8")
    return directory / "index.html"
