"""The page of a results file: the summary first, then what each suite found."""

from collections.abc import Callable, Sequence

from . import (
    accuracy,
    baseline as comparison,
    implicit,
    limits,
    results_figures as figures,
    results_tables as tables,
)
from .baseline import Change
from .page import Figure, Mark, Page, Section, Tile, number
from .results import Case, Results

INTRO = {
    "speed": "Wall time of whole steps: medians of all repetitions, bars from the first to the third quartile. "
    "Every solver was checked against the reference for one step before it was timed. In the elastic block no particle yields; in the plastic block every particle yields in every step.",
    "roofline": "What this machine can do at best, measured in the same run, and how near the steps come to it. The FMA peak is that of the widest instruction set, named in the figures: "
    "chains of multiply-adds in registers, two flop per lane. The work of a step is that of a plain implementation: 64 nodes × (13 values scattered + 15 gathered) multiply-adds "
    "and 8 products of weights, without the update of F. A step that factors the kernel does less work than this count, so its share looks higher than it is. "
    "The section on instruction sets counts what the factored step needs and compares it with the peak of each set.",
    "stages": "Where a step spends its time. Stages that a solver runs together share one row.",
    "accuracy": "Error against exact solutions, and the time it takes. Convergence of a FLIP blend depends on how α is chosen; each line names the policy. "
    "`rate` means 1 − α ∝ Δt, a fixed damping per time. “implicit β” is the semi-implicit step, solved to 1e-6. "
    "These are errors of the method. For the errors of a solver's own arithmetic, at the same h, Δt and α, see “Verification” (every stage in units of its roundoff bound) and “Accuracy of float” (drift).",
    "implicit": "A semi-implicit step needs a solve but may be longer. This section shows what it costs, how many iterations it takes, and when it reaches a given error sooner than explicit steps. "
    "The scene is a cube of snow that lands on a floor at 1.5 m/s; r is Δt over ½ h/c. Every residual was recomputed after the iteration.",
    "stability": "Every time step that the bisections tried, and the limit between stable and unstable ones, in units of h/c with the hardened sound speed c. F is perturbed by 1e-7; a run of 600 steps "
    "is unstable if the perturbation grows 1e4-fold. Dashed: predicted from the plane-wave recurrence or, for a lone particle, from its own factor 1 − z². "
    "Distances are measured from the step at which the predicted growth becomes visible in 600 steps, 0.3 to 2 % beyond the limit itself.",
    "snowball": "A plastic impact has no formal order of convergence. This section shows bands over seeds of the sampling instead.",
    "skips": "Share of a step that each skip saves, from runs with and without it in turn. A negative value means that the skip costs time.",
    "targets": "The same code on every instruction set that this processor has.",
    "float": "What single precision costs compared with double: errors that would be zero in exact arithmetic.",
    "kernels": "Single kernels, each validated before it was timed, on every instruction set of this processor, next to library routines. The rows from P2G to “positions” are stages of a block that stays in the cache. "
    "The optimized solver scatters mass, momentum and forces in one pass and computes its weights there; its row “P2G, mass and momentum” contains all of this.",
}


def build(
    results: Results,
    old: Results | None = None,
    threshold: float = comparison.THRESHOLD,
    command: str = "",
) -> tuple[Page, bool]:
    """The page, and True if something is worse than in `old`."""
    changes = comparison.compare(results, old, threshold) if old else []
    broken = comparison.appeared_broken(results, old) if old else []
    machine = results.sessions[0] if results.sessions else {}
    page = Page(title="Speed, accuracy and stability", command=command)
    page.subtitle = (
        f"{machine.get('processor', 'unknown processor')}, {machine.get('processors', '?')} processors, "
        f"{machine.get('instruction_set', '?')}; commit {machine.get('git_commit', '?')}, {str(machine.get('started', ''))[:10]}"
    )
    page.sections = [
        section
        for section in [
            baseline_section(results, old, changes, broken, threshold) if old else None,
            verification_section(results),
            speed_section(results),
            roofline_section(results),
            stages_section(results),
            accuracy_section(results),
            implicit_section(results),
            snowball_section(results),
            stability_section(results),
            stress_section(results),
            skips_section(results),
            targets_section(results),
            float_section(results),
            kernels_section(results),
            noise_section(results),
            facts_section(results),
        ]
        if section
    ]
    page.sections = [section for section in page.sections if not section.empty()]
    present = {section.id for section in page.sections}
    set_verdict(page, results, old, changes, broken)
    page.tiles = [
        tile for tile in tiles(results, old, changes) if not tile.target or tile.target in present
    ]
    page.look_at = [
        (text, target) for text, target in look_at(results, changes, broken) if target in present
    ]
    return page, failed(changes, broken)


def failed(changes: list[Change], broken: list[Case]) -> bool:
    """True if something became worse than the threshold allows, or broke."""
    return bool(broken) or any(change.kind == "worse" for change in changes)


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
    share = figures.best_share_of_peak(results)
    if share:
        result.append(
            Tile(
                "Of the FMA peak",
                f"{number(100 * share[0], 2)} %",
                f"of {figures.widest(results) or 'this machine'}, plain count, {share[1]}",
                target="roofline",
                command="firn bench roofline steps",
            )
        )
    order = accuracy.best_order(results)
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
    noise = tables.noise(results)
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
    busy = tables.busiest(results)
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
    scaling = tables.worst_scaling(results)
    if scaling and scaling[0] < 0.9 * scaling[1]:
        copies = scaling[3].value(figures.COPIES)
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
    growth = tables.size_growth(results)
    if growth and growth[0] > 1.15:
        found.append(
            (
                f"A particle costs {number(growth[0], 3)}× what it costs among 100 000 ({growth[1]})",
                "speed",
            )
        )
    costly = tables.costliest_skip(results)
    if costly:
        found.append(
            (
                f"The skip “{costly[1]}” costs {number(100 * costly[0], 2)} % in the situation “{costly[2]}”",
                "skips",
            )
        )
    stuck = tables.worst_float(results)
    if stuck:
        found.append(
            (f"Largest loss to single precision: {stuck[1]}, {number(stuck[0], 2)}", "float")
        )
    return found[:6]


