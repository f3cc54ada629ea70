# SPDX-License-Identifier: BSD-3-Clause
"""The page of one trajectory: what happened, and whether the laws that must hold did."""

from collections.abc import Sequence

import numpy as np

from . import check as checks_json, snowball
from .check import Check
from .kinds import Array, Mask
from .laws import Laws
from .page import Figure, Mark, Page, Section, Tile, number
from .style import MUTED, legend, log_axis, panel, to_svg
from .trajectory import Trajectory
from .trajectory_tables import AXES, diagnostics_table, fact_table


def series(
    trajectory: Trajectory,
    names: Sequence[str | Array],
    ylabel: str,
    title: str,
    caption: str = "",
    labels: Sequence[str | None] | None = None,
    log: bool = False,
    flight: Mask | None = None,
) -> Figure:
    """A quantity over time. `names`: of diagnostics, or arrays with one value per step.

    `flight`: True for the steps in free flight; a dotted line marks their end.
    """
    figure, axes = panel()
    t = trajectory.diagnostics["time"]
    for label, name in zip(
        labels or [n if isinstance(n, str) else None for n in names], names, strict=True
    ):
        values = trajectory.diagnostics[name] if isinstance(name, str) else name
        axes.plot(t, np.maximum(values, 1e-18) if log else values, label=label)
    if flight is not None and flight.any() and not flight.all():
        axes.axvline(t[flight][-1], color=MUTED, linestyle=":", linewidth=1)
    if log:
        log_axis(axes, "y")
    axes.set_xlabel("time [s]")
    axes.set_ylabel(ylabel)
    if len(names) > 1:
        legend(axes)
    return Figure(title, to_svg(figure), caption=caption)


def chosen_frames(trajectory: Trajectory, laws: Laws) -> list[int]:
    """First, last, and one amid what happens: halfway from the end of free flight to the end."""
    count = len(trajectory.times)
    if count < 3:
        return list(range(count))
    t = trajectory.diagnostics["time"]
    start = t[laws.free][-1] if laws.free.any() and not laws.free.all() else trajectory.times[0]
    middle = start + 0.3 * (trajectory.times[-1] - start)
    return [0, int(np.clip(np.argmin(abs(trajectory.times - middle)), 1, count - 2)), count - 1]


def build(trajectory: Trajectory, checks: list[Check], command: str = "") -> tuple[Page, bytes]:
    """The page, and the picture of the snow as PNG."""
    first = trajectory.frame(0)
    laws = Laws(trajectory, first)
    facts = trajectory.facts
    frames = [trajectory.frame(i) for i in chosen_frames(trajectory, laws)]
    png = snowball.picture(trajectory.scene, frames)
    run = run_command(trajectory)

    page = Page(title=trajectory.scene.get("name", trajectory.path.stem), command=command)
    page.subtitle = (
        f"{number(trajectory.particles)} particles, {number(trajectory.steps)} steps, "
        f"solver {facts.get('solver', '?')} in {facts.get('precision', '?')}"
    )
    page.hero = Figure(
        "The snow at three moments",
        png=png,
        command=run,
        caption=(
            "Particles at three moments, coloured by J_P = det F_P: blue where the snow is permanently compacted, "
            "amber where it was pulled apart, white where it is unchanged."
        ),
    )
    set_verdict(page, checks)
    page.tiles = tiles(trajectory, laws, checks)
    page.sections = [physics(trajectory, laws, run)]
    if checks:
        page.sections.append(checks_json.section(checks))
    page.sections.append(
        Section(
            "facts",
            "Facts",
            tables=[fact_table(trajectory, run), diagnostics_table(trajectory, run)],
        )
    )
    return page, png


def set_verdict(page: Page, checks: list[Check]) -> None:
    """Sets the verdict of the checks and the sentence beside it."""
    if not checks:
        page.verdict, page.sentence = (
            Mark("not checked", "warn"),
            "Give --check with the output of `firn check --json`.",
        )
        return
    bad = [c for c in checks if c["verdict"] != "VALID"]
    page.verdict = checks_json.worst_mark(checks)
    page.sentence = "; ".join(checks_json.sentence(c) for c in (bad or checks))


def run_command(trajectory: Trajectory) -> str:
    """What simulates the trajectory again."""
    facts = trajectory.facts
    if facts.get("command"):
        return facts["command"]
    scene = facts.get("scene_source", str(trajectory.scene.get("name", "SCENE")).replace(" ", "_"))
    return (
        f"firn run {scene} --solver {facts.get('solver', '?')} --precision {facts.get('precision', '?')} "
        f"--threads {facts.get('threads', '1')} -o {trajectory.path.name}"
    )


