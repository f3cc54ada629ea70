# SPDX-License-Identifier: BSD-3-Clause
"""What became faster or slower than in an older results file, beyond the noise."""

from dataclasses import dataclass

import numpy as np

from .kinds import Array
from .results import Case, Results

# A change counts if it exceeds this share and also what the repetitions of both runs leave open.
THRESHOLD = 0.10


@dataclass
class Change:
    """A quantity of a case in the older and the newer file."""

    case: Case
    quantity: str
    units: str
    old: float
    new: float
    ratio: float  # > 1: worse, whichever direction is better
    uncertainty: float  # of the ratio, relative
    kind: str  # "worse", "better", "same", "drowned"


def median_error(values: Array) -> float:
    """Relative standard error of the median of n repetitions: 1.25 σ/√n, σ from the quartiles."""
    values = np.asarray(values, float)
    if len(values) < 3:
        return 0.0
    low, high = np.percentile(values, [25, 75])
    return float(1.25 * (high - low) / 1.35 / np.sqrt(len(values)) / abs(np.median(values)))


def machine_ratio(new: Results, old: Results) -> float:
    """How much slower the machine itself was, by the fixed loop of all cases of both runs."""
    loops = [np.concatenate([c.calibration for c in r.cases] or [np.ones(1)]) for r in (new, old)]
    return (
        float(np.median(loops[0]) / np.median(loops[1]))
        if all(len(x) and np.median(x) > 0 for x in loops)
        else 1.0
    )


# Units of what a slower machine changes; a ratio or a number of bytes does not know it.
CLOCKED = ("ns", "s", "flop/s", "B/s", "particle-steps/s")


def machine_change(case: Case, before: Case) -> float:
    """By how much the fixed loop around the two measurements of a case differed, as a share."""
    loops = [np.median(c.calibration) if len(c.calibration) else np.nan for c in (case, before)]
    return (
        abs(float(loops[0] / loops[1]) - 1)
        if np.all(np.isfinite(loops)) and min(loops) > 0
        else 0.0
    )


def compare(new: Results, old: Results, threshold: float = THRESHOLD) -> list[Change]:
    """One Change for every quantity with a direction that both files quote."""
    changes = []
    for case in new.cases:
        before = old.find(case.suite, case.name)
        if before is None:
            continue
        for name, quantity in case.quantities.items():
            reference = before.quantities.get(name)
            if name == "rate" and "time" in case.quantities:
                continue  # the same repetitions, upside down
            if name != "speedup" and "speedup" in case.quantities:
                continue  # what was interleaved is judged by its ratio alone
            if (
                reference is None
                or quantity.better == "neither"
                or not len(quantity.values)
                or not len(reference.values)
            ):
                continue
            if not (quantity.median > 0 and reference.median > 0):
                continue  # an error of 0; what is not a number has made the case a failed one
            ratio = quantity.median / reference.median
            if quantity.better == "higher":
                ratio = 1 / ratio
            # 3 standard errors: one case in 400 by chance.
            noise = 3 * np.hypot(median_error(quantity.values), median_error(reference.values))
            if quantity.units in CLOCKED:
                noise += machine_change(case, before)
            limit = 1 + max(threshold, noise)
            if not (case.quotable and before.quotable):
                kind = "drowned"
            else:
                kind = "worse" if ratio > limit else "better" if ratio < 1 / limit else "same"
            changes.append(
                Change(
                    case,
                    name,
                    quantity.units,
                    reference.median,
                    quantity.median,
                    float(ratio),
                    float(noise),
                    kind,
                )
            )
    return changes


def appeared_broken(new: Results, old: Results) -> list[Case]:
    """Cases that were fine in the old file and are invalid or failed now."""
    return [
        case
        for case in new.cases
        if case.status in ("invalid", "failed")
        and (before := old.find(case.suite, case.name)) is not None
        and before.status not in ("invalid", "failed")
    ]


def named(new: Results, old: Results, threshold: float) -> list[str]:
    """Every case that broke or became worse, and how."""
    return [
        f"{case.suite}/{case.name}: {case.status}: {case.message}"
        for case in appeared_broken(new, old)
    ] + [
        f"{c.case.suite}/{c.case.name}: {c.quantity} {100 * (c.ratio - 1):.3g} % worse"
        for c in compare(new, old, threshold)
        if c.kind == "worse"
    ]
