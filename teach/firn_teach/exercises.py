# SPDX-License-Identifier: BSD-3-Clause
"""Planted bugs, and parameters to play with. What the answers measure is run by measured.py."""

import itertools
from collections.abc import Iterable

from firn_reports.kinds import Json

from . import STAGES
from .lesson import Lesson

# Mutant -> what the learner is asked and told. Mistake, origin and stage come from the mutant.
BUGS = {
    "gravity_divided_by_mass": (
        "Which stage is wrong? How does the error depend on the mass of the node?",
        "Compare the error at a light node with that at a heavy one: multiply each by the node's mass.",
        "The error times m_i is Δt g (1 − m_i), nearly the same for every node: something that should not be divided by the mass was. Forces are; an acceleration is not.",
    ),
    "limits_swapped": (
        "The particles that yield are not the ones you expect. What has become of the elastic range?",
        "Look for the largest and the smallest singular value that a particle has after the stage, and compare them with θ_c and θ_s.",
        "The range is [1 − θ_s, 1 + θ_c]: snow is crushed early and tears late, the opposite of snow. Nothing is out of proportion, so a picture would not tell.",
    ),
    "last_particle_forgotten": (
        "Almost all nodes are right. What have the wrong ones in common?",
        "Sum the missing mass over all nodes. Then look which particle is near all of the nodes that are off.",
        "The missing mass is that of one particle, the last in the list. An off-by-one in a loop shows as a hole of 64 nodes.",
    ),
    "flip_from_v_star": (
        "The grid is right, the particles are too sluggish to follow it. What did they receive?",
        "In an explicit step v_i^{n+1} and v_i* are the same array. What is a difference of the two?",
        "v_FLIP needs the change since the beginning of the step, v_i^{n+1} − v_i^n. With v_i* in place of v_i^n the increment vanishes, and with α near 1 forces hardly reach the particles.",
    ),
    "hardening_by_J_E": (
        "The force is too soft in some places and too hard in others, and right where the snow never moved. Which factor is off?",
        "Take a particle that never yielded: J_P = 1, so its hardening must be exactly 1. Is it?",
        "Hardening remembers: it depends on the volume change that has become permanent. With J_E every elastic compression stiffens the snow at once and forgets it again.",
    ),
    "friction_by_whole_speed": (
        "Which nodes are affected, and which nodes in contact are not?",
        "Sort the nodes in contact into those that stuck, those that slide with a small normal velocity, and those that slide with a large one.",
        "Dividing by ‖v_rel‖, which is larger than ‖v_t‖, makes friction too weak, most where the impact is steep. Where the node moves along the surface the two are the same.",
    ),
    "moved_with_the_grid": (
        "All stages up to the ninth agree to the last digit, and yet the positions differ. With which velocity were the particles moved?",
        "Divide the displacement by Δt and compare it with v_p and with v_PIC.",
        "The displacement is Δt v_PIC. Many codes do that on purpose; it is not this method.",
    ),
    "growth_on_the_wrong_side": (
        "The error is small and vanishes for particles that have not deformed yet. Which property of matrices do you think of?",
        "For F_E = I the result is right. What is A B − B A?",
        "F̂_E = F_E (I + Δt ∇v): the factors were exchanged. They commute while F_E is close to a multiple of I, so tests with fresh snow pass.",
    ),
    "known_volumes_recomputed": (
        "The stage that does nothing does something. Compare the particle's volume with the one of the first step.",
        "Is the wrong volume larger or smaller where snow is compressed?",
        "The volume is estimated anew in every step. Compressed snow then counts its compressed volume as the natural one and pushes back less.",
    ),
    "pressure_without_J": (
        "Forces are off by up to a few per cent. The error is largest where the snow is most compressed, and it has no preferred direction.",
        "Only one term of the stress is a multiple of I. By which factor is it off?",
        "λ(J_E − 1) I was used for λ(J_E − 1) J_E I. Near J_E = 1 one can hardly see it; the factor J_E is the difference between Kirchhoff and Cauchy stress.",
    ),
    "delta_R_dropped": (
        "Explicit scenes are all right; only the semi-implicit one is not. Does the solver find a solution, and of which system?",
        "The residual of the solver's own system is small. Which term of A_p vanishes when nothing rotates?",
        "The Hessian lacks −2μ δR. It is still symmetric and positive, so the solve converges nicely, to the solution of another problem: rotations meet a stiffness that they should not have.",
    ),
    "sigma_for_its_inverse": (
        "F_E is right and F_P is not. Check the invariant F_E F_P = F^{n+1}.",
        "Compare det F_P before and after for a particle that was compressed: in which direction should it go?",
        "F_P = V Σ Uᵀ F instead of V Σ⁻¹ Uᵀ F. What was clamped off F_E is taken away a second time instead of being handed on.",
    ),
}


