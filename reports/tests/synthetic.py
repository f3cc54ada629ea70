"""Small files of known content in Firn's formats: for tests, and for trying the page."""

import h5py
import numpy as np

SCENE = """name = "synthetic snowball"
gravity = [0.0, 0.0, -9.81]
[grid]
spacing = 0.05
[time]
end = 0.6
step = 1e-3
frames_per_second = 20
[transfer]
flip = 0.95
[[material]]
name = "snow"
youngs_modulus = 1.4e5
poisson_ratio = 0.2
density = 400.0
hardening = 10.0
critical_compression = 2.5e-2
critical_stretch = 7.5e-3
[[body]]
material = "snow"
shape = { type = "sphere", center = [0.0, 0.0, 1.0], radius = 0.3 }
particles_per_cell = 8
sampling = "jittered"
seed = 1
[[collider]]
shape = { type = "half-space", point = [0.0, 0.0, 0.0], normal = [0.0, 0.0, 1.0] }
friction = 0.3
"""
G = np.array([0.0, 0.0, -9.81])


def _ball(particles, seed):
    random = np.random.default_rng(seed)
    x = random.uniform(-0.3, 0.3, (4 * particles, 3))
    x = x[np.linalg.norm(x, axis=1) < 0.3][:particles]
    return x - x.mean(axis=0)


def write_trajectory(path, particles=3000, steps=600, frames=13, spare=0, scene=SCENE):
    """A ball that falls by the exact discrete law, then is flattened on the ground.

    `spare` rows of rubbish behind the valid ones imitate an interrupted file.
    """
    ball = _ball(particles, 1)
    n = len(ball)
    m = np.full(n, 400 * 0.05**3 / 8)
    dt = 1e-3
    k = np.arange(1, steps + 1)
    height = 1.0 + G[2] * dt**2 * k * (k + 1) / 2
    speed = G[2] * dt * k
    rest = 0.16
    landed = height < rest + 0.1
    height[landed], speed[landed] = rest + 0.1, 0.0

    with h5py.File(path, "w", track_order=True) as file:
        firn = file.create_group("firn")
        for name, value in {
            "format": "firn-trajectory",
            "version": 1,
            "solver": "synthetic",
            "precision": "double",
            "threads": 1,
            "firn_version": "0.1.0",
            "processor": "none",
            "scene": scene,
        }.items():
            firn.attrs[name] = value
        _write_diagnostics(
            firn.create_group("diagnostics"), m.sum(), dt, k, height, speed, landed, spare
        )

        vtk = file.create_group("VTKHDF")
        vtk.attrs["Type"] = np.bytes_("PolyData")
        vtk.attrs["Version"] = [2, 0]
        vtk["NumberOfPoints"] = np.full(frames + spare, n)
        every = np.linspace(0, steps, frames).astype(int)
        points, J_P = [], []
        for step in every:
            z = height[step - 1] if step else 1.0
            squash = min(1.0, z / 0.5)
            points.append(ball * [1 / np.sqrt(squash), 1 / np.sqrt(squash), squash] + [0, 0, z])
            J_P.append(np.clip(1 - (1 - squash) * (0.4 + ball[:, 2]), 0.6, 1.1))
        _write_frames(vtk, points, J_P, m, every * dt, spare)
    return path


def _write_diagnostics(table, mass, dt, k, height, speed, landed, spare):
    rows = len(k)
    zero = np.zeros(rows)

    def vector(z):
        return np.stack([zero, zero, z], axis=1)

    columns = {
        "time": (k * dt, "s"),
        "dt": (zero + dt, "s"),
        "mass": (zero + mass, "kg"),
        "momentum": (vector(mass * speed), "kg m/s"),
        "angular_momentum": (vector(zero), "kg m²/s"),
        "kinetic_energy": (0.5 * mass * speed**2, "J"),
        "elastic_energy": (np.where(landed, 3.0, 0.0), "J"),
        "gravitational_energy": (-mass * G[2] * height, "J"),
        "center_of_mass": (vector(height), "m"),
        "max_speed": (np.abs(speed), "m/s"),
        "min_J_E": (np.where(landed, 0.95, 1.0), "1"),
        "max_J_E": (np.where(landed, 1.01, 1.0), "1"),
        "grid_nodes": (zero + 4000, "1"),
        "solver_iterations": (zero, "1"),
    }
    table.attrs["rows"] = rows
    for name, (values, units) in columns.items():
        rubbish = np.full((spare, *values.shape[1:]), -12345.0)
        table[name] = np.concatenate([values, rubbish])
        table[name].attrs["units"] = units


