# SPDX-License-Identifier: BSD-3-Clause
"""The top of a results page: verdict, numbers, and what deserves a look."""

from collections.abc import Sequence

from . import accuracy_tables, highlights, limits, roofline, speed_figures
from .baseline import Change
from .page import Mark, Page, Tile, number
from .results import Case, Results


def set_verdict(
    page: Page, results: Results, old: Results | None, changes: list[Change], broken: list[Case]
) -> None:
    """Sets the verdict and the sentence beside it."""
    bad_subjects = [s for s, v in results.verify.items() if v["verdict"] != "VALID"]
    invalid = [c for c in results.cases if c.status in ("invalid", "failed")]
    survived = [m for m in results.mutants.get("rows", []) if not m["caught"]]
    worse = [c for c in changes if c.kind == "worse"]
    problems = []
    if bad_subjects:
        problems.append(f"{', '.join(bad_subjects)} failed the verification")
    if invalid:
        problems.append(
            f"{len(invalid)} of {len(results.cases)} cases gave wrong results or failed"
        )
    if survived:
        problems.append(f"{len(survived)} mutants were not caught")
    if worse or broken:
        problems.append(f"{len(worse) + len(broken)} figures are worse than the baseline")
    if problems:
        page.verdict, page.sentence = (
            Mark("INVALID" if bad_subjects or invalid or survived else "SLOWER", "bad"),
            "; ".join(problems),
        )
    elif results.verify:
        checks = sum(len(v["rows"]) for v in results.verify.values())
        page.verdict, page.sentence = (
            Mark("VALID", "good"),
            f"{number(checks)} checks passed; every timed case was validated first",
        )
    else:
        page.verdict = Mark("VALID", "good")
        page.sentence = (
            f"none of {number(len(results.cases))} cases gave a wrong result"
            if results.cases
            else "nothing was measured"
        )
    if old and not (worse or broken):
        page.sentence += "; nothing is slower than the baseline beyond the noise"


def best(cases: Sequence[Case], quantity: str) -> Case | None:
    """The case of the largest value of a quantity, None if none may be quoted."""
    quoted = [c for c in cases if c.value(quantity) is not None]
    return max(quoted, key=lambda c: c.median(quantity), default=None)


def tiles(results: Results, old: Results | None, changes: list[Change]) -> list[Tile]:
    """The numbers at the top of the page."""
    result = []
    for deformation in ("plastic", "elastic"):
        fastest = best(
            [
                c
                for c in results.suite("steps")
                if c["deformation"] == deformation and c["threads"] == 1
            ],
            "rate",
        )
        if fastest:
            result.append(
                Tile(
                    f"Fastest {deformation}, 1 thread",
                    f"{number(fastest.median('rate') / 1e6, 3)} M/s",
                    f"particle-steps; {fastest['solver']}, {fastest['precision']}, {number(fastest['particles'])}",
                    target="speed",
                    command=fastest.command,
                )
            )
    most = best(
        [
            c
            for c in results.suite("speedup")
            if c["threads"] == 1 and c["deformation"] == "plastic"
        ],
        "speedup",
    )
    if most:
        result.append(
            Tile(
                "Against the reference",
                f"{number(most.value('speedup'), 3)}×",
                f"{most['solver']}, {most['precision']}, plastic, 1 thread, interleaved",
                target="speed",
                command=most.command,
            )
        )
    share = roofline.best_share_of_peak(results)
    if share:
        result.append(
            Tile(
                "Of the FMA peak",
                f"{number(100 * share[0], 2)} %",
                f"of {roofline.widest(results) or 'this machine'}, plain count, {share[1]}",
                target="roofline",
                command="firn bench roofline steps",
            )
        )
    order = accuracy_tables.best_order(results)
    if order:
        result.append(
            Tile(
                "Observed order",
                number(order[0], 3),
                order[1],
                target="accuracy",
                command="firn bench 'accuracy/standing wave,*'",
            )
        )
    worst = limits.worst_limit(results)
    if worst:
        result.append(
            Tile(
                "Stability limits",
                f"{number(100 * worst[0], 2)} %",
                f"largest distance from prediction, {worst[1]}",
                "good" if worst[0] <= 0.03 else "warn",
                "stability",
                worst[2].command,
            )
        )
    for subject, verdict in results.verify.items():
        error = max((row["error"] for row in verdict["rows"]), default=0)
        result.append(
            Tile(
                f"Verification: {subject}",
                verdict["verdict"],
                f"{len(verdict['rows'])} checks, largest error {number(float(error), 2)} of its bound",
                "good" if verdict["verdict"] == "VALID" else "bad",
                "verification",
                verdict["command"],
            )
        )
    if results.mutants:
        rows = results.mutants["rows"]
        caught = sum(bool(row["caught"]) for row in rows)
        result.append(
            Tile(
                "Mutants caught",
                f"{caught}/{len(rows)}",
                "deliberately wrong solvers",
                "good" if caught == len(rows) else "bad",
                "verification",
                results.mutants.get("command", ""),
            )
        )
    if old:
        worse, better = (sum(c.kind == k for c in changes) for k in ("worse", "better"))
        result.append(
            Tile(
                "Against the baseline",
                f"{worse} worse",
                f"{better} better, {len(changes)} compared",
                "bad" if worse else "good",
                "baseline",
            )
        )
    noise = highlights.noise(results)
    if noise is not None:
        noisy = sum(c.status == "noisy" for c in results.cases)
        result.append(
            Tile(
                "Noise",
                f"{100 * noise:.2g} %" if noise < 1 else f"{100 * noise:.0f} %",
                f"of the fixed loop; {noisy} of {len(results.cases)} cases too noisy to quote",
                "warn" if noisy else "",
                "noise",
                "firn bench",
            )
        )
    return result


