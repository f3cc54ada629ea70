"""The page of a results file: the summary first, then what each suite found."""

from . import accuracy
from . import baseline as comparison
from . import limits
from . import results_figures as figures
from . import results_tables as tables
from .page import Mark, Page, Section, Tile, number

INTRO = {
    "speed": "Wall time of whole steps: medians of all repetitions, bars from the first to the third quartile. "
             "Every solver took one step beside the reference before it was timed. In the elastic block no particle yields, in the plastic one every particle does in every step.",
    "roofline": "What this machine can do at best, probed in the same run, and how near the steps come. "
                "The arithmetic is counted as a plain cubic-spline step needs it, so that a cleverer factorization can only look better than it is by this count.",
    "stages": "Where a step spends its time. Stages that a solver runs as one are named together.",
    "accuracy": "Error against exact solutions, and what it costs in time. A convergence plot of a FLIP blend depends on how α is chosen: the policy is named in each line. "
                "`rate` means 1 − α ∝ Δt, a fixed damping per time. “implicit β” is the semi-implicit step, solved to 1e-6.",
    "stability": "The largest stable step found by bisection, in units of h/c with the hardened sound speed c; dashed: predicted from the plane-wave recurrence, or for a lone particle.",
    "snowball": "A plastic impact has no formal order of convergence. What can be said are bands over seeds of the sampling.",
    "skips": "Share of a step that each skip saves, with and without it taking turns. Below zero it costs.",
    "targets": "The same code on every instruction set that this processor has.",
    "float": "What single precision costs, beside double: errors that are zero in exact arithmetic.",
    "kernels": "Single kernels, each validated before it was timed, on every instruction set of this processor, beside what libraries offer. P2G to “positions” are stages of a block that stays in the cache; "
               "the optimized solver scatters mass, momentum and forces in one pass, which its row “P2G, mass and momentum” holds, and makes its weights inside it.",
}


def build(results, old=None, threshold=comparison.THRESHOLD, command=""):
    changes = comparison.compare(results, old, threshold) if old else []
    broken = comparison.appeared_broken(results, old) if old else []
    machine = results.sessions[0] if results.sessions else {}
    page = Page(title="Speed, accuracy and stability", command=command)
    page.subtitle = (f"{machine.get('processor', 'unknown processor')}, {machine.get('processors', '?')} processors, "
                     f"{machine.get('instruction_set', '?')}; commit {machine.get('git_commit', '?')}, {str(machine.get('started', ''))[:10]}")
    page.sections = [section for section in [
        baseline_section(results, old, changes, broken, threshold) if old else None,
        verification_section(results), speed_section(results), roofline_section(results), stages_section(results),
        accuracy_section(results), snowball_section(results), stability_section(results), stress_section(results), skips_section(results), targets_section(results),
        float_section(results), kernels_section(results), noise_section(results), facts_section(results)] if section]
    page.sections = [section for section in page.sections if not section.empty()]
    present = {section.id for section in page.sections}
    set_verdict(page, results, old, changes, broken)
    page.tiles = [tile for tile in tiles(results, old, changes) if not tile.target or tile.target in present]
    page.look_at = [(text, target) for text, target in look_at(results, changes, broken) if target in present]
    return page, failed(changes, broken)


def failed(changes, broken):
    """True if something became worse than the threshold allows, or broke."""
    return bool(broken) or any(change.kind == "worse" for change in changes)


def set_verdict(page, results, old, changes, broken):
    bad_subjects = [s for s, v in results.verify.items() if v["verdict"] != "VALID"]
    invalid = [c for c in results.cases if c.status in ("invalid", "failed")]
    survived = [m for m in results.mutants.get("rows", []) if not m["caught"]]
    worse = [c for c in changes if c.kind == "worse"]
    problems = []
    if bad_subjects:
        problems.append(f"{', '.join(bad_subjects)} failed the verification")
    if invalid:
        problems.append(f"{len(invalid)} of {len(results.cases)} cases gave wrong results or failed")
    if survived:
        problems.append(f"{len(survived)} mutants were not caught")
    if worse or broken:
        problems.append(f"{len(worse) + len(broken)} figures are worse than the baseline")
    if problems:
        page.verdict, page.sentence = Mark("INVALID" if bad_subjects or invalid or survived else "SLOWER", "bad"), "; ".join(problems)
    elif results.verify:
        checks = sum(len(v["rows"]) for v in results.verify.values())
        page.verdict, page.sentence = Mark("VALID", "good"), f"{number(checks)} checks passed; every timed case was validated first"
    else:
        page.verdict = Mark("VALID", "good")
        page.sentence = f"none of {number(len(results.cases))} cases gave a wrong result" if results.cases else "nothing was measured"
    if old and not (worse or broken):
        page.sentence += "; nothing is slower than the baseline beyond the noise"