def _write_frames(vtk, points, J_P, m, times, spare):
    n, frames = len(m), len(points)
    rubbish = np.full((spare * n, 3), np.nan)
    vtk["Points"] = np.concatenate([*points, rubbish])
    data = vtk.create_group("PointData")
    total = frames + spare
    F_P = np.concatenate(
        [np.cbrt(j)[:, None] * np.eye(3).ravel() for j in J_P] + [np.zeros((spare * n, 9))]
    )
    for name, values in {
        "velocity": np.zeros((total * n, 3)),
        "mass": np.tile(m, total),
        "volume": np.full(total * n, 0.05**3 / 8),
        "F_E": np.tile(np.eye(3).ravel(), (total * n, 1)),
        "F_P": F_P,
        "id": np.tile(np.arange(n), total),
        "material": np.zeros(total * n, np.int32),
    }.items():
        data[name] = values
    steps = vtk.create_group("Steps")
    steps.attrs["NSteps"] = frames
    steps["Values"] = np.concatenate([times, np.full(spare, -1.0)])
    steps["PointOffsets"] = np.arange(total) * n
    steps["PartOffsets"] = np.arange(total)


def check(verdict="VALID"):
    """What `firn check --json` prints, for two fields of one stage."""

    def field(name, bounds):
        return {
            "from": "rasterize",
            "through": "rasterize",
            "written_by": "rasterize",
            "field": name,
            "units": "kg",
            "compared": 812,
            "non_finite": 0,
            "largest_absolute": 1e-17,
            "rms_absolute": 1e-18,
            "largest_relative": 2e-16,
            "rms_relative": 1e-16,
            "largest_in_bounds": bounds,
            "rms_in_bounds": bounds / 5,
            "verdict": "VALID" if bounds <= 1 else "INVALID",
            "worst": {
                "step": 3,
                "node": [1, 2, 3],
                "index": 17,
                "component": 0,
                "reference": 0.5,
                "subject": 0.5,
                "bound": 1e-16,
            },
        }

    worst = 0.2 if verdict == "VALID" else 40.0
    return {
        "scene": "synthetic",
        "reference": "reference",
        "subject": "other",
        "precision": "double",
        "mode": "lockstep",
        "start_step": 0,
        "steps": 5,
        "particles": 3000,
        "compared": 1624,
        "largest_in_bounds": worst,
        "verdict": verdict,
        "first_divergence": None
        if verdict == "VALID"
        else {
            "step": 3,
            "from": "rasterize",
            "through": "rasterize",
            "field": "node_velocity",
            "message": "node (1, 2, 3) diverges in rasterize",
        },
        "fields": [field("node_mass", 0.1), field("node_velocity", worst)],
        "properties": [{"name": "momentum", "compared": 5, "verdict": "VALID", "detail": "exact"}],
    }


def _case(suite, name, parameters, quantities, status="measured", slow=1.0, seed=0):
    return {
        "suite": suite,
        "name": name,
        "parameters": parameters,
        "quantities": quantities,
        "status": status,
        "slow": slow,
        "seed": seed,
    }


def _solver(solver, precision, threads=1, **more):
    return {"solver": solver, "precision": precision, "threads": threads, **more}


def _timing(value, units="ns", better="lower"):
    return (value, units, better, True)


def _computed(value, better="lower"):
    return (value, "1", better, False)