def check_command(number: int, scene: str) -> str:
    """The check that finds the planted bug."""
    if scene == "tiny_impact":
        return f"firn check tiny_impact --start-step 75 --steps 1 --solver exercise:{number}"
    return f"firn check {scene} --start-step 12 --steps 1 --solver exercise:{number}"


def bugs(lesson: Lesson) -> list[Json]:
    """One dictionary per exercise; `measured` fills in what the check says."""
    result = []
    for number, exercise in enumerate(lesson.data["exercises"], 1):
        question, hint, answer = BUGS[exercise["mutant"]]
        result.append(
            {
                "command": check_command(number, exercise["scene"]),
                "verify": f"firn verify --solver exercise:{number} --fail-fast",
                "question": question,
                "hint": hint,
                "answer": answer,
                **exercise,
                "page": f"{STAGES.index(exercise['stage']) + 1:02d}_{exercise['stage']}.html",
            }
        )
    return result


def scene_command(edit: str, options: str = "") -> str:
    """Edits tiny_impact by a sed script and runs it."""
    return f"firn scenes --show tiny_impact | sed '{edit}' > mine.toml && firn run mine.toml {options}--json".replace(
        "  ", " "
    )


def simple(key: str, value: str, options: str = "") -> str:
    """Runs tiny_impact with another value of a key."""
    return scene_command(f"s/^{key} = .*/{key} = {value}/", options)


def semi_implicit(beta: str, dt: str = "3e-3") -> str:
    """Runs tiny_impact with semi-implicit steps of length `dt` [s]."""
    edit = (
        f"s/^step = .*/step = {dt}/; "
        f's/^type = "explicit"/type = "semi-implicit"\\nimplicitness = {beta}\\ntolerance = 1e-6\\nmax_iterations = 500/'
    )
    return scene_command(edit, "--solver reference ")


# What of the JSON summary goes into a table: column, how to get it.
HEIGHT = ("height of the centre of mass [m]", lambda r: r["diagnostics"]["center_of_mass"][2])
KINETIC = ("kinetic energy [J]", lambda r: r["diagnostics"]["kinetic_energy"])
ELASTIC = ("elastic energy [J]", lambda r: r["diagnostics"]["elastic_energy"])
SPEED = ("fastest particle [m/s]", lambda r: r["diagnostics"]["max_speed"])
NODES = ("grid nodes", lambda r: r["diagnostics"]["grid_nodes"])
STATUS = ("run", lambda r: r["status"])
ITERATIONS = ("iterations of the last solve", lambda r: r["diagnostics"]["solver_iterations"])

