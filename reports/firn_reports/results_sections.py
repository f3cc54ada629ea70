# SPDX-License-Identifier: BSD-3-Clause
"""The sections of a results page, one per suite."""

from collections.abc import Callable

from . import (
    accuracy,
    accuracy_tables,
    baseline as comparison,
    case_tables,
    float_accuracy,
    implicit,
    kernel_figures,
    limits,
    results_figures as figures,
    results_tables as tables,
    roofline,
    speed_figures,
)
from .baseline import Change
from .page import Figure, Section, number
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
    section.figures = speed_figures.speed(results)
    section.tables = (
        tables.of_suite(results, "steps", "speed", "Whole steps")
        + tables.of_suite(results, "speedup", "speedup", "Against the reference")
        + tables.of_suite(results, "scaling", "scaling", "Threads and sizes, interleaved")
    )
    return with_intro_only_if_filled(section)


def roofline_section(results: Results) -> Section:
    """Whole steps against the ceilings of the machine."""
    section = Section("roofline", "Roofline", INTRO["roofline"])
    section.figures = roofline.roofline(results)
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


stages_section = simple(
    "stages", "Stage by stage", "stages", speed_figures.stages, "Time per stage"
)
stability_section = simple("stability", "Stability", "stability", limits.stability, "Stable steps")
snowball_section = simple(
    "snowball", "Plastic snowball over seeds", "snowball", figures.snowball, "Five seeds each"
)
skips_section = simple("skips", "What each skip saves", "skips", speed_figures.skips, "Skips")
targets_section = simple(
    "targets", "Instruction sets", "targets", kernel_figures.targets, "Instruction sets"
)
float_section = simple(
    "float", "Accuracy of float", "float", float_accuracy.float_accuracy, "Float against double"
)
kernels_section = simple("kernels", "Kernels", "kernels", kernel_figures.kernels, "Kernels")


def accuracy_section(results: Results) -> Section:
    """Run time against error."""
    section = Section("accuracy", "Run time against error", INTRO["accuracy"])
    section.figures = accuracy.figures(results)
    section.tables = (
        accuracy_tables.time_to_error(results)
        + accuracy_tables.order_table(results)
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
        "stress", "What each solver did under stress", tables=float_accuracy.stress_table(results)
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
    section.tables = case_tables.noisy(results)
    return section


def facts_section(results: Results) -> Section:
    """Machine, build, and what each case said."""
    section = Section("facts", "Machine, build and log")
    section.tables = [
        case_tables.sessions(results),
        case_tables.all_cases(results),
        case_tables.repetitions(results),
    ]
    lines = [
        f"{c.suite}/{c.name}: {c.status}"
        + (f": {c.message}" if c.message else "")
        + f"\n    {c.validation}"
        for c in results.cases
    ]
    section.logs = [("Validation and remarks, case by case", "\n".join(lines))] if lines else []
    return section
