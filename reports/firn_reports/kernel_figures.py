# SPDX-License-Identifier: BSD-3-Clause
"""Instruction sets and single kernels."""

from typing import Any

from .drawing import bars, left_out, with_quartiles
from .page import Figure
from .results import Case, Results
from .roofline import PLAIN_FLOP


def targets(results: Results) -> list[Figure]:
    """Time and share of the peak of each instruction set."""
    every = results.suite("targets")
    cases = sorted(
        [c for c in every if c.quotable],
        key=lambda c: (c["deformation"], c["precision"], c["target"]),
    )
    if not cases:
        return []

    def name(c: Case) -> str:
        """Label of a case."""
        return f"{c['target']}, {c['precision']}, {c['deformation']}"

    made = [
        Figure(
            "Time per particle and step",
            bars([(name(c), *with_quartiles(c, "time")) for c in cases], "ns"),
            command="firn bench targets",
            caption="The same code, 100 000 particles, one thread." + left_out(every, name),
        )
    ]
    for count, (what, why) in COUNTS.items():
        shares = [
            (name(c), *with_quartiles(c, f"FMA peak, {count} count", 100))
            for c in cases
            if f"FMA peak, {count} count" in c.quantities
        ]
        if shares:
            made.append(
                Figure(
                    f"Share of each instruction set's own peak, {count} count",
                    bars(shares, f"% of its FMA peak, {count} count"),
                    command="firn bench targets",
                    caption=f"{what}, over what the same instruction set reached right after each repetition: {why}.",
                )
            )
    return made


# What the shares of the FMA peak count (bench/needed_work.hpp), and what it is good for.
COUNTS = {
    "factored": (
        "Multiply-adds, additions and products that the factored step needs (1536 elastic, 1826 plastic per particle, each counted once)",
        "how busy the units are",
    ),
    "plain": (
        f"{PLAIN_FLOP} flop that plain transfers take per particle (this solver takes fewer)",
        "how fast it is, in a measure that other codes share",
    ),
}


def kernels(results: Results) -> list[Figure]:
    """Time of each kernel, one figure per kernel."""
    made = []
    every = results.suite("kernels")
    cases = [c for c in every if c.quotable]

    def name(c: Case) -> str:
        """Label of a case."""
        return ", ".join(str(c[key]) for key in ("code", "precision", "target") if c[key])

    for kernel in dict.fromkeys(
        c["kernel"] for c in sorted(every, key=lambda c: kernel_order(c["kernel"]))
    ):
        mine = sorted((c for c in cases if c["kernel"] == kernel), key=lambda c: c.median("time"))
        if not mine:
            continue
        rows = [(name(c), *with_quartiles(c, "time")) for c in mine]
        made.append(
            Figure(
                str(kernel),
                bars(
                    rows, "ns per item", log=max(r[1] for r in rows) > 20 * min(r[1] for r in rows)
                ),
                command=f"firn bench 'kernels/{kernel},*'",
                caption=left_out((c for c in every if c["kernel"] == kernel), name).strip(),
            )
        )
    return made


# In the order of a step, then what a particle needs; others behind.
KERNELS = (
    "weights",
    "sort into blocks",
    "P2G, mass and momentum",
    "P2G, forces",
    "grid update",
    "collision",
    "G2P, gradient and F",
    "G2P, velocities",
    "positions and movers",
    "SVD",
    "polar",
    "box test",
    "stress",
    "return map",
    "Hessian action",
)


def kernel_order(kernel: Any) -> tuple[int, str]:
    """Sorts kernels in the order of KERNELS."""
    return next(
        (i for i, name in enumerate(KERNELS) if str(kernel).startswith(name)), len(KERNELS)
    ), str(kernel)
