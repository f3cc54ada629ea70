# SPDX-License-Identifier: BSD-3-Clause
"""The summary of a results file as a Markdown table, for the README."""

from collections.abc import Iterable, Sequence

from . import accuracy_tables, highlights, limits, roofline, speed_figures
from .page import number
from .results import Results


def million(rate: float) -> str:
    """A rate [1/s] in millions."""
    return f"{number(rate / 1e6, 3)} M/s"


def rate_rows(results: Results) -> list[list[str]]:
    """One row per solver, precision and deformation: one thread, all threads, speed-up."""
    cases = [c for c in results.suite("steps") if c.quotable]
    rows = []
    for name in sorted(
        {(c["solver"], c["precision"], c["deformation"]) for c in cases},
        key=lambda n: (n[0] != "reference", n),
    ):
        mine = [c for c in cases if (c["solver"], c["precision"], c["deformation"]) == name]
        # The largest block that was quoted with one thread and with all; else with one.
        most = max(c["threads"] for c in mine)
        sizes = {t: {c["particles"] for c in mine if c["threads"] == t} for t in (1, most)}
        particles = max(sizes[1] & sizes[most] or sizes[1], default=None)
        at = {c["threads"]: c for c in mine if c["particles"] == particles}
        if 1 not in at:
            continue
        most = max(at)
        ratio = next(
            (
                c
                for c in results.suite("speedup")
                if c.quotable
                and c["threads"] == 1
                and (c["solver"], c["precision"], c["deformation"]) == name
            ),
            None,
        )
        memory = at[1].value("memory")
        rows.append(
            [
                f"{name[0]}, {name[1]}, {name[2]}",
                f"{number(particles)}",
                million(at[1].median("rate")),
                f"{million(at[most].median('rate'))} ({most} T)" if most > 1 else "–",
                f"{number(ratio.value('speedup'), 3)}×" if ratio else "–",
                f"{number(memory, 3)} B" if memory else "–",
            ]
        )
    return rows


def span(values: Sequence[float], digits: int) -> str:
    """ "34 to 39", or one number if all are the same."""
    least, most = number(min(values), digits), number(max(values), digits)
    return least if least == most else f"{least} to {most}"


def facts(results: Results) -> list[tuple[str, str]]:
    """(what, figure) of everything else that the summary quotes."""
    found = []
    if share := roofline.best_share_of_peak(results):
        found.append(
            (
                f"share of the FMA peak of {roofline.widest(results)}, {share[1]}, at best, what a plain step needs",
                f"{number(100 * share[0], 2)} %",
            )
        )
    for count, step in (("plain", "a plain step"), ("factored", "the factored step")):
        shares: dict[str, list[float]] = {}
        for case in results.suite("targets"):
            if (own := case.value(f"FMA peak, {count} count")) is not None:
                shares.setdefault(case["target"].upper(), []).append(100 * own)
        found += [
            (
                f"share of the FMA peak of {target}, optimized, 100 000 particles, what {step} needs",
                f"{span(mine, 2)} %",
            )
            for target, mine in shares.items()
        ]
    for threads in sorted(
        {c["threads"] for c in results.suite("scaling") if c.value("efficiency") is not None}
    ):
        mine = [
            c
            for c in results.suite("scaling")
            if c["threads"] == threads and c.value("efficiency") is not None
        ]
        copies = [
            c.median(speed_figures.COPIES)
            for c in mine
            if c.value(speed_figures.COPIES) is not None
        ]
        beside = f"; {span(copies, 3)}" if copies else ""
        found.append(
            (
                f"efficiency of {threads} threads{'; of as many independent copies' if copies else ''}",
                span([c.median("efficiency") for c in mine], 3) + beside,
            )
        )
    if order := accuracy_tables.best_order(results):
        found.append((f"observed order, {order[1]}", number(order[0], 3)))
    if worst := limits.worst_limit(results):
        found.append(
            (
                f"stability limits, largest distance from prediction ({worst[1]})",
                f"{number(100 * worst[0], 2)} %",
            )
        )
    for subject, verdict in results.verify.items():
        found.append(
            (f"verification of {subject}", f"{verdict['verdict']}, {len(verdict['rows'])} checks")
        )
    if results.mutants:
        rows = results.mutants["rows"]
        found.append(
            ("wrong solvers caught", f"{sum(bool(r['caught']) for r in rows)} of {len(rows)}")
        )
    quoted = sum(c.quotable for c in results.cases)
    if results.cases:
        found.append(
            ("cases quoted, of all that were measured", f"{quoted} of {len(results.cases)}")
        )
    if (noise := highlights.noise(results)) is not None:
        found.append(
            (
                "noise: spread of a fixed loop between the cases",
                f"{100 * noise:.2g} %" if noise < 1 else f"{100 * noise:.0f} %",
            )
        )
    return found


def markdown_table(columns: list[str], rows: Iterable[Sequence[str]]) -> list[str]:
    """The lines of a table in Markdown."""
    lines = ["| " + " | ".join(columns) + " |", "|" + "---|" * len(columns)]
    return lines + ["| " + " | ".join(str(cell) for cell in row) + " |" for row in rows]


def text(results: Results) -> str:
    """The summary: rates, other figures, and where and how they were measured."""
    machine = results.sessions[0] if results.sessions else {}
    lines = []
    if rows := rate_rows(results):
        lines += [
            *markdown_table(
                [
                    "particle-steps per second",
                    "particles",
                    "1 thread",
                    "all threads",
                    "times the reference",
                    "memory per particle",
                ],
                rows,
            ),
            "",
        ]
    if found := facts(results):
        lines += [*markdown_table(["what", "figure"], found), ""]
    lines.append(
        f"Measured {str(machine.get('started', 'unknown'))[:10]} on {machine.get('processor', 'an unknown processor')}, "
        f"{machine.get('processors', '?')} processors, {machine.get('instruction_set', '?')}, {machine.get('compiler', '?')}, commit {machine.get('git_commit', '?')}, "
        f"load {str(machine.get('load_average', '?')).split(' ')[0]} at the start, by"
    )
    lines += [
        "",
        "```sh",
        f"firn bench -o {results.path}",
        f"firn report {results.path} --readme-table",
        "```",
    ]
    return "\n".join(lines)
