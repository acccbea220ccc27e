"""The benchmarks themselves: their stances, their peers' answers, their tables. No time is asserted."""

from dataclasses import replace

import numpy as np
import pytest
from benchmarks import distributions, effort, figure, kernel, own, peers, questions, tables, targets
from benchmarks.curves import Curve, Sharing
from benchmarks.peers import bare_clarabel, cvxpy_again
from benchmarks.peers.klampt_polygon import area_within
from benchmarks.suite import FAMILIES, GROWING, MASS, SUITE, eight_points, growth
from benchmarks.timing import Clock, Measured, PeerFailed, Trial, Way, interleaved

from socp_statics import check_equilibrium, trace_support_region

TINY = effort.Effort(
    stances=tuple(s for s in SUITE if s.name in ("flat_feet", "tilted_tripod")),
    eight=tuple(s for s in SUITE if s.name == "stones"),
    torque_problems=("hoap2/half_squat_2",),
    repetitions=1,
    seconds=0.05,
    directions=6,
    coms=4,
    forces=1,
    growth_points=(3, 8),
    growth_coms=2,
    copies=1,
    peers=False,
)


def sizes():
    return [len(s.point_contacts()[0]) for s in SUITE]


def test_the_suite_has_every_family_and_number_of_points():
    assert len(SUITE) >= 24
    assert len({s.name for s in SUITE}) == len(SUITE)
    assert {s.family for s in SUITE} == set(FAMILIES)
    assert min(sizes()) == 3
    assert max(sizes()) == 64
    assert len(eight_points()) >= 8
    assert {s.family for s in eight_points()} == set(FAMILIES)
    hands = [len([c for c in s.contacts().names if "hand" in c]) for s in SUITE if s.family == "hands"]
    assert {1, 2} <= set(hands)


def test_contacts_are_made_afresh():
    for stance in SUITE[:3]:
        first, second = stance.contacts(), stance.contacts()
        assert first is not second
        assert all(a is not b for a, b in zip(first, second, strict=True))
        np.testing.assert_array_equal(first.points_W, second.points_W)


@pytest.mark.parametrize("stance", SUITE, ids=lambda s: s.name)
def test_verdicts_are_decided_both_ways(stance):
    contacts = stance.contacts()
    verdicts = {check_equilibrium(contacts, com, MASS, engine="clarabel").verdict for com in stance.coms()}
    assert verdicts == {"stable", "unstable"}
    np.testing.assert_array_equal(stance.coms(20)[:8], stance.coms())


@pytest.mark.parametrize("stance", SUITE[::4], ids=lambda s: s.name)
def test_regions_are_polygons(stance):
    assert trace_support_region(stance.contacts(), 1e-2, engine="clarabel").kind == "polygon"


def test_the_growing_soles_keep_their_region():
    regions = [trace_support_region(growth("soles", n).contacts(), 1e-3, engine="clarabel") for n in (8, 24)]
    assert regions[0].inner_area == pytest.approx(regions[1].inner_area, rel=1e-6)
    assert all(len(growth(family, 33).point_contacts()[0]) == 33 for family in GROWING)


@pytest.mark.parametrize("kind", ("region", "direction", "verdict", "minimax"))
def test_solvers_on_the_declared_programs_give_the_exact_answer(kind):
    cases = {
        "region": lambda: questions.region_cases(TINY.stances[1:]),
        "direction": lambda: questions.direction_cases(TINY.eight, 4),
        "verdict": lambda: questions.verdict_cases(TINY.eight, 4),
        "minimax": lambda: questions.minimax_cases(TINY.eight, 1),
    }[kind]()
    (case,) = cases
    for way in bare_clarabel.ways(kind) + cvxpy_again.ways(kind):
        trial = way.ready(case)
        answer = trial.answer(trial.run(trial.fresh()))
        if kind == "region":
            assert 1 - 1e-3 <= answer / case.exact_area <= 1 + 1e-5
        elif kind == "direction":
            np.testing.assert_allclose(answer, case.exact_heights, atol=1e-6)
        elif kind == "verdict":
            np.testing.assert_array_equal(answer[0], case.exact_verdicts[0])
            np.testing.assert_allclose(answer[1], case.exact_verdicts[1], atol=1e-4)
        else:
            np.testing.assert_allclose(answer, case.exact_forces, rtol=1e-6)