def baseline_section(
    results: Results, old: Results, changes: list[Change], broken: list[Case], threshold: float
) -> Section:
    """What changed against an older file."""
    section = Section(
        "baseline",
        "Against the baseline",
        f"Compared with {old.path.name}, commit {old.sessions[0].get('git_commit', '?') if old.sessions else '?'}. Worse means: beyond {number(100 * threshold, 2)} % "
        f"and beyond three standard errors of both medians; for times also beyond what the fixed loop changed by around that case. The machine's fixed loop took {number(comparison.machine_ratio(results, old), 3)} times as long as then.",
    )
    section.figures = figures.changes(changes)
    section.tables = tables.changes(changes, broken)
    return section


def verification_section(results: Results) -> Section:
    """What the verification found, and the mutants."""
    section = Section("verification", "Verification")
    section.figures = figures.verification(results)
    section.tables = tables.verification(results) + tables.mutants(results)
    return section


def speed_section(results: Results) -> Section:
    """How fast whole steps are."""
    section = Section("speed", "Speed", INTRO["speed"])
    section.figures = figures.speed(results)
    section.tables = (
        tables.of_suite(results, "steps", "speed", "Whole steps")
        + tables.of_suite(results, "speedup", "speedup", "Against the reference")
        + tables.of_suite(results, "scaling", "scaling", "Threads and sizes, interleaved")
    )
    return with_intro_only_if_filled(section)


def roofline_section(results: Results) -> Section:
    """Whole steps against the ceilings of the machine."""
    section = Section("roofline", "Roofline", INTRO["roofline"])
    section.figures = figures.roofline(results)
    section.tables = tables.of_suite(
        results, "roofline", "roofline", "Machine probes"
    ) + tables.roofline_points(results)
    return with_intro_only_if_filled(section)


def simple(
    identifier: str,
    title: str,
    suite: str,
    make_figures: Callable[[Results], list[Figure]],
    table_title: str,
) -> Callable[[Results], Section]:
    """A function that makes a section with the figures and the table of one suite."""

    def build_section(results: Results) -> Section:
        """The section of these results."""
        section = Section(identifier, title, INTRO[suite])
        section.figures = make_figures(results)
        section.tables = tables.of_suite(results, suite, suite, table_title)
        return with_intro_only_if_filled(section)

    return build_section


def with_intro_only_if_filled(section: Section) -> Section:
    """The section, without its introduction if it has neither figure nor table."""
    if not (section.figures or section.tables):
        section.intro = ""
    return section


stages_section = simple("stages", "Stage by stage", "stages", figures.stages, "Time per stage")
stability_section = simple("stability", "Stability", "stability", limits.stability, "Stable steps")
snowball_section = simple(
    "snowball", "Plastic snowball over seeds", "snowball", figures.snowball, "Five seeds each"
)
skips_section = simple("skips", "What each skip saves", "skips", figures.skips, "Skips")
targets_section = simple(
    "targets", "Instruction sets", "targets", figures.targets, "Instruction sets"
)
float_section = simple(
    "float", "Accuracy of float", "float", limits.float_accuracy, "Float against double"
)
kernels_section = simple("kernels", "Kernels", "kernels", figures.kernels, "Kernels")


def accuracy_section(results: Results) -> Section:
    """Run time against error."""
    section = Section("accuracy", "Run time against error", INTRO["accuracy"])
    section.figures = accuracy.figures(results)
    section.tables = (
        accuracy.time_to_error(results)
        + accuracy.order_table(results)
        + tables.of_suite(results, "accuracy", "accuracy", "Errors and times")
    )
    return with_intro_only_if_filled(section)


def implicit_section(results: Results) -> Section:
    """When semi-implicit steps pay."""
    section = Section("implicit", "Semi-implicit steps", INTRO["implicit"])
    section.figures = implicit.figures(results)
    section.tables = implicit.tables(results)
    return with_intro_only_if_filled(section)


def stress_section(results: Results) -> Section:
    """What each solver did under stress."""
    return Section(
        "stress", "What each solver did under stress", tables=limits.stress_table(results)
    )


def noise_section(results: Results) -> Section:
    """How steady the machine was."""
    section = Section("noise", "Noise of this machine")
    section.figures = figures.noise(results)
    if section.figures:
        section.intro = (
            "A fixed loop of a million dependent multiply-adds ran three times before and after each case. Its variation is that of the machine. "
            "A timing is quoted if its repetitions leave the median uncertain by at most 5 % (standard error, from the quartiles). Otherwise the case is run up to four "
            "times, every repetition is kept, and if that is not enough the case is reported as noisy, without a number."
        )
    section.tables = tables.noisy(results)
    return section


def facts_section(results: Results) -> Section:
    """Machine, build, and what each case said."""
    section = Section("facts", "Machine, build and log")
    section.tables = [
        tables.sessions(results),
        tables.all_cases(results),
        tables.repetitions(results),
    ]
    lines = [
        f"{c.suite}/{c.name}: {c.status}"
        + (f": {c.message}" if c.message else "")
        + f"\n    {c.validation}"
        for c in results.cases
    ]
    section.logs = [("Validation and remarks, case by case", "\n".join(lines))] if lines else []
    return section
