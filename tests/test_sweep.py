"""A small seeded part of the correctness sweep, and whether its checks notice what they are there for."""

import json
import subprocess
import sys
from collections import Counter
from pathlib import Path

import numpy as np
import pytest
from oracles import linear_stance
from oracles import margin as whole_margin
from rechecks import force_violations, motion_power
from sweeps.checks import check_case
from sweeps.independent_checks import force_faults, motions
from sweeps.layout import layout
from sweeps.outcome import CHECKS, Outcome
from sweeps.planted import PLANTED
from sweeps.population import WEIGHTS, Case, population, stance_of
from sweeps.pyramid_programs import largest_reserve, pyramid_program
from sweeps.region_checks import check_region, outside
from sweeps.summary import Summary
from sweeps.verdict_checks import EXACT, bracket, check_certificate, check_verdict

from socp_statics.regions import trace_support_region
from socp_statics.stability import check_equilibrium
from socp_statics.statics import assemble, point_forces

STANCES, SEED = 100, 8
# What the checks notice does not depend on the engine; this one needs no compilation.
ENGINE = "clarabel"
COMMAND = Path(__file__).parent / "sweeps" / "verdicts.py"


def test_a_small_sweep_holds():
    summary = Summary("in the tests", 256)
    for case in population(STANCES, SEED):
        summary.add(check_case(case, "auto"))
    assert summary.violations == []
    assert not summary.lopsided
    assert all(summary.counts[check] for check in CHECKS if check != "idle")
    assert set(summary.families) == set(WEIGHTS)


def test_the_population_is_as_wide_as_it_says():
    cases = population(400, 3)
    assert cases == population(400, 3)
    stances = [(case, stance_of(case)) for case in cases]
    again = stance_of(cases[7])
    assert [c.statement() for c in again.contacts] == [c.statement() for c in stances[7][1].contacts]
    sizes = [s.contacts.size for _, s in stances if len(s.contacts.points_W) > 1]
    assert min(sizes) == pytest.approx(0.01, rel=0.1)
    assert max(sizes) == pytest.approx(100.0, rel=0.1)
    assert max(np.linalg.norm(s.contacts.centre) for _, s in stances) > 900
    masses = [s.mass for _, s in stances]
    assert min(masses) < 2e-3
    assert max(masses) > 5e5
    frictions = [c.friction for _, s in stances for c in s.contacts]
    assert min(frictions) == 0.0
    assert max(frictions) == 2.0
    assert {len(s.contacts) for _, s in stances} >= {1, 2, 3, 4, 8, 16}
    plain = [s for _, s in stances if all(c.type in ("point", "surface") for c in s.contacts)]
    assert len(plain) >= 0.9 * len(stances)
    assert sum(bool(s.external_wrenches) for _, s in stances) >= 0.03 * len(stances)
    assert sum(case.family == "planted" for case in cases) <= 0.05 * len(stances)


def test_planted_stances_are_degenerate_or_all_but():
    def ask(plant):
        return {check_equilibrium(plant(np.random.default_rng(k)), engine=ENGINE).verdict for k in range(3)}

    verdicts = {plant.__name__: ask(plant) for plant in PLANTED}
    assert sum("undecided" in found for found in verdicts.values()) >= 8, verdicts


@pytest.mark.parametrize("kind", ["inscribed", "circumscribed"])
def test_programs_of_growing_rays_are_the_whole_programs(kind):
    compared = Counter()
    for case in population(60, 2):
        stance = stance_of(case)
        if case.family == "planted" or len(stance.contacts.points_W) > 24:
            continue
        numbers = layout(stance)
        found = largest_reserve(*pyramid_program(stance, numbers, kind, 48))
        whole = whole_margin(linear_stance(stance, kind, 48)) / numbers.W
        # Far away, positions in world axes are what the whole programs round.
        assert found.value == whole or found.value == pytest.approx(whole, abs=1e-7 * max(1.0, abs(whole))), str(case)
        assert found.doubt <= 1e-10 * max(1.0, abs(found.value)) or not np.isfinite(found.value), str(case)
        compared["finite" if np.isfinite(whole) else "infinite"] += 1
    assert compared["finite"] >= 20
    assert compared["infinite"] >= 5


