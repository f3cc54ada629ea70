# SPDX-License-Identifier: BSD-3-Clause
"""Whole steps against the ceilings of the machine."""

import numpy as np

from .drawing import styles, who
from .page import Figure
from .results import Case, Results
from .style import INK, legend, log_axis, panel, to_svg

# What a plain cubic-spline step computes per particle (bench/needed_work.hpp): 64 nodes times
# (1 mass + 3 momentum + 9 force in the scatter, 6 velocity + 9 gradient in the gather)
# multiply-adds, 8 for the products of weights. The update of F (some 500) is left out: it depends
# on what yields.
PLAIN_FLOP = 64 * (2 * 28 + 8)
# x, v, F_E, F_P read and written, m and V_0 read: numbers that any step must move if nothing stays
# in cache.
PLAIN_NUMBERS = 2 * 24 + 2


def peak(results: Results, precision: str, threads: int = 1) -> float | None:
    """FMA peak [flop/s] that the probe measured, None without a probe."""
    probe = results.find("roofline", f"fma_{precision},{threads}T")
    return probe.quantities["rate"].median if probe else None


def roofline_points(results: Results) -> list[tuple[Case, float, float, float]]:
    """(case, flop/s, flop/byte, share of the peak) of each whole step, by the plain count."""
    points = []
    for case in results.suite("steps"):
        ceiling = peak(results, case["precision"], case["threads"])
        if case.value("rate") is None or not ceiling:
            continue
        size = 4 if case["precision"] == "float" else 8
        rate = case.median("rate") * PLAIN_FLOP
        points.append((case, rate, PLAIN_FLOP / (PLAIN_NUMBERS * size), rate / ceiling))
    return points


def best_share_of_peak(results: Results) -> tuple[float, str] | None:
    """(share, who) of the step nearest the FMA peak on one thread."""
    points = [p for p in roofline_points(results) if p[0]["threads"] == 1]
    top = max(points, key=lambda p: p[3], default=None)
    return (top[3], f"{who(top[0])}, {top[0]['deformation']}") if top else None


def widest(results: Results) -> str:
    """ "AVX3 (512 bits)": what the probes, and so the ceilings, were measured with."""
    name = next(
        (str(c["instruction_set"]) for c in results.suite("roofline") if c["instruction_set"]), ""
    )
    bits = {
        "AVX3": 512,
        "AVX3_DL": 512,
        "AVX3_ZEN4": 512,
        "AVX2": 256,
        "SSE4": 128,
        "SSSE3": 128,
        "NEON": 128,
    }.get(name)
    return f"{name} ({bits} bits)" if bits else name


def roofline(results: Results) -> list[Figure]:
    """Ceilings of one thread and where whole steps lie below them, by precision."""
    band = results.find("roofline", "triad,1T")
    if not band:
        return []
    points = [p for p in roofline_points(results) if p[0]["threads"] == 1]
    made = []
    for precision in ("float", "double"):
        ceiling = peak(results, precision)
        if not ceiling:
            continue
        figure, axes = panel(4.6, 3.3)
        bandwidth = band.quantities["rate"].median
        mine = [p for p in points if p[0]["precision"] == precision]
        lowest = min([ceiling / 30, *(p[1] / 2 for p in mine)])
        x = np.logspace(np.log10(lowest / bandwidth), 2.3, 200)
        axes.plot(
            x,
            np.minimum(ceiling, bandwidth * x) / 1e9,
            color=INK,
            label=f"1 thread, {widest(results)}",
        )
        axes.annotate(
            f"FMA peak {ceiling / 1e9:.0f} Gflop/s",
            (x[-1], ceiling / 1e9),
            xytext=(0, 3),
            textcoords="offset points",
            ha="right",
            va="bottom",
            fontsize=8.5,
        )
        axes.annotate(
            f"triad {bandwidth / 1e9:.1f} GB/s",
            (3 * x[0], 3 * lowest / 1e9),
            xytext=(8, 0),
            textcoords="offset points",
            va="center",
            fontsize=8.5,
        )
        look = styles(f"{p[0]['solver']}, {p[0]['deformation']}" for p in mine)
        for name, style in look.items():
            # The largest block of each: the sizes lie upon one another.
            point = max(
                (p for p in mine if f"{p[0]['solver']}, {p[0]['deformation']}" == name),
                key=lambda p: p[0]["particles"],
            )
            axes.plot(
                [point[2]],
                [point[1] / 1e9],
                label=f"{name}: {100 * point[3]:.2g} %",
                **{**style, "linestyle": "none", "markersize": 6},
            )
        log_axis(axes, "x")
        log_axis(axes, "y")
        axes.set_ylim(lowest / 1e9, 2 * ceiling / 1e9)
        axes.set_xlabel("flop per byte, plain count")
        axes.set_ylabel("Gflop/s")
        legend(axes, ncols=2)
        made.append(
            Figure(
                f"Roofline, {precision}",
                to_svg(figure),
                command="firn bench roofline steps",
                caption=f"{PLAIN_FLOP} flop and {PLAIN_NUMBERS} numbers moved per particle-step by the plain count; the largest block of each. "
                "Percentages are of the FMA peak. To the right of the bend, arithmetic is the limit.",
            )
        )
    return made