PARAMETERS: list[Json] = [
    {
        "id": "alpha",
        "title": "α, the share of FLIP",
        "name": "α",
        "values": ["0.0", "0.5", "0.95", "1.0"],
        "command": lambda a: simple("flip", a),
        "columns": [SPEED, KINETIC, NODES],
        "question": "The scene has α = 0.99. What becomes of the fragments at α = 0, at 0.5, and at 1? Which of these runs occupies the most grid nodes, and why?",
        "hint": "PIC averages neighbouring velocities in every step. What does it take for two neighbouring particles to separate?",
        "answer": "Up to α = 0.95 the fastest particle stays below 1 m/s: the transfers smooth relative motion away before a crack can open, and the ball remains one piece. At 1 nothing is smoothed; single particles fly off, and the snow is spread over more nodes. The damping goes by steps, not by seconds, so the same α damps more at half the Δt.",
    },
    {
        "id": "xi",
        "title": "ξ, hardening",
        "name": "ξ",
        "values": ["0.0", "5.0", "10.0", "20.0"],
        "command": lambda a: simple("hardening", a),
        "columns": [HEIGHT, KINETIC, SPEED],
        "question": "Does the ball end higher or lower when hardening is stronger? What does it do without any?",
        "hint": "At the impact the lower half is compressed for good, J_P &lt; 1. What does that do to its stiffness, and what does a stiff lower half do to the rest?",
        "answer": "Higher. Without hardening compressed snow goes on yielding at the same stress and the ball spreads on the ground like dough. With ξ = 20 the compressed part becomes hard quickly; it stops compressing and bounces.",
    },
    {
        "id": "theta-c",
        "title": "θ<sub>c</sub>, critical compression",
        "name": "θ_c",
        "values": ["1e-2", "2.5e-2", "5e-2", "1e-1"],
        "command": lambda a: simple("critical_compression", a),
        "columns": [KINETIC, ELASTIC, SPEED],
        "question": "At which θ<sub>c</sub> does the ball dissipate most of its 31 J, and at which does it rebound and burst?",
        "hint": "Elastic energy comes back, plastic work does not. How much elastic energy can a particle hold before it yields?",
        "answer": "With θ<sub>c</sub> = 0.01 the snow yields at once: it packs and keeps hardly any motion. The energy that a particle can store grows with the square of θ<sub>c</sub>; at 0.1 so much comes back that the ball bursts.",
    },
    {
        "id": "theta-s",
        "title": "θ<sub>s</sub>, critical stretch",
        "name": "θ_s",
        "values": ["1e-3", "7.5e-3", "2e-2", "5e-2"],
        "command": lambda a: simple("critical_stretch", a),
        "columns": [SPEED, ELASTIC, HEIGHT, NODES],
        "question": "Which run ends in powder and which in one piece? Which column tells most clearly?",
        "hint": "Stretched snow that yields has J_P &gt; 1, and hardening then works backwards.",
        "answer": "At θ<sub>s</sub> = 0.001 any stretch breaks the snow, and broken snow is softer: it turns to powder and hardly holds any elastic energy. From 0.02 on the ball holds together and bounces. In between lies a change of behaviour that no single number announces.",
    },
    {
        "id": "dt",
        "title": "Δt, explicit",
        "name": "Δt [s]",
        "values": ["2e-4", "1e-3", "2e-3", "3e-3"],
        "command": lambda a: simple("step", a),
        "columns": [STATUS, KINETIC, ELASTIC, SPEED],
        "question": "The sound of this snow crosses a cell in about 2 ms. At which Δt does the run end badly, and how does it look just below?",
        "hint": "Kinetic plus elastic energy starts at 31 J and can only decrease, apart from some 3 J of falling.",
        "answer": "At 3 ms energy grows without bounds and the run is stopped; the table shows the last good state. At 2 ms it runs to the end, and yet its energy is twice that of the scene's own step: a run that does not explode need not be right. Hardened snow is stiffer, so the limit becomes shorter as the run goes.",
    },
    {
        "id": "beta",
        "title": "β, implicitness",
        "name": "β",
        "values": ["0.0", "0.25", "0.5", "1.0"],
        "command": semi_implicit,
        "columns": [STATUS, KINETIC, HEIGHT, ITERATIONS],
        "question": "At Δt = 3 ms, where the explicit method fails, how much β does it take? What does more of it cost, and what does it do to the motion?",
        "hint": "β = 0 is the explicit method. β = 1 uses only the force at the end of the step, which is always a little too small.",
        "answer": "A quarter is enough here. A larger β damps: kinetic energy decreases from row to row, because each oscillation is pulled back before it happens. The solve takes more iterations, too, since the system is farther from the identity.",
    },
]


def parameter_commands() -> list[str]:
    """One command per value of each parameter."""
    return [task["command"](value) for task in PARAMETERS for value in task["values"]]


def parameters(results: Iterable[Json]) -> list[Json]:
    """The tasks with their measured tables; `results` in the order of parameter_commands()."""
    results = iter(results)
    tasks = []
    for task in PARAMETERS:
        rows = [
            [value] + [get(result) for _, get in task["columns"]]
            for value, result in zip(
                task["values"], itertools.islice(results, len(task["values"])), strict=True
            )
        ]
        tasks.append(
            {
                **task,
                "command": task["command"](task["values"][-1]),
                "columns": [task["name"]] + [name for name, _ in task["columns"]],
                "rows": rows,
            }
        )
    return tasks
