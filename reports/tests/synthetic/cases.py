# SPDX-License-Identifier: BSD-3-Clause
"""A few cases of every suite, with medians that are known."""

from itertools import product

from .case import case, computed, solver, timing
from .limit_cases import implicit_cases, stability_cases

# Solver, precision and time of a plastic step [ns].
SOLVERS = (("reference", "double", 2000.0), ("optimized", "float", 100.0))
FLOAT = ("optimized", "float")


def probes():
    """FMA peaks of 1e11 and 5e10 flop/s per thread, and a bandwidth of 1e10 B/s."""
    cases = []
    for (precision, peak), threads in product((("float", 1e11), ("double", 5e10)), (1, 2)):
        probe = f"fma_{precision}"
        rate = {"rate": timing(peak * threads, "flop/s", "higher")}
        parameters = {"probe": probe, "threads": threads}
        cases.append(case("roofline", f"{probe},{threads}T", parameters, rate))
    parameters = {"probe": "triad", "threads": 1}
    rate = {"rate": timing(1e10, "B/s", "higher")}
    return [*cases, case("roofline", "triad,1T", parameters, rate)]


def steps(who, precision, base):
    """Whole steps and their stages; elastic ones take 0.7 of the time."""
    cases = []
    for deformation, factor in (("elastic", 0.7), ("plastic", 1.0)):
        block = {"deformation": deformation, "particles": 100000}
        for particles, threads in product((100000, 1000000), (1, 2)):
            if threads > 1 and who == "reference":
                continue
            time = base * factor / threads
            name = f"{who},{precision},{threads}T,{deformation},{particles}"
            parameters = solver(who, precision, threads, **block | {"particles": particles})
            rate = timing(1e9 / time, "particle-steps/s", "higher")
            cases.append(case("steps", name, parameters, {"time": timing(time), "rate": rate}))
        parts = {"rasterize": timing(base / 2), "deformation": timing(base / 2)}
        name = f"{who},{precision},1T,{deformation},100000"
        parameters = solver(who, precision, **block)
        cases.append(case("stages", name, parameters, {"whole step": timing(base)} | parts))
    return cases


def errors(who, precision, base):
    """A standing wave: second order without damping, first order with α = 0."""

    def wave(name, n, error, seconds, **more):
        parameters = solver(who, precision, problem="standing wave", cells=n, h=1 / n, **more)
        quantities = {"error": computed(error), "time": timing(seconds, "s")}
        return case("accuracy", f"standing wave,{who},n={n},{name}", parameters, quantities)

    cases = [
        wave(
            f"alpha={policy}",
            n,
            (16 / n) ** order * 0.1,
            base * n**2 * 1e-6,
            cfl=0.4,
            alpha_policy=policy,
        )
        for (policy, order), n in product((("1", 2), ("0", 1)), (16, 32, 64))
    ]
    # Stable beyond the explicit limit, and less accurate than it is fast.
    return cases + [
        wave(
            "cfl=8,alpha=1,implicit 0.5",
            n,
            (16 / n) ** 2 * 0.5,
            base * n**2 * 4e-7,
            cfl=8,
            alpha_policy="1",
            integration="implicit 0.5",
        )
        for n in (16, 32)
    ]


def float_and_stress(who, precision):
    """Two tests of precision and two situations."""
    after = {f"error after {k} steps": computed(1e-7 * k) for k in (10, 30, 100)}
    parameters = solver(who, precision, test="drift", what="drift")
    drift = {"error": computed(1e-5)} | after
    cases = [case("float", f"drift,{who},{precision}", parameters, drift)]
    for situation, expected, outcome in (
        ("a lone particle", "goes on", "20 steps, all finite"),
        ("F_E is not a number", "stops", "stopped: stage 3 (grid_forces), particle 3"),
    ):
        parameters = solver(who, precision, situation=situation, expected=expected, outcome=outcome)
        cases.append(case("stress", f"{situation},{who},{precision}", parameters, {}))
    parameters = solver(who, precision, test="creep", what="1e-8 m per step")
    creep = {"error": computed(1e-6)}
    return [*cases, case("float", f"creep,{who},{precision}", parameters, creep)]


def ratios():
    """20 times the reference; two threads bring 1.6×, two copies 1.8×; a large block costs 1.2×."""
    block = {"deformation": "plastic"}
    speedup = {"speedup": timing(20.0, "1", "higher")}
    threads = {
        "efficiency": timing(0.8, "1", "higher"),
        "efficiency of independent copies": timing(0.9, "1", "neither"),
        "efficiency over that of copies": timing(0.8 / 0.9, "1", "higher"),
    }
    growth = {"growth": timing(1.2, "1", "lower")}
    return [
        case(
            "speedup",
            "optimized,float,1T,plastic,100000",
            solver(*FLOAT, **block, particles=100000),
            speedup,
        ),
        case(
            "scaling",
            "optimized,float,2T,plastic,1000000",
            solver(*FLOAT, 2, **block, particles=1000000),
            threads,
        ),
        case(
            "scaling",
            "optimized,float,1T,plastic,4000000",
            solver(*FLOAT, 1, **block, particles=4000000),
            growth,
        ),
    ]


def skips():
    """A skip that saves 30 % of an elastic step and costs 3 % of a plastic one."""
    return [
        case(
            "skips",
            f"box,{situation}",
            solver(*FLOAT, skip="box", situation=situation),
            {"saved": computed(saved, "higher")},
        )
        for situation, saved in (("elastic", 0.3), ("plastic", -0.03))
    ]


def targets():
    """One instruction set, at half its peak by the factored count."""
    quantities = {
        "time": timing(100.0),
        "FMA peak, factored count": computed(0.5, "higher"),
        "FMA peak, plain count": computed(0.6, "higher"),
    }
    parameters = solver(*FLOAT, target="avx2", deformation="plastic")
    return [case("targets", "avx2,float", parameters, quantities)]


def snowballs():
    """Two resolutions that end in the same state."""
    return [
        case(
            "snowball",
            f"optimized,float,resolution={n}",
            solver(*FLOAT, resolution=n),
            {"J_P": computed(0.95, "neither")},
        )
        for n in (4, 6)
    ]


def kernels():
    """One kernel, 40 times faster than Eigen's."""
    svd = {"kernel": "SVD", "precision": "double"}
    return [
        case("kernels", "svd,Eigen", svd | {"code": "Eigen"}, {"time": timing(800.0)}),
        case(
            "kernels",
            "svd,optimized",
            svd | {"code": "optimized", "target": "avx2"},
            {"time": timing(20.0)},
        ),
    ]


def synthetic_cases():
    """A few cases of every suite."""
    cases = probes()
    for who, precision, base in SOLVERS:
        cases += steps(who, precision, base) + errors(who, precision, base)
        cases += float_and_stress(who, precision)
    cases += ratios() + implicit_cases() + stability_cases()
    return cases + skips() + targets() + snowballs() + kernels()
