# SPDX-License-Identifier: BSD-3-Clause
"""Reading results, comparing them with a baseline, and the page that tells of them."""

from pathlib import Path

import h5py
import numpy as np
import pytest

from firn_reports import (
    accuracy,
    accuracy_tables,
    baseline,
    case_tables,
    float_accuracy,
    highlights,
    implicit,
    kernel_figures,
    readme_table,
    results,
    results_page,
    results_summary,
    results_tables,
    roofline,
    speed_figures,
)
from firn_reports.__main__ import main
from firn_reports.page import Page

import synthetic

PLASTIC = "optimized,float,1T,plastic,100000"


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    return tmp_path_factory.mktemp("results")


@pytest.fixture(scope="module")
def plain(folder):
    return results.read(synthetic.write_results(folder / "plain.h5"))


def test_every_repetition_and_every_fact_is_read(plain):
    case = plain.find("steps", PLASTIC)
    assert len(case.quantities["time"].values) == 9
    assert case.value("time") == pytest.approx(100)
    assert case["threads"] == 1
    assert case["deformation"] == "plastic"
    assert case.command.startswith("firn bench ")
    assert plain.verify["optimized, float"]["rows"][2] == {
        "topic": "conservation",
        "check": "momentum",
        "error": 0.7,
        "verdict": "VALID",
        "command": "firn verify --filter x",
    }
    assert len(plain.mutants["rows"]) == 2
    assert plain.sessions[0]["processor"] == "synthetic"


def test_what_is_noisy_or_invalid_is_never_quoted(folder):
    r = results.read(synthetic.write_results(folder / "noisy.h5", status={PLASTIC: "noisy"}))
    assert r.find("steps", PLASTIC).value("time") is None
    table = results_tables.of_suite(r, "steps", "speed", "")[0]
    row = next(
        row for row in table.rows if "made" not in row and row[-1].text.endswith(f"{PLASTIC}'")
    )
    assert row[table.columns.index("time [ns]")] is None
    assert str(row[-2]) == "noisy"
    assert all(c.name != PLASTIC for c, *_ in roofline.roofline_points(r))


def test_the_same_run_is_neither_slower_nor_faster(plain):
    kinds = {c.kind for c in baseline.compare(plain, plain)}
    assert kinds == {"same"}


@pytest.mark.parametrize(("factor", "kind"), [(1.3, "worse"), (0.7, "better"), (1.05, "same")])
def test_a_slow_down_beyond_the_threshold_is_found(folder, plain, factor, kind):
    new = results.read(synthetic.write_results(folder / "new.h5", slow={PLASTIC: factor}))
    changes = {(c.case.suite, c.case.name, c.quantity): c for c in baseline.compare(new, plain)}
    assert changes["steps", PLASTIC, "time"].kind == kind
    assert changes["speedup", PLASTIC, "speedup"].kind == kind
    assert changes["steps", PLASTIC, "time"].ratio == pytest.approx(factor)
    others = {c.kind for (suite, name, _), c in changes.items() if name != PLASTIC}
    assert others == {"same"}


def test_noise_hides_a_change_that_it_could_have_made(folder, plain):
    # Half-width 60 %: quartiles ±30 %, 3 standard errors of the median ± 56 %.
    new = results.read(synthetic.write_results(folder / "wide.h5", slow={PLASTIC: 1.3}, noise=0.6))
    change = next(
        c
        for c in baseline.compare(new, plain)
        if c.case.name == PLASTIC and c.case.suite == "steps" and c.quantity == "time"
    )
    assert change.uncertainty == pytest.approx(3 * 1.25 * 0.6 / 1.35 / 3, rel=0.02)
    assert change.kind == "same"


def test_a_slow_minute_of_the_machine_is_not_the_solver_s_fault(folder, plain):
    path = synthetic.write_results(folder / "minute.h5", slow={PLASTIC: 1.3})
    with h5py.File(path, "a") as file:
        file[f"cases/steps/{PLASTIC}/calibration"][...] *= 1.4
    changes = {
        (c.case.suite, c.case.name, c.quantity): c
        for c in baseline.compare(results.read(path), plain)
    }
    assert changes["steps", PLASTIC, "time"].kind == "same"
    # A ratio of interleaved runs has no such excuse, and stands for its case alone.
    assert changes["speedup", PLASTIC, "speedup"].kind == "worse"
    assert ("speedup", PLASTIC, "time") not in changes


