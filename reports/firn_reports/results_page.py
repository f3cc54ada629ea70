# SPDX-License-Identifier: BSD-3-Clause
"""The page of a results file: the summary first, then what each suite found."""

from . import baseline as comparison
from .baseline import Change
from .page import Page
from .results import Case, Results
from .results_sections import (
    accuracy_section,
    baseline_section,
    facts_section,
    float_section,
    implicit_section,
    kernels_section,
    noise_section,
    roofline_section,
    skips_section,
    snowball_section,
    speed_section,
    stability_section,
    stages_section,
    stress_section,
    targets_section,
    verification_section,
)
from .results_summary import look_at, set_verdict, tiles


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