def test_many_sides_close_the_bracket():
    stance = stance_of(Case("climbing", 3))
    numbers = layout(stance)
    widths = [high.value - low.value for low, high in (bracket(stance, numbers, sides) for sides in (16, 64, 256))]
    assert widths[0] > 8 * widths[1] > 64 * widths[2] > 0


def test_vectorised_checks_say_what_the_plain_ones_say():
    seen = Counter()
    for case in population(90, 4):
        stance = stance_of(case)
        numbers = layout(stance)
        answer = check_equilibrium(stance, engine=ENGINE)
        if answer.verdict == "stable":
            for factor in (1.0, 1.001):
                forces = altered(answer.forces, force_W=factor * answer.forces.force_W)
                forces.entries = lambda f=forces, plain=answer.forces: [
                    entry | {"force": force.tolist()} for entry, force in zip(plain.entries(), f.force_W, strict=True)
                ]
                (balance,), (cone,) = force_faults(numbers, stance, stance.com[None, :2], [forces])
                reach = 1.0 + np.abs(forces.force_W).max() / numbers.W
                assert (balance, cone) == pytest.approx(force_violations(stance, forces, EXACT), abs=1e-10 * reach), str(case)
                seen["forces"] += 1
        if answer.verdict == "unstable":
            motion = answer.certificate
            at_centre = motion.linear + np.cross(motion.angular, numbers.anchor + numbers.centre - motion.point)
            found = motions(numbers, at_centre[None], np.array(motion.angular)[None])
            power, against = motion_power(stance, motion, EXACT)
            mine = (found.power[0] + found.slope[0] @ numbers.com[:2]) * numbers.W
            assert mine == pytest.approx(power, rel=1e-6, abs=1e-9 * numbers.W * found.speed[0]), str(case)
            assert found.against[0] / found.speed[0] == pytest.approx(against, abs=1e-9), str(case)
            seen["motions"] += 1
    assert min(seen["forces"], seen["motions"]) >= 20


# --- what the checks are there for


class altered:
    """An answer with some attributes changed and the others as they were."""

    def __init__(self, answer, **changes):
        self.__dict__.update(changes, _answer=answer)

    def __getattr__(self, name):
        return getattr(self.__dict__["_answer"], name)


def outcome_of(case, stance, numbers):
    return Outcome(case, False, len(stance.contacts), len(numbers.points), numbers.size, stance.mass, 0.0, (0.0, 0.0))


def broken_verdict(case, **changes):
    """The checks that an altered answer to a stance breaks."""
    stance = stance_of(case)
    numbers = layout(stance)
    answer = check_equilibrium(stance, engine=ENGINE)
    changed = {key: change(answer, numbers) for key, change in changes.items()}
    out = outcome_of(case, stance, numbers)
    check_verdict(out, stance, numbers, altered(answer, **changed), *bracket(stance, numbers))
    check_certificate(out, stance, numbers, altered(answer, **changed))
    return {check for check, _ in out.violations}


STABLE, UNSTABLE = Case("edges", 8), Case("edges", 1)


def test_wrong_verdicts_and_margins_are_noticed():
    assert check_equilibrium(stance_of(STABLE), engine=ENGINE).verdict == "stable"
    assert check_equilibrium(stance_of(UNSTABLE), engine=ENGINE).verdict == "unstable"
    assert broken_verdict(STABLE) == broken_verdict(UNSTABLE) == set()
    nothing = lambda a, n: point_forces(assemble(stance_of(UNSTABLE)), np.zeros(3 * len(n.points)))  # noqa: E731
    assert broken_verdict(UNSTABLE, verdict=lambda a, n: "stable", forces=nothing) == {"verdict", "forces"}
    assert broken_verdict(STABLE, verdict=lambda a, n: "unstable", certificate=lambda a, n: None) == {"verdict", "motion"}
    assert broken_verdict(STABLE, verdict=lambda a, n: "undecided") == {"undecided"}
    for by in (2e-9, -2e-9, np.inf, -np.inf, np.nan):
        assert broken_verdict(STABLE, margin=lambda a, n, by=by: a.margin + by * n.W) == {"margin"}
    assert broken_verdict(STABLE, idle=lambda a, n: (stance_of(STABLE).contacts.names[0],), idle_margin=lambda a, n: None) >= {"idle"}