@pytest.mark.parametrize(("factor", "exit_status"), [(1.3, 1), (1.0, 0), (0.7, 0)])
def test_exit_status_against_a_baseline(folder, tmp_path, plain, capsys, factor, exit_status):
    new = synthetic.write_results(folder / "exit.h5", slow={PLASTIC: factor})
    assert main([str(new), "--baseline", str(plain.path), "-o", str(tmp_path)]) == exit_status
    html = (tmp_path / "index.html").read_text()
    assert ("SLOWER" in html) == bool(exit_status)
    assert "Against the baseline" in html
    assert (
        main([str(new), "--baseline", str(plain.path), "--threshold", "0.5", "-o", str(tmp_path)])
        == 0
    )


def test_a_case_that_no_longer_works_fails_the_comparison(folder, tmp_path, plain):
    new = synthetic.write_results(folder / "broken.h5", status={PLASTIC: "invalid"})
    assert main([str(new), "--baseline", str(plain.path), "-o", str(tmp_path)]) == 1


def verdict_of(path):
    r = results.read(path)
    page = Page("")
    results_summary.set_verdict(page, r, None, [], [])
    return page.verdict.text


def test_the_verdict_needs_every_check_and_every_case(folder):
    assert verdict_of(synthetic.write_results(folder / "v.h5")) == "VALID"
    assert verdict_of(synthetic.write_results(folder / "v.h5", verify="INVALID")) == "INVALID"
    assert (
        verdict_of(synthetic.write_results(folder / "v.h5", status={PLASTIC: "failed"}))
        == "INVALID"
    )
    path = synthetic.write_results(folder / "v.h5")
    with h5py.File(path, "a") as file:
        file["mutants/caught"][1] = 0
    assert verdict_of(path) == "INVALID"


def test_orders_and_pareto_front(plain):
    order, where = accuracy_tables.best_order(results.read(plain.path)) or (None, "")
    assert order == pytest.approx(2.0)
    assert "16 to 64" in where
    assert "reference" in where
    assert accuracy.pareto([(1, 5), (2, 6), (3, 1), (0.5, 9), (4, 1)]) == [3, 0, 2]


def test_time_to_an_error_is_the_fastest_run_that_is_accurate_enough(plain):
    table = accuracy_tables.time_to_error(plain)[0]
    rows = [dict(zip(table.columns, row, strict=True)) for row in table.rows]
    mine = {row["method"]: row for row in rows if row["error asked for"] == 0.03}
    # α = 1 reaches 0.025 with 32 cells, α = 0 only with 64; float is 20 times faster.
    explicit = mine["optimized, float"]
    assert explicit["cells"] == 32
    assert explicit["α"] == "1"
    assert explicit["wall time [s]"] == pytest.approx(100 * 32**2 * 1e-6)
    assert explicit["times the fastest"] == 1
    assert mine["reference, double"]["times the fastest"] == pytest.approx(20)
    # The implicit runs reach no more than 0.125.
    assert not any("implicit" in name for name in mine)
    assert any("implicit" in row["method"] for row in rows) is False


def test_what_happened_under_stress_stands_beside_what_was_expected(folder):
    broken = "F_E is not a number,optimized,float"
    r = results.read(synthetic.write_results(folder / "stress.h5", status={broken: "invalid"}))
    table = float_accuracy.stress_table(r)[0]
    assert table.columns[:4] == ["situation", "expected", "reference, double", "optimized, float"]
    row = next(row for row in table.rows if row[0] == "F_E is not a number")
    assert row[1] == "stops"
    assert row[3].kind == "bad"
    assert str(row[2]).startswith("stopped")


def test_the_table_for_the_readme_quotes_what_the_page_quotes(plain, folder, capsys):
    text = readme_table.text(plain)
    assert "| optimized, float, plastic | 1 000 000 | 10 M/s | 20 M/s (2 T) | 20× | – |" in text
    assert "| verification of optimized, float | VALID, 3 checks |" in text
    assert "| wrong solvers caught | 2 of 2 |" in text
    assert (
        "| share of the FMA peak of AVX2, optimized, 100 000 particles, what the factored step needs | 50 % |"
        in text
    )
    assert (
        "| share of the FMA peak of AVX2, optimized, 100 000 particles, what a plain step needs | 60 % |"
        in text
    )
    assert "| efficiency of 2 threads; of as many independent copies | 0.8; 0.9 |" in text
    assert "Measured 2026-01-01 on synthetic" in text
    assert main([str(plain.path), "--readme-table"]) == 0
    assert capsys.readouterr().out.strip() == text.strip()
    noisy = results.read(
        synthetic.write_results(
            folder / "n.h5", status={"optimized,float,1T,plastic,1000000": "noisy"}
        )
    )
    assert "| optimized, float, plastic | 100 000 |" in readme_table.text(noisy)