def test_a_run_without_peers_prints_every_section(tmp_path):
    lines = []
    result = kernel.survey(TINY, write=lines.append)
    text = "\n".join(lines)
    for title in ("exact support region", "one support direction", "verdict, margin and forces", "least possible largest force",
                  "torque-limited support region", "family 'soles'", "family 'oval'", "threads over a batch", "targets"):  # fmt: skip
        assert title in text
    assert "2 stances of 3 to 8 points" in text
    assert text.count("Clarabel compiled (") >= 5
    assert "0 of 4 verdicts differ" in text
    assert "Klampt polygon, 4 sides: nothing measured" in text or own.kernel_missing()
    record = result["record"]
    assert set(record["questions"]) == {"region", "direction", "verdict", "minimax", "torque"}
    assert len(record["targets"]) == len(targets.TARGETS) + 5
    if own.kernel_missing():
        assert "skipped  kernel: kernel: no such engine is registered" in text
    figure.draw(result["curves"][0], Sharing(4, {1: 2.0, 2: 1.0}), tmp_path / "growth.png")
    assert (tmp_path / "growth.png").stat().st_size > 10_000


def test_missing_peers_are_named(monkeypatch):
    monkeypatch.setattr(peers, "find_spec", lambda name: None)
    named = {w.missing for kind in ("region", "direction", "verdict") for w in peers.all_ways(kind)} - {None}
    assert named == {f"{name}: not installed (pip install socp-statics[peers])"
                     for name in ("klampt", "hpp-centroidal-dynamics", "moreau", "highspy")}  # fmt: skip
    (way, *_) = (w for w in peers.all_ways("region") if "Klampt" in w.name)
    lines = tables.question_table("title", [Measured(way)], lambda m: "")
    assert "skipped  Klampt polygon, 4 sides: klampt: not installed (pip install socp-statics[peers])" in lines


def test_area_of_half_planes():
    square = [[1.0, 0.0, 1.0], [-1.0, 0.0, 0.0], [0.0, 1.0, 1.0], [0.0, -1.0, 0.0], [1.0, 1.0, 1.5]]
    assert area_within(square, np.zeros(2), 10.0) == pytest.approx(0.875)
    assert area_within([], np.zeros(2), 1.0) == pytest.approx(4.0)
    assert area_within([[0.0, 0.0, -1.0]], np.zeros(2), 1.0) == 0.0


def test_exponents_are_fitted_from_eight_points_on():
    curve = Curve("region", "soles", Way("kernel", "", "", lambda _: Trial(lambda _: None)), [3, 8, 64, 512], [9.0, 0.8, 6.4, 51.2])
    assert curve.exponent == pytest.approx(1.0)
    assert targets.growth_judged([curve])[0].verdict == "reached"
    steep = replace(curve, seconds=[9.0, 0.8, 16.0, 320.0])
    assert targets.growth_judged([steep])[0].verdict == "missed"


def test_targets_compare_medians_case_by_case():
    def measured(name, times):
        return Measured(Way(name, "solver", "cone", lambda _: Trial(lambda _: None)), {str(k): [t] for k, t in enumerate(times)})

    target = targets.Target("region", "peer", 0.2, "<= 0.20")
    own_times, peer = measured("kernel", [1.0, 2.0, 9.0]), measured("peer", [10.0, 10.0, 10.0])
    reached = targets.judged(target, [own_times, peer])
    assert (reached.value, reached.worst, reached.verdict) == ("0.20", "0.90", "reached")
    assert "kernel (solver, cone) / peer (solver, cone)" in reached.what
    assert targets.judged(target, [own_times]).verdict == "skipped: peer: nothing measured"
    assert targets.judged(replace(target, over=None, most=1e-6), [own_times]).verdict == "missed"


def test_ways_that_fail_say_where():
    def ready(case):
        if case.name == "flat_feet":
            raise PeerFailed("no answer")
        return Trial(lambda argument: argument, fresh=lambda: 7, count=2)

    cases = questions.region_cases(TINY.stances)
    missing = Way("other", "", "", ready, missing="not there")
    found, other = interleaved([Way("one", "", "", ready), missing], cases, 3, 1.0, Clock())
    assert found.failures == {"flat_feet": "no answer"}
    assert found.answers == {"tilted_tripod": 7}
    assert len(found.times["tilted_tripod"]) == 3
    assert not other.times


def test_the_benchmark_of_distributions_has_every_contact_set():
    found = distributions.rows(postures=40, repetitions=1)
    assert [name for name, *_ in found] == list(distributions.contact_sets())
    assert all(methods >= 4 and balance < 1e-12 for _, methods, _, _, balance in found)