def best(cases, quantity):
    quoted = [c for c in cases if c.value(quantity) is not None]
    return max(quoted, key=lambda c: c.value(quantity), default=None)


def tiles(results, old, changes):
    result = []
    for deformation in ("plastic", "elastic"):
        fastest = best([c for c in results.suite("steps") if c["deformation"] == deformation and c["threads"] == 1], "rate")
        if fastest:
            result.append(Tile(f"Fastest {deformation}, 1 thread", f"{number(fastest.value('rate') / 1e6, 3)} M/s",
                               f"particle-steps; {fastest['solver']}, {fastest['precision']}, {number(fastest['particles'])}", target="speed"))
    most = best([c for c in results.suite("speedup") if c["threads"] == 1 and c["deformation"] == "plastic"], "speedup")
    if most:
        result.append(Tile("Against the reference", f"{number(most.value('speedup'), 3)}×", f"{most['solver']}, {most['precision']}, plastic, 1 thread, interleaved", target="speed"))
    share = figures.best_share_of_peak(results)
    if share:
        result.append(Tile("Of the FMA peak", f"{number(100 * share[0], 2)} %", f"whole step by the plain count, {share[1]}", target="roofline"))
    order = accuracy.best_order(results)
    if order:
        result.append(Tile("Observed order", number(order[0], 3), order[1], target="accuracy"))
    worst = tables.worst_stability(results)
    if worst:
        result.append(Tile("Stability limits", f"{number(100 * worst[0], 2)} %", f"largest distance from prediction, {worst[1]}",
                           "good" if worst[0] <= 0.03 else "warn", "stability"))
    for subject, verdict in results.verify.items():
        error = max((row["error"] for row in verdict["rows"]), default=0)
        result.append(Tile(f"Verification: {subject}", verdict["verdict"], f"{len(verdict['rows'])} checks, largest error {number(float(error), 2)} of its bound",
                           "good" if verdict["verdict"] == "VALID" else "bad", "verification"))
    if results.mutants:
        rows = results.mutants["rows"]
        caught = sum(bool(row["caught"]) for row in rows)
        result.append(Tile("Mutants caught", f"{caught}/{len(rows)}", "deliberately wrong solvers", "good" if caught == len(rows) else "bad", "verification"))
    if old:
        worse, better = (sum(c.kind == k for c in changes) for k in ("worse", "better"))
        result.append(Tile("Against the baseline", f"{worse} worse", f"{better} better, {len(changes)} compared", "bad" if worse else "good", "baseline"))
    noise = tables.noise(results)
    if noise is not None:
        noisy = sum(c.status == "noisy" for c in results.cases)
        result.append(Tile("Noise", f"{100 * noise:.2g} %" if noise < 1 else f"{100 * noise:.0f} %", f"of the fixed loop; {noisy} of {len(results.cases)} cases too noisy to quote", "warn" if noisy else "", "noise"))
    return result


def shortened(text, most=130):
    return text if len(text) <= most else text[:most].rsplit(" ", 1)[0] + " …"


def look_at(results, changes, broken):
    """The few things that deserve a reader's minute."""
    found = []
    asked = max((int(s.get("cases_asked_for", 0)) for s in results.sessions), default=0)
    if asked > len(results.cases):
        found.append((f"An unfinished run: {len(results.cases)} of {asked} cases. firn bench on the same file completes it", "facts"))
    changed = sorted({str(s["environment"]) for s in results.sessions if s.get("environment", "none") != "none"})
    if changed:
        found.append((f"Measured with {', '.join(changed)} in the environment", "facts"))
    busy = tables.busiest(results)
    if busy:
        found.append((f"The machine was busy: load {number(busy[0], 3)} on {busy[1]} processors. Ratios of interleaved runs hold, absolute times do not", "noise"))
    for case in broken[:3]:
        found.append((f"{case.suite}/{case.name} no longer works: {case.message}", "baseline"))
    for change in sorted((c for c in changes if c.kind == "worse"), key=lambda c: -c.ratio)[:3]:
        found.append((f"{change.case.suite}/{change.case.name}: {change.quantity} is {number(100 * (change.ratio - 1), 3)} % worse", "baseline"))
    for case in [c for c in results.cases if c.status in ("invalid", "failed")][:3]:
        found.append((shortened(f"{case.suite}/{case.name}: {case.status}: {case.message}"), "facts"))
    scaling = tables.worst_scaling(results)
    if scaling and scaling[0] < 1.8:
        found.append((f"Two threads bring {number(scaling[0], 3)}× at worst ({scaling[1]})", "speed"))
    growth = tables.size_growth(results)
    if growth and growth[0] > 1.15:
        found.append((f"Cost per particle grows {number(growth[0], 3)}× from the smallest to the largest block ({growth[1]})", "speed"))
    costly = tables.costliest_skip(results)
    if costly:
        found.append((f"The skip `{costly[1]}` costs {number(100 * costly[0], 2)} % in the situation “{costly[2]}”", "skips"))
    stuck = tables.worst_float(results)
    if stuck:
        found.append((f"Largest loss to single precision: {stuck[1]}, {number(stuck[0], 2)}", "float"))
    return found[:6]