def test_an_unfinished_run_and_a_changed_environment_are_pointed_out(folder):
    path = synthetic.write_results(folder / "unfinished.h5")
    with h5py.File(path, "a") as file:
        file["sessions/0"].attrs["cases_asked_for"] = 500.0
        file["sessions/0"].attrs["environment"] = "FIRN_NO_SKIP=all"
    texts = [text for text, _ in results_page.build(results.read(path))[0].look_at]
    assert any("of 500 cases" in text for text in texts)
    assert any("FIRN_NO_SKIP=all" in text for text in texts)


def test_a_busy_machine_is_pointed_out_for_timings_only(folder):
    path = synthetic.write_results(folder / "busy.h5")
    with h5py.File(path, "a") as file:
        file.create_group("sessions/1").attrs.update(
            {"processors": 2.0, "load_average": "3.47 (1 min)"}
        )  # a verification
    assert highlights.busiest(results.read(path)) is None
    with h5py.File(path, "a") as file:
        file["sessions/1"].attrs["cases_asked_for"] = 5.0
    assert highlights.busiest(results.read(path)) == (3.47, 2)


def test_share_of_the_peak_is_the_plain_count_over_the_probe(plain):
    share, _ = roofline.best_share_of_peak(plain)
    # The fastest: 70 ns per particle-step, against 1e11 flop/s.
    assert share == pytest.approx(64 * 64 / 70e-9 / 1e11)


def test_the_report_and_the_benchmarks_have_one_plain_count():
    header = Path(__file__).parents[2] / "bench" / "needed_work.hpp"
    assert f"static_assert(plain_flop == {roofline.PLAIN_FLOP});" in header.read_text()


def test_both_counts_of_the_share_of_the_peak_are_shown_and_named(plain, monkeypatch):
    drawn = {}
    monkeypatch.setattr(
        kernel_figures,
        "bars",
        lambda rows, xlabel, **more: drawn.update({xlabel: rows[0][1]}) or "",
    )
    titles = [figure.title for figure in kernel_figures.targets(plain)]
    assert drawn == {
        "ns": pytest.approx(100),
        "% of its FMA peak, factored count": pytest.approx(50),
        "% of its FMA peak, plain count": pytest.approx(60),
    }
    assert titles[1].endswith("factored count")
    assert titles[2].endswith("plain count")


def test_scaling_growth_and_costly_skips_are_pointed_out(plain):
    assert highlights.worst_scaling(plain)[0] == pytest.approx(1.6)
    assert highlights.size_growth(plain)[0] == pytest.approx(1.2)
    assert highlights.costliest_skip(plain)[1:] == ("box", "plastic")


def test_the_share_of_the_peak_is_read_under_its_older_name(folder):
    cases = synthetic.synthetic_cases()
    for case in cases:
        if case["suite"] == "targets":
            case["quantities"]["FMA peak"] = case["quantities"].pop("FMA peak, factored count")
            del case["quantities"]["FMA peak, plain count"]
    old = results.read(synthetic.write_results(folder / "older_name.h5", cases=cases))
    assert (
        "| share of the FMA peak of AVX2, optimized, 100 000 particles, what the factored step needs | 50 % |"
        in readme_table.text(old)
    )
    assert [figure.title for figure in kernel_figures.targets(old)][1:] == [
        "Share of each instruction set's own peak, factored count"
    ]


def test_what_threads_bring_stands_beside_what_independent_copies_bring(plain, folder, monkeypatch):
    texts = [text for text, _ in results_page.build(plain)[0].look_at]
    assert any(
        text.startswith("2 threads bring 1.6× at worst")
        and text.endswith("; as many independent copies brought 1.8×")
        for text in texts
    )
    drawn = {}
    monkeypatch.setattr(
        speed_figures,
        "bars",
        lambda rows, xlabel, **more: drawn.update({xlabel: (rows, more)}) or "",
    )
    figure = speed_figures.scaling(plain)[0]
    rows, more = drawn["times one thread"]
    assert [row[1] for row in rows] == pytest.approx([1.6])
    assert more["ticks"] == pytest.approx([1.8])
    assert "share nothing" in figure.caption
    # A file from before the copies were measured gives the figure without them.
    cases = synthetic.synthetic_cases()
    for case in cases:
        case["quantities"].pop("efficiency of independent copies", None)
    old = results.read(synthetic.write_results(folder / "no_copies.h5", cases=cases))
    assert "share nothing" not in speed_figures.scaling(old)[0].caption
    assert drawn["times one thread"][1]["ticks"] == [None]
    assert "| efficiency of 2 threads | 0.8 |" in readme_table.text(old)