def _implicit_cases():
    """Twice the cost of an explicit second at r = 10, half of it at 50; errors grow with r."""
    cases = []
    block = {"youngs_modulus": 1e6, "particles": 4096}
    for r, ratio in ((10, 2.0), (50, 0.5)):
        cases.append(
            _case(
                "implicit",
                f"cost,optimized,double,1T,E=1e+06,r={r},cells=8",
                _solver("optimized", "double", r=r, **block),
                {
                    "iterations 1e-3": _computed(3.0 * r),
                    "iterations 1e-6": _computed(6.0 * r),
                    "implicit over explicit": _timing(ratio, "1"),
                },
            )
        )
    for r, error, time in ((0.5, 0.01, 2.0), (1, 0.02, 1.0), (5, 0.08, 0.6)):
        cases.append(
            _case(
                "implicit",
                f"error,optimized,double,1T,E=1e+06,r={r}",
                _solver("optimized", "double", r=r, tolerance=0 if r <= 1 else 1e-3, **block),
                {"error": _computed(error), "time": (time, "s", "lower", False)},
            )
        )
    return cases


def _stability_cases():
    cases = []
    tried = {"stable": _computed(1.0, "neither"), "unstable": _computed(20.0, "neither")}
    point = {"hardening": 10, "J_P": 1, "h": 0.05}
    for value in (0, 0.5, 1):
        cases.append(
            _case(
                "stability",
                f"reference,alpha={value}",
                _solver("reference", "double", varied="alpha", value=value, **point),
                {
                    "cfl": _computed(1.5, "neither"),
                    "predicted_cfl": _computed(1.48, "neither"),
                    **tried,
                },
            )
        )
    for value in (0.1, 0.5, 1):
        cases.append(
            _case(
                "stability",
                f"optimized,beta={value}",
                _solver("optimized", "double", varied="beta", value=value, **point),
                {
                    "cfl": _computed(16 if value >= 0.5 else 2, "neither"),
                    "predicted_cfl": _computed(16 if value >= 0.5 else 2.1, "neither"),
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
            _case(
                "stability",
                f"optimized,{varied}={value}",
                _solver("optimized", "double", varied=varied, value=value, **point),
                {
                    "cfl": _computed(cfl, "neither"),
                    "predicted_cfl": _computed(cfl, "neither"),
                    "step": (1e-3, "s", "neither", False),
                    **tried,
                },
            )
        )
    return cases


def synthetic_cases():
    """A few cases of every suite, with medians that are known."""
    cases = []
    for precision, peak in (("float", 1e11), ("double", 5e10)):
        for threads in (1, 2):
            cases.append(
                _case(
                    "roofline",
                    f"fma_{precision},{threads}T",
                    {"probe": f"fma_{precision}", "threads": threads},
                    {"rate": _timing(peak * threads, "flop/s", "higher")},
                )
            )
    cases.append(
        _case(
            "roofline",
            "triad,1T",
            {"probe": "triad", "threads": 1},
            {"rate": _timing(1e10, "B/s", "higher")},
        )
    )
    for solver, precision, base in (("reference", "double", 2000.0), ("optimized", "float", 100.0)):
        for deformation, factor in (("elastic", 0.7), ("plastic", 1.0)):
            for particles in (100000, 1000000):
                for threads in (1, 2) if solver == "optimized" else (1,):
                    time = base * factor / threads
                    cases.append(
                        _case(
                            "steps",
                            f"{solver},{precision},{threads}T,{deformation},{particles}",
                            _solver(
                                solver,
                                precision,
                                threads,
                                deformation=deformation,
                                particles=particles,
                            ),
                            {
                                "time": _timing(time),
                                "rate": _timing(1e9 / time, "particle-steps/s", "higher"),
                            },
                        )
                    )
            cases.append(
                _case(
                    "stages",
                    f"{solver},{precision},1T,{deformation},100000",
                    _solver(solver, precision, deformation=deformation, particles=100000),
                    {
                        "whole step": _timing(base),
                        "rasterize": _timing(base / 2),
                        "deformation": _timing(base / 2),
                    },
                )
            )
        for policy, rate in (("1", 2), ("0", 1)):
            for n in (16, 32, 64):
                cases.append(
                    _case(
                        "accuracy",
                        f"standing wave,{solver},n={n},alpha={policy}",
                        _solver(
                            solver,
                            precision,
                            problem="standing wave",
                            cells=n,
                            h=1 / n,
                            cfl=0.4,
                            alpha_policy=policy,
                        ),
                        {
                            "error": _computed((16 / n) ** rate * 0.1),
                            "time": _timing(base * n**2 * 1e-6, "s"),
                        },
                    )
                )
        for n in (16, 32):
            # Stable beyond the explicit limit, and less accurate than it is fast.
            cases.append(
                _case(
                    "accuracy",
                    f"standing wave,{solver},n={n},cfl=8,alpha=1,implicit 0.5",
                    _solver(
                        solver,
                        precision,
                        problem="standing wave",
                        cells=n,
                        h=1 / n,
                        cfl=8,
                        alpha_policy="1",
                        integration="implicit 0.5",
                    ),
                    {
                        "error": _computed((16 / n) ** 2 * 0.5),
                        "time": _timing(base * n**2 * 4e-7, "s"),
                    },
                )
            )
        cases.append(
            _case(
                "float",
                f"drift,{solver},{precision}",
                _solver(solver, precision, test="drift", what="drift"),
                {"error": _computed(1e-5)}
                | {f"error after {k} steps": _computed(1e-7 * k) for k in (10, 30, 100)},
            )
        )
        for situation, expected, outcome in (
            ("a lone particle", "goes on", "20 steps, all finite"),
            ("F_E is not a number", "stops", "stopped: stage 3 (grid_forces), particle 3"),
        ):
            cases.append(
                _case(
                    "stress",
                    f"{situation},{solver},{precision}",
                    _solver(
                        solver, precision, situation=situation, expected=expected, outcome=outcome
                    ),
                    {},
                )
            )
        cases.append(
            _case(
                "float",
                f"creep,{solver},{precision}",
                _solver(solver, precision, test="creep", what="1e-8 m per step"),
                {"error": _computed(1e-6)},
            )
        )
    cases.append(
        _case(
            "speedup",
            "optimized,float,1T,plastic,100000",
            _solver("optimized", "float", deformation="plastic", particles=100000),
            {"speedup": _timing(20.0, "1", "higher")},
        )
    )

    def ratio(value, better="higher"):
        return _timing(value, "1", better)

    for name, quantities in (
        (
            "2T,plastic,1000000",
            {
                "efficiency": ratio(0.8),
                "efficiency of independent copies": ratio(0.9, "neither"),
                "efficiency over that of copies": ratio(0.8 / 0.9),
            },
        ),
        ("1T,plastic,4000000", {"growth": ratio(1.2, "lower")}),
    ):
        threads, deformation, particles = name.split(",")
        cases.append(
            _case(
                "scaling",
                f"optimized,float,{name}",
                _solver(
                    "optimized",
                    "float",
                    int(threads[0]),
                    deformation=deformation,
                    particles=int(particles),
                ),
                quantities,
            )
        )
    cases += _implicit_cases() + _stability_cases()
    cases.append(
        _case(
            "skips",
            "box,elastic",
            _solver("optimized", "float", skip="box", situation="elastic"),
            {"saved": _computed(0.3, "higher")},
        )
    )
    cases.append(
        _case(
            "skips",
            "box,plastic",
            _solver("optimized", "float", skip="box", situation="plastic"),
            {"saved": _computed(-0.03, "higher")},
        )
    )
    cases.append(
        _case(
            "targets",
            "avx2,float",
            _solver("optimized", "float", target="avx2", deformation="plastic"),
            {
                "time": _timing(100.0),
                "FMA peak, factored count": _computed(0.5, "higher"),
                "FMA peak, plain count": _computed(0.6, "higher"),
            },
        )
    )
    for resolution in (4, 6):
        cases.append(
            _case(
                "snowball",
                f"optimized,float,resolution={resolution}",
                _solver("optimized", "float", resolution=resolution),
                {"J_P": _computed(0.95, "neither")},
            )
        )
    cases.append(
        _case(
            "kernels",
            "svd,Eigen",
            {"kernel": "SVD", "code": "Eigen", "precision": "double"},
            {"time": _timing(800.0)},
        )
    )
    cases.append(
        _case(
            "kernels",
            "svd,optimized",
            {"kernel": "SVD", "code": "optimized", "precision": "double", "target": "avx2"},
            {"time": _timing(20.0)},
        )
    )
    return cases


def write_results(path, slow=(), status=(), noise=0.01, verify="VALID", cases=None):
    """Results whose medians are known. `slow`: {case name: factor on its times};
    `status`: {case name: status}; `noise`: relative half-width of the repetitions."""
    slow, status = dict(slow), dict(status)
    text = h5py.string_dtype()
    with h5py.File(path, "w") as file:
        file.attrs.update({"format": "firn-results", "version": 1.0, "firn_version": "0.1.0"})
        file.create_group("sessions/0").attrs.update(
            {
                "processor": "synthetic",
                "processors": 2.0,
                "git_commit": "abc",
                "started": "2026-01-01T00:00:00Z",
            }
        )
        for i, case in enumerate(synthetic_cases() if cases is None else cases):
            group = file.create_group(f"cases/{case['suite']}/{case['name']}")
            state = status.get(case["name"], case["status"])
            group.attrs.update(
                {
                    "title": case["name"],
                    "command": f"firn bench '{case['suite']}/{case['name']}'",
                    "status": state,
                    "message": "" if state == "measured" else f"made {state}",
                    "validation": "synthetic",
                    "session": 0.0,
                    "wall_seconds": 1.5,
                    "processor_seconds": 1.25,
                }
            )
            group.create_group("parameters").attrs.update(
                {
                    k: float(v) if isinstance(v, (int, float)) else v
                    for k, v in case["parameters"].items()
                }
            )
            group.create_group("quantities")
            for name, (median, units, better, timed) in (
                {} if state in ("invalid", "failed") else case["quantities"]
            ).items():
                factor = slow.get(case["name"], 1.0) if timed else 1.0
                value = median * factor if better == "lower" else median / factor
                values = value * (1 + noise * np.linspace(-1, 1, 9)) if timed else [value]
                data = group.create_dataset(f"quantities/{name}", data=values)
                data.attrs.update(
                    {"units": units, "meaning": name, "better": better, "timed": float(timed)}
                )
            group["calibration"] = 2e-3 * (1 + 0.02 * np.random.default_rng(i).standard_normal(6))
        if verify:
            group = file.create_group("verify/optimized, float")
            group.attrs.update(
                {"verdict": verify, "command": "firn verify --solver optimized", "session": 0.0}
            )
            errors = [0.3, 0.01, 0.7 if verify == "VALID" else 12.0]
            columns = {
                "topic": ["kernel", "kernel", "conservation"],
                "check": ["sum of weights", "gradients", "momentum"],
                "verdict": ["VALID" if e <= 1 else "INVALID" for e in errors],
                "command": ["firn verify --filter x"] * 3,
            }
            for name, values in columns.items():
                group.create_dataset(name, data=values, dtype=text)
            group["error"] = errors
            mutants = file.create_group("mutants")
            mutants.attrs["command"] = "firn verify --mutants"
            for name, values in {
                "name": ["sign", "transpose"],
                "patch": ["f", "F"],
                "stage": ["grid_forces"] * 2,
                "named_stage": ["grid_forces"] * 2,
                "caught_by": ["momentum"] * 2,
            }.items():
                mutants.create_dataset(name, data=values, dtype=text)
            mutants["caught"] = [1.0, 1.0]
    return path