def tiles(trajectory: Trajectory, laws: Laws, checks: list[Check]) -> list[Tile]:
    """The numbers at the top of the page."""
    d = trajectory.diagnostics
    energy = d["kinetic_energy"] + d["elastic_energy"] + d["gravitational_energy"]
    result = [
        Tile(
            "Simulated",
            f"{number(float(trajectory.times[-1]))} s",
            f"{number(trajectory.steps)} steps",
            target="facts",
        ),
        Tile(
            "Fastest particle",
            f"{number(float(d['max_speed'].max()), 3)} m/s",
            f"at t = {number(float(d['time'][d['max_speed'].argmax()]), 3)} s",
            target="physics",
        ),
        Tile(
            "Elastic volume change",
            f"{number(float(d['min_J_E'].min()), 4)} … {number(float(d['max_J_E'].max()), 4)}",
            "det F_E over the whole run",
            target="physics",
        ),
    ]
    if laws.free.any():
        worst_p, worst_x = laws.momentum_error[laws.free].max(), laws.center_error[laws.free].max()
        eps = 2.0**-23 if trajectory.facts.get("precision") == "float" else 2.0**-52
        # Roundoff of a sum over n steps, each exact to a few eps: n·eps, and never below 100 eps.
        limit = max(trajectory.steps, 100) * eps * 10
        result += [
            Tile(
                "Momentum in free flight",
                number(float(worst_p), 2),
                "largest relative distance from p0 + M g t",
                "good" if worst_p < limit else "bad",
                "physics",
            ),
            Tile(
                "Centre of mass in free flight",
                number(float(worst_x), 2),
                "largest relative distance from the closed form",
                "good" if worst_x < limit else "bad",
                "physics",
            ),
        ]
    result.append(
        Tile(
            "Energy left",
            f"{number(float(100 * energy[-1] / energy[0]), 3)} %" if energy[0] else "–",
            "kinetic + elastic + gravitational, of the first step",
            target="physics",
        )
    )
    return result


def physics(trajectory: Trajectory, laws: Laws, run: str) -> Section:
    """Energies, momentum and other quantities over time."""
    d = trajectory.diagnostics
    total = d["kinetic_energy"] + d["elastic_energy"] + d["gravitational_energy"]
    free = laws.free if laws.known else None
    figures = [
        series(
            trajectory,
            ["kinetic_energy", "elastic_energy", "gravitational_energy", total],
            "energy [J]",
            "Energies",
            "The total decreases by plastic work, friction, contact and the damping of the PIC part.",
            ["kinetic", "elastic", "gravitational", "total"],
            flight=free,
        ),
        series(
            trajectory,
            [laws.momentum_error],
            "|p − (p0 + M g t)| / |p|",
            "Momentum against its law",
            "Until a collider is in reach (dotted line), gravity is the only external force and only roundoff may show; "
            "after that the ground pushes back.",
            log=True,
            flight=free,
        ),
        series(
            trajectory,
            [laws.center_error],
            "distance / size",
            "Centre of mass against free fall",
            "X0 + Σ Δt (V0 + g t): exact for the discrete scheme whatever happens inside the body, until contact (dotted).",
            log=True,
            flight=free,
        ),
        series(
            trajectory,
            list(d["center_of_mass"].T),
            "position [m]",
            "Centre of mass",
            labels=list(AXES),
            flight=free,
        ),
        series(trajectory, ["max_speed"], "max |v_p| [m/s]", "Fastest particle", flight=free),
        series(
            trajectory,
            ["min_J_E", "max_J_E"],
            "J_E",
            "Range of det F_E",
            "The elastic volume ratio stays between (1 − θ_c)³ and (1 + θ_s)³.",
            ["smallest", "largest"],
            flight=free,
        ),
        series(trajectory, ["dt"], "Δt [s]", "Time step", flight=free),
        series(
            trajectory, ["grid_nodes"], "nodes of positive mass", "Active grid nodes", flight=free
        ),
        series(
            trajectory,
            list(d["angular_momentum"].T),
            "L [kg m²/s]",
            "Angular momentum about the origin",
            labels=list(AXES),
            flight=free,
        ),
    ]
    if d["solver_iterations"].any():
        figures.append(
            series(
                trajectory,
                ["solver_iterations"],
                "iterations",
                "Iterations of the semi-implicit solve",
            )
        )
    return Section(
        "physics", "What happened, and the laws that must hold", figures=figures, command=run
    )