def shortened(text: str, most: int = 130) -> str:
    """The text, cut between words to about `most` characters."""
    return text if len(text) <= most else text[:most].rsplit(" ", 1)[0] + " …"


def look_at(results: Results, changes: list[Change], broken: list[Case]) -> list[tuple[str, str]]:
    """The few facts that a reader should look at first."""
    found = []
    asked = max((int(s.get("cases_asked_for", 0)) for s in results.sessions), default=0)
    if asked > len(results.cases):
        found.append(
            (
                f"An unfinished run: {len(results.cases)} of {asked} cases. firn bench on the same file completes it",
                "facts",
            )
        )
    changed = sorted(
        {str(s["environment"]) for s in results.sessions if s.get("environment", "none") != "none"}
    )
    if changed:
        found.append((f"Measured with {', '.join(changed)} in the environment", "facts"))
    busy = highlights.busiest(results)
    if busy:
        found.append(
            (
                f"The machine was busy: load {number(busy[0], 3)} on {busy[1]} processors. Ratios of interleaved runs are reliable, absolute times are not",
                "noise",
            )
        )
    for case in broken[:3]:
        found.append((f"{case.suite}/{case.name} no longer works: {case.message}", "baseline"))
    for change in sorted((c for c in changes if c.kind == "worse"), key=lambda c: -c.ratio)[:3]:
        found.append(
            (
                f"{change.case.suite}/{change.case.name}: {change.quantity} is {number(100 * (change.ratio - 1), 3)} % worse",
                "baseline",
            )
        )
    for case in [c for c in results.cases if c.status in ("invalid", "failed")][:3]:
        found.append(
            (shortened(f"{case.suite}/{case.name}: {case.status}: {case.message}"), "facts")
        )
    scaling = highlights.worst_scaling(results)
    if scaling and scaling[0] < 0.9 * scaling[1]:
        copies = scaling[3].value(speed_figures.COPIES)
        beside = (
            f"; as many independent copies brought {number(copies * scaling[1], 3)}×"
            if copies
            else ""
        )
        found.append(
            (
                f"{number(scaling[1])} threads bring {number(scaling[0], 3)}× at worst ({scaling[2]}){beside}",
                "speed",
            )
        )
    growth = highlights.size_growth(results)
    if growth and growth[0] > 1.15:
        found.append(
            (
                f"A particle costs {number(growth[0], 3)}× what it costs among 100 000 ({growth[1]})",
                "speed",
            )
        )
    costly = highlights.costliest_skip(results)
    if costly:
        found.append(
            (
                f"The skip “{costly[1]}” costs {number(100 * costly[0], 2)} % in the situation “{costly[2]}”",
                "skips",
            )
        )
    stuck = highlights.worst_float(results)
    if stuck:
        found.append(
            (f"Largest loss to single precision: {stuck[1]}, {number(stuck[0], 2)}", "float")
        )
    return found[:6]
