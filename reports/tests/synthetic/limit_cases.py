# SPDX-License-Identifier: BSD-3-Clause
"""Cases of the suites `implicit` and `stability`."""

from .case import case, computed, solver, timing


def implicit_cases():
    """Twice the cost of an explicit second at r = 10, half of it at 50; errors grow with r."""
    cases = []
    block = {"youngs_modulus": 1e6, "particles": 4096}
    for r, ratio in ((10, 2.0), (50, 0.5)):
        cases.append(
            case(
                "implicit",
                f"cost,optimized,double,1T,E=1e+06,r={r},cells=8",
                solver("optimized", "double", r=r, **block),
                {
                    "iterations 1e-3": computed(3.0 * r),
                    "iterations 1e-6": computed(6.0 * r),
                    "implicit over explicit": timing(ratio, "1"),
                },
            )
        )
    for r, error, time in ((0.5, 0.01, 2.0), (1, 0.02, 1.0), (5, 0.08, 0.6)):
        cases.append(
            case(
                "implicit",
                f"error,optimized,double,1T,E=1e+06,r={r}",
                solver("optimized", "double", r=r, tolerance=0 if r <= 1 else 1e-3, **block),
                {"error": computed(error), "time": (time, "s", "lower", False)},
            )
        )
    return cases


def stability_cases():
    cases = []
    tried = {"stable": computed(1.0, "neither"), "unstable": computed(20.0, "neither")}
    point = {"hardening": 10, "J_P": 1, "h": 0.05}
    for value in (0, 0.5, 1):
        cases.append(
            case(
                "stability",
                f"reference,alpha={value}",
                solver("reference", "double", varied="alpha", value=value, **point),
                {
                    "cfl": computed(1.5, "neither"),
                    "predicted_cfl": computed(1.48, "neither"),
                    **tried,
                },
            )
        )
    for value in (0.1, 0.5, 1):
        cases.append(
            case(
                "stability",
                f"optimized,beta={value}",
                solver("optimized", "double", varied="beta", value=value, **point),
                {
                    "cfl": computed(16 if value >= 0.5 else 2, "neither"),
                    "predicted_cfl": computed(16 if value >= 0.5 else 2.1, "neither"),
                },
            )
        )
    for varied, value, cfl in (
        ("E", 1e5, 1.5),
        ("E at h = 0.005", 1e5, 1.5),
        ("place of a lone particle, estimated volume", 0, 0.236),
        ("place of a lone particle, exact volume", 0, 0.667),
    ):
        cases.append(
            case(
                "stability",
                f"optimized,{varied}={value}",
                solver("optimized", "double", varied=varied, value=value, **point),
                {
                    "cfl": computed(cfl, "neither"),
                    "predicted_cfl": computed(cfl, "neither"),
                    "step": (1e-3, "s", "neither", False),
                    **tried,
                },
            )
        )
    return cases