def test_semi_implicit_steps_are_told_with_the_explicit_ones_beside_them(plain):
    table = implicit.tables(plain)[0]
    rows = [dict(zip(table.columns, row, strict=True)) for row in table.rows]
    fastest = {
        row["error asked for"]: (row["method"], row["wall time [s]"])
        for row in rows
        if row["times the fastest"] == 1
    }
    assert fastest == {
        0.1: ("optimized, double, implicit", 0.6),
        0.05: ("optimized, double, explicit", 1.0),
        0.03: ("optimized, double, explicit", 1.0),
        0.02: ("optimized, double, explicit", 1.0),
        0.01: ("optimized, double, explicit", 2.0),
    }
    assert [f.title for f in implicit.figures(plain)] == [
        "Cost of a simulated second, optimized, double",
        "Iterations per step",
        "Landing block, E = 1e6 Pa: run time against error",
    ]


def test_what_is_too_noisy_is_named_where_it_is_missing(folder):
    r = results.read(
        synthetic.write_results(folder / "named.h5", status={"svd,optimized": "noisy"})
    )
    figure = kernel_figures.kernels(r)[0]
    assert "Too noisy to quote: optimized, double, avx2" in figure.caption
    assert [row[1] for row in case_tables.noisy(r)[0].rows] == ["svd,optimized"]


def test_every_number_of_the_summary_and_every_figure_has_its_command(plain):
    page, _ = results_page.build(plain)
    assert all(tile.command.startswith("firn ") for tile in page.tiles)
    figures = [f for section in page.sections for f in section.figures]
    assert len(figures) > 20
    assert [f.title for f in figures if not f.command.startswith("firn ")] == []
    assert [t.title for section in page.sections for t in section.tables if not t.command] == []


def test_every_table_has_its_csv(folder, tmp_path):
    path = synthetic.write_results(folder / "csv.h5")
    assert main([str(path), "-o", str(tmp_path)]) == 0
    names = {p.stem for p in (tmp_path / "csv").iterdir()}
    assert {
        "speed",
        "scaling",
        "implicit_cost",
        "implicit_error",
        "accuracy",
        "orders",
        "time_to_error",
        "stress",
        "stability",
        "skips",
        "verify_1",
        "mutants",
        "repetitions",
        "cases",
    } <= names
    rows = (tmp_path / "csv" / "repetitions.csv").read_text().splitlines()
    expected = sum(len(q.values) for c in results.read(path).cases for q in c.quantities.values())
    assert len(rows) == 1 + expected


def test_a_file_with_a_verification_alone_and_an_empty_one_give_pages(folder, tmp_path):
    assert (
        main(
            [
                str(synthetic.write_results(folder / "verify.h5", cases=[])),
                "-o",
                str(tmp_path / "a"),
            ]
        )
        == 0
    )
    assert "3 checks passed" in (tmp_path / "a" / "index.html").read_text()
    assert (
        main(
            [
                str(synthetic.write_results(folder / "empty.h5", cases=[], verify="")),
                "-o",
                str(tmp_path / "b"),
            ]
        )
        == 0
    )


def test_a_damaged_results_file_gets_one_line_and_exit_2(folder, tmp_path, capsys):
    path = synthetic.write_results(folder / "damaged.h5")
    with h5py.File(path, "a") as file:
        del file[f"cases/steps/{PLASTIC}"].attrs["status"]
    assert main([str(path), "-o", str(tmp_path / "x")]) == 2
    assert capsys.readouterr().err.count("\n") == 1
    assert not (tmp_path / "x").exists()


def test_median_error_of_normal_repetitions():
    random = np.random.default_rng(1)
    samples = 100 + random.standard_normal((2000, 25))
    estimated = np.mean([baseline.median_error(s) for s in samples]) * 100
    actual = np.std(np.median(samples, axis=1))
    assert estimated == pytest.approx(actual, rel=0.1)