def test_wrong_forces_and_motions_are_noticed():
    lift = lambda a, n: altered(a.forces, force_W=a.forces.force_W * (1 + 1e-7))  # noqa: E731
    slip = lambda a, n: altered(a.forces, force_W=a.forces.force_W + [[3 * n.W, 0, 0]])  # noqa: E731
    assert broken_verdict(STABLE, forces=lift) == {"forces"}
    assert broken_verdict(STABLE, forces=slip) == {"forces"}
    assert broken_verdict(UNSTABLE, certificate=lambda a, n: None) == {"motion"}
    back = lambda a, n: altered(a.certificate, linear=-a.certificate.linear, angular=-a.certificate.angular)  # noqa: E731
    assert broken_verdict(UNSTABLE, certificate=back) == {"motion"}


@pytest.mark.parametrize("case", [Case("climbing", 3), Case("soles", 4), Case("grasp", 2)])
def test_wrong_regions_are_noticed(case):
    stance = stance_of(case)
    numbers = layout(stance)
    region = trace_support_region(stance, engine=ENGINE)
    verdict = check_equilibrium(stance, engine=ENGINE).verdict
    middle = region.inner.mean(axis=0)
    away = {"stable": -1.0, "unstable": 1.0}[verdict]
    wrong = {
        "inner forces": altered(region, inner=middle + (1 - 1e-6) * (region.inner - middle)),
        "inner inside outer": altered(region, outer=middle + 0.98 * (region.outer - middle)),
        "outer motions": altered(region, outer=middle + (1 - 1e-6) * (region.outer - middle)),
        "half-planes": altered(region, halfplanes=(region.halfplanes[0], region.halfplanes[1] - 1e-2 * numbers.size)),
        "com margin": altered(region, com_margin=away),
    }
    for check, other in ({"": region} | wrong).items():
        out = outcome_of(case, stance, numbers)
        out.verdict = verdict
        check_region(out, stance, numbers, other)
        assert check in {found for found, _ in out.violations} or (not check and not out.violations), (check, out.violations)


def test_regions_that_are_not_empty_and_rays_that_do_not_grow_are_noticed():
    case = Case("soles", 4)
    stance = stance_of(case)
    numbers = layout(stance)
    region = trace_support_region(stance, engine=ENGINE)
    assert region.kind == "polygon"
    for kind, check in (("empty", "region"), ("unbounded", "rays")):
        out = outcome_of(case, stance, numbers)
        check_region(out, stance, numbers, altered(region, kind=kind, rays=np.array([[1.0, 0.0]])))
        assert check in {found for found, _ in out.violations}


def test_distance_outside_a_polygon():
    square = np.array([[0.0, 0], [1, 0], [1, 1], [1 - 1e-13, 1 + 1e-13], [0, 1]])
    assert outside(square, np.array([[0.5, 0.5], [0.0, 0.0], [1.5, 0.5], [2.0, 2.0]])) == pytest.approx([0.0, 0.0, 0.5, np.sqrt(2)])


def test_an_error_is_a_violation_and_the_sweep_goes_on():
    out = check_case(Case("soles", 4), "no such engine", batches=False)
    assert {check for check, _ in out.violations} == {"verdict", "region"}
    assert any("no such engine" in message for _, message in out.violations)


def test_the_command_counts_and_names_what_is_broken(tmp_path):
    run = [sys.executable, str(COMMAND), "--workers", "1", "--batches", "0", "--engine"]
    done = subprocess.run([*run, ENGINE, "--stances", "12", "--json", str(tmp_path / "sweep.json")], capture_output=True, text=True)
    assert done.returncode in (0, 1), done.stderr
    found = json.loads((tmp_path / "sweep.json").read_text())
    assert found["violations"] == []
    assert found["total"]["stances"] == 12
    assert "violations: 0 on 0 stances" in done.stdout
    wrong = subprocess.run([*run, "none", "--only", "edges:8"], capture_output=True, text=True)
    assert wrong.returncode == 1
    assert "edges:8" in wrong.stdout
