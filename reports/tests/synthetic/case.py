# SPDX-License-Identifier: BSD-3-Clause
"""A measured case and its quantities, as plain values."""


def case(suite, name, parameters, quantities, status="measured", slow=1.0, seed=0):
    return {
        "suite": suite,
        "name": name,
        "parameters": parameters,
        "quantities": quantities,
        "status": status,
        "slow": slow,
        "seed": seed,
    }


def solver(solver, precision, threads=1, **more):
    return {"solver": solver, "precision": precision, "threads": threads, **more}


def timing(value, units="ns", better="lower"):
    return (value, units, better, True)


def computed(value, better="lower"):
    return (value, "1", better, False)