def baseline_section(results, old, changes, broken, threshold):
    section = Section("baseline", "Against the baseline",
                      f"Compared with {old.path.name}, commit {old.sessions[0].get('git_commit', '?') if old.sessions else '?'}. Worse means: beyond {number(100 * threshold, 2)} % "
                      f"and beyond three standard errors of both medians; for times also beyond what the fixed loop changed by around that case. The machine's fixed loop took {number(comparison.machine_ratio(results, old), 3)} times as long as then.")
    section.figures = figures.changes(changes)
    section.tables = tables.changes(changes, broken)
    return section


def verification_section(results):
    section = Section("verification", "Verification")
    section.figures = figures.verification(results)
    section.tables = tables.verification(results) + tables.mutants(results)
    return section


def speed_section(results):
    section = Section("speed", "Speed", INTRO["speed"])
    section.figures = figures.speed(results)
    section.tables = tables.of_suite(results, "steps", "speed", "Whole steps") + tables.of_suite(results, "speedup", "speedup", "Against the reference")
    return with_intro_only_if_filled(section)


def roofline_section(results):
    section = Section("roofline", "Roofline", INTRO["roofline"])
    section.figures = figures.roofline(results)
    section.tables = tables.of_suite(results, "roofline", "roofline", "Machine probes") + tables.roofline_points(results)
    return with_intro_only_if_filled(section)


def simple(identifier, title, suite, make_figures, table_title):
    def build_section(results):
        section = Section(identifier, title, INTRO[suite])
        section.figures = make_figures(results)
        section.tables = tables.of_suite(results, suite, suite, table_title)
        return with_intro_only_if_filled(section)
    return build_section


def with_intro_only_if_filled(section):
    if not (section.figures or section.tables):
        section.intro = ""
    return section


stages_section = simple("stages", "Stage by stage", "stages", figures.stages, "Time per stage")
stability_section = simple("stability", "Stability", "stability", limits.stability, "Stable steps")
snowball_section = simple("snowball", "Plastic snowball over seeds", "snowball", figures.snowball, "Five seeds each")
skips_section = simple("skips", "What each skip saves", "skips", figures.skips, "Skips")
targets_section = simple("targets", "Instruction sets", "targets", figures.targets, "Instruction sets")
float_section = simple("float", "Accuracy of float", "float", limits.float_accuracy, "Float against double")
kernels_section = simple("kernels", "Kernels", "kernels", figures.kernels, "Kernels")


def accuracy_section(results):
    section = Section("accuracy", "Run time against error", INTRO["accuracy"])
    section.figures = accuracy.figures(results)
    section.tables = accuracy.time_to_error(results) + accuracy.order_table(results) + tables.of_suite(results, "accuracy", "accuracy", "Errors and times")
    return with_intro_only_if_filled(section)


def stress_section(results):
    return Section("stress", "Under stress", tables=limits.stress_table(results))


def noise_section(results):
    section = Section("noise", "Noise of this machine")
    section.figures = figures.noise(results)
    if section.figures:
        section.intro = ("A fixed loop of a million dependent multiply-adds ran three times before and after each case. "
                         "Whatever it varies by, the machine did.")
    return section


def facts_section(results):
    section = Section("facts", "Machine, build and log")
    section.tables = [tables.sessions(results), tables.all_cases(results), tables.repetitions(results)]
    lines = [f"{c.suite}/{c.name}: {c.status}" + (f": {c.message}" if c.message else "") + f"\n    {c.validation}" for c in results.cases]
    section.logs = [("Validation and remarks, case by case", "\n".join(lines))] if lines else []
    return section
