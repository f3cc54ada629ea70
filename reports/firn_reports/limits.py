"""Where it stops working: figures and tables of the suites `stability`, `stress` and `float`."""

from .page import Code, Figure, Mark, Table
from .results_figures import bars, styles, who
from .style import MUTED, legend, log_axis, panel, to_svg

# No limit was looked for beyond (bench/suite_stability.cpp).
LARGEST_TRIED = 16


def limit(case, quantity):
    """The limit, or None where none was found."""
    value = case.value(quantity)
    return value if value is not None and value < LARGEST_TRIED else None


def stability(results):
    cases = [c for c in results.suite("stability") if c.quotable]
    made = []
    solvers = sorted({c["solver"] for c in cases})
    for varied in dict.fromkeys(c["varied"] for c in cases):
        if varied == "lone particle":
            continue
        mine = [c for c in cases if c["varied"] == varied]
        figure, axes = panel()
        for solver, style in styles(solvers).items():
            line = sorted([c for c in mine if c["solver"] == solver], key=lambda c: c["value"])
            if line:
                axes.plot([c["value"] for c in line], [limit(c, "cfl") for c in line], label=solver, **style)
        predicted = sorted([c for c in mine if "predicted_cfl" in c.quantities], key=lambda c: c["value"])
        if predicted:
            axes.plot([c["value"] for c in predicted], [limit(c, "predicted_cfl") for c in predicted], color=MUTED, linestyle="--", label="predicted")
        if varied in ("E", "h") or varied.startswith("particles per cell"):
            log_axis(axes, "x")
        axes.set_ylim(0, 1.15 * max([limit(c, "cfl") for c in mine if limit(c, "cfl") is not None], default=LARGEST_TRIED))
        axes.set_xlabel(varied + {"E": " [Pa]", "h": " [m]"}.get(varied, ""))
        axes.set_ylabel("largest stable c Δt / h")
        unlimited = [c["value"] for c in mine if limit(c, "cfl") is None]
        if unlimited:
            top = axes.get_ylim()[1]
            axes.plot(unlimited, [0.96 * top] * len(unlimited), linestyle="none", marker="^", markersize=9, color=MUTED, label=f"no limit up to {LARGEST_TRIED}")
        legend(axes)
        made.append(Figure(f"Stable step over {varied}", to_svg(figure), command="firn bench stability",
                           caption="Below the line is stable." + ("" if predicted else " No prediction: the particles do not sample every wave evenly.")))
    return made


def drift(cases):
    """Error against steps of the cases that say it for several numbers of steps."""
    figure, axes = panel()
    for name, style in styles(who(c) for c in cases).items():
        case = next(c for c in cases if who(c) == name)
        points = sorted((int(q.name.split()[2]), q.median) for q in case.quantities.values() if q.name.startswith("error after"))
        axes.plot([p[0] for p in points], [max(p[1], 1e-17) for p in points], label=name, **style)
    log_axis(axes, "x")
    log_axis(axes, "y")
    axes.set_xlabel("steps")
    axes.set_ylabel("RMS velocity off the reference's")
    legend(axes)
    return Figure("Drift of a ringing elastic block", to_svg(figure), command="firn bench 'float/drift*'", caption="From the same state, left alone, against the reference in double.")


def float_accuracy(results):
    made = []
    cases = [c for c in results.suite("float") if c.quotable]
    drifting = sorted([c for c in cases if c["test"] == "drift"], key=lambda c: c.name)
    if drifting:
        made.append(drift(drifting))
    for test in dict.fromkeys(c["test"] for c in cases if c["test"] != "drift"):
        mine = sorted([c for c in cases if c["test"] == test], key=lambda c: c.name)
        rows = [(who(c), max(c.value("error"), 1e-17), max(c.value("error"), 1e-17), max(c.value("error"), 1e-17)) for c in mine]
        meaning = next(iter(mine[0].quantities.values())).meaning
        made.append(Figure(str(mine[0]["what"]), bars(rows, meaning, log=True), command="firn bench float",
                           caption="Bars that end at 1e-17 are zero. 1 would mean that nothing moved." if test in ("creep", "small strain") else "Bars that end at 1e-17 are zero."))
    return made


def stress_table(results):
    """One row per situation, one column per solver: what it did."""
    cases = results.suite("stress")
    if not cases:
        return []
    solvers = sorted({who(c) for c in cases}, reverse=True)
    rows = []
    for situation in dict.fromkeys(c["situation"] for c in cases):
        mine = {who(c): c for c in cases if c["situation"] == situation}
        any_case = next(iter(mine.values()))
        cells = []
        for solver in solvers:
            case = mine.get(solver)
            text = str(case["outcome"] or case.message) if case else "–"
            cells.append(Mark(text, "bad") if case and case.status != "measured" else text)
        rows.append([situation, any_case["expected"], *cells, Code(f"firn bench 'stress/{situation}*'")])
    return [Table("stress", "Under stress: what each solver did", ["situation", "expected", *solvers, "measure again"], rows,
                  "Twenty steps of a few particles. “goes on”: every number stays finite and momentum holds to roundoff; “stops”: the step fails and says where. "
                  "Going on with a number that is not finite is never right.", "firn bench stress", open=True)]
