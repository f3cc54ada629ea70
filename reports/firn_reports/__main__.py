# SPDX-License-Identifier: BSD-3-Clause
"""python -m firn_reports FILE [--check CHECK.json]… [--baseline OLD.h5] [-o DIR]"""

import argparse
import math
import shlex
import sys
from pathlib import Path
from typing import NoReturn

import h5py

from . import (
    InputError,
    baseline,
    check,
    error_map,
    page,
    readme_table,
    results,
    results_page,
    trajectory,
    trajectory_page,
)
from .trajectory import text_attribute


def file_format(path: str | Path) -> str:
    """The `format` attribute: of /firn in a trajectory, of the root in results."""
    try:
        with h5py.File(path) as file:
            for node in (file, file.get("firn")):
                if node is not None and "format" in node.attrs:
                    return text_attribute(node, "format")
    except OSError as error:
        reason = (
            "no such file"
            if not Path(path).exists()
            else f"not an HDF5 file: {error}".splitlines()[0]
        )
        raise InputError(f"{path}: {reason}") from None
    raise InputError(f"{path}: no attribute `format`: allowed: firn-trajectory, firn-results")


def share(value: str) -> float:
    """A finite number above 0."""
    number = float(value)
    if not (number > 0 and math.isfinite(number)):
        raise argparse.ArgumentTypeError(f"got {value}, allowed: finite, above 0")
    return number


class Parser(argparse.ArgumentParser):
    """Complains in one line."""

    def error(self, message: str) -> NoReturn:
        """Raises InputError."""
        raise InputError(message)


def parse(arguments: list[str]) -> argparse.Namespace:
    """The options of `firn report`. Raises InputError if they are wrong."""
    parser = Parser(
        "firn report", description="One self-contained HTML page from a trajectory or from results."
    )
    parser.add_argument("file", metavar="FILE", help="a trajectory (.vtkhdf) or results (.h5)")
    parser.add_argument(
        "--check",
        action="append",
        default=[],
        metavar="JSON",
        help="output of `firn check --json`; may be repeated",
    )
    parser.add_argument(
        "--errors",
        metavar="ERRORS.vtkhdf",
        help="what `firn check --dump` wrote: histograms and a map of the errors",
    )
    parser.add_argument(
        "--baseline",
        metavar="OLD",
        help="results of an earlier run; exit 1 if a case became worse by more than --threshold",
    )
    parser.add_argument(
        "--threshold",
        type=share,
        default=baseline.THRESHOLD,
        metavar="SHARE",
        help="with --baseline: a case may be worse by up to this fraction (default: %(default)s)",
    )
    parser.add_argument(
        "--readme-table",
        action="store_true",
        help="print a summary of the results as Markdown instead of making a page",
    )
    parser.add_argument(
        "--force",
        action="store_true",
        help="replace existing files even if Firn did not write them",
    )
    parser.add_argument(
        "-o",
        "--output",
        default="report",
        metavar="DIR",
        help="folder for the page (default: report)",
    )
    return parser.parse_args(arguments)


def inputs(options: argparse.Namespace) -> list[str]:
    """Every file that is read."""
    others = [path for path in (options.baseline, options.errors) if path]
    return [options.file, *options.check, *others]


def report(options: argparse.Namespace, command: str) -> int:
    """Writes the page of a trajectory or of results; returns the exit status.

    Raises InputError for a file of another format.
    """
    kind = file_format(options.file)
    checks = [each for path in options.check for each in check.read(path)]
    if kind == "firn-trajectory":
        run = trajectory.read(options.file)
        for each in checks:
            check.require_same_trajectory(each, run.facts, run.scene_text, options.file)
        result, png = trajectory_page.build(run, checks, command)
        if options.errors:
            result.sections.insert(2 if checks else 1, errors_section(options, checks))
        pictures = {"snowball.png": png}
        print(page.write(result, options.output, pictures, inputs(options), options.force))
        return 0
    if kind == "firn-results":
        return report_results(options, checks, command)
    raise InputError(f"{options.file}: format: got {kind}, allowed: firn-trajectory, firn-results")


def errors_section(options: argparse.Namespace, checks: list[check.Check]) -> page.Section:
    """The map of errors, under the command of the check of this scene."""
    of_scene = [each for each in checks if not each["of_a_set"]]
    command = check.command(of_scene[0]) + " --dump " + options.errors if of_scene else ""
    return error_map.section(error_map.read(options.errors), command)


def require_comparable(new: results.Results, old: results.Results) -> None:
    """Raises InputError if a baseline has nothing to compare with, or numbers that cannot be."""
    common = [c for c in old.cases if new.find(c.suite, c.name)]
    if not common:
        raise InputError(f"{old.path}: cases in common with {new.path}: got 0, allowed: at least 1")
    for case in common:
        if wrong := next((w for q in case.quantities.values() if (w := results.flaw(q))), ""):
            raise InputError(
                f"{old.path}: cases/{case.suite}/{case.name}: {wrong}, allowed: finite numbers"
            )


def report_results(options: argparse.Namespace, checks: list[check.Check], command: str) -> int:
    """Exit status 1 if something became worse than the baseline."""
    new, old = results.read(options.file), None
    if options.readme_table:
        print(readme_table.text(new))
        return 0
    if options.baseline:
        if (kind := file_format(options.baseline)) != "firn-results":
            raise InputError(f"{options.baseline}: format: got {kind}, allowed: firn-results")
        old = results.read(options.baseline)
        require_comparable(new, old)
    result, failed = results_page.build(new, old, options.threshold, command)
    for each in checks:
        check.require_same_results(each, new.sessions, new.subjects())
    if checks:
        result.sections.append(check.section(checks))
    if options.errors:
        result.sections.append(errors_section(options, checks))
    print(page.write(result, options.output, None, inputs(options), options.force))
    if failed:
        names = baseline.named(new, old, options.threshold) if old else []
        print("worse than the baseline: " + "; ".join(names), file=sys.stderr)
    return 1 if failed else 0


def tell(message: str) -> int:
    """One line on stderr; exit status 2."""
    print("firn report:", " ".join(message.split()), file=sys.stderr)
    return 2


def main(arguments: list[str] | None = None) -> int:
    """Exit status: 0, 1 if something became worse than the baseline, 2 for bad input."""
    arguments = sys.argv[1:] if arguments is None else arguments
    try:
        return report(parse(arguments), "firn report " + shlex.join(arguments))
    except (InputError, OSError) as error:
        return tell(str(error))
    except Exception as error:  # a file that no check above has thought of
        return tell(f"{' '.join(arguments)}: cannot be shown: {type(error).__name__}: {error}")


if __name__ == "__main__":
    sys.exit(main())
