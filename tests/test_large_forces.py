"""Walls that hardly close the force: contacts carry thousands of weights, which is an answer and not the lack of one."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest
from plain_stances import UP

from socp_statics import distribute, largest_payload, minimise_largest_wrench, optimise_contact_forces
from socp_statics.certificates import force_residuals
from socp_statics.cones.choice import ConeChoice
from socp_statics.contacts import ContactSet, PointContact, SoftFingerContact, Stance, SurfaceContact
from socp_statics.engines.solution import INFEASIBLE
from socp_statics.exceptions import EngineError
from socp_statics.optimization import force_answer
from socp_statics.optimization.force_answer import settled
from socp_statics.optimization.minimax_wrench import attains
from socp_statics.stability import check_equilibrium
from socp_statics.statics import assemble

W = 9.81


def between_walls(friction: float) -> Stance:
    """One kilogram between two points on vertical walls."""
    sides = (("left", 0.4), ("right", -0.4))
    return Stance(ContactSet([PointContact(n, (0, y, 0), normal=(0, -y, 0), friction=friction) for n, y in sides]), (0, 0, -0.1), 1.0)


def overhanging(tilt: float, above: float, apart: bool = False) -> Stance:
    """One kilogram between two soles on walls that lean over, the friction angle hardly larger than their tilt."""
    mu, heights = np.tan(tilt) * (1.0 + above), (-0.08, 0.01) if apart else (0.0, 0.0)
    soles = [
        SurfaceContact(n, (0, 0.4 * s, z), normal=(0, -s * np.cos(tilt), -np.sin(tilt)), friction=mu, size=(0.2, 0.2))
        for n, s, z in zip(("left", "right"), (1, -1), heights, strict=True)
    ]
    return Stance(ContactSet(soles), (0.05, 0.1, 0.1) if apart else (0, 0, 0.1), 1.0)


@pytest.mark.parametrize("friction", [1e-2, 1e-3, 6e-5, 1e-5, 1e-6])
@pytest.mark.parametrize("level", ["point", "contact"])
@pytest.mark.parametrize("engine", ["auto", "clarabel"])
def test_the_least_forces_between_walls_are_attained(friction, level, engine):
    stance, N = between_walls(friction), W / (2 * friction)
    for measure, least in (("force", np.hypot(N, W / 2)), ("normal", N), ("component", N), ("tangential", W / 2)):
        answer = minimise_largest_wrench(stance, measure, level, engine=engine)
        assert (answer.status, answer.objective) == ("solved", pytest.approx(least, rel=1e-6)), measure


def test_which_measures_are_attained_for_certain():
    exact, inscribed = ConeChoice(), ConeChoice("inscribed", 8)
    points, soles = assemble(between_walls(0.5)), assemble(overhanging(0.1, 0.5))
    finger = SoftFingerContact("finger", (0, 0, 0), normal=UP, friction=0.5, torsional_friction=0.02)
    fingers = assemble(Stance(ContactSet([finger]), (0, 0, 1), 1.0))
    for data in (points, soles, fingers):
        assert all(attains(data, exact, measure, level) for measure in ("normal", "force", "component") for level in ("point", "contact"))
        assert not any(attains(data, cone, "friction_use", "point") for cone in (exact, inscribed))
    assert attains(points, exact, "tangential", "contact") and attains(soles, exact, "tangential", "point")
    assert not attains(soles, exact, "tangential", "contact") and attains(soles, inscribed, "tangential", "contact")
    assert not attains(fingers, exact, "tangential", "point")


@pytest.mark.parametrize(("tilt", "above"), [(0.1, 1e-3), (0.1, 1e-4), (0.1, 1e-5), (0.02, 1e-4)])
def test_forces_of_soles_that_hardly_hold_in_closed_form(tilt, above):
    stance = overhanging(tilt, above)
    mu = stance.contacts[0].friction
    N = W / 2 / (mu * np.cos(tilt) - np.sin(tilt))
    assert check_equilibrium(stance).verdict == "stable"
    answer = optimise_contact_forces(stance, "normal_force")
    assert (answer.status, answer.objective) == ("solved", pytest.approx(2 * N, rel=1e-5))
    least = optimise_contact_forces(stance)
    assert (least.status, least.objective) == ("solved", pytest.approx(2 * N * N * (1 + mu * mu) / 4, rel=1e-4))


# Engines see no difference between forces of a million weights and none.
@pytest.mark.parametrize(("tilt", "above"), [(0.1, 1e-5), (0.1, 3e-6), (0.02, 1e-4), (0.3, 1e-6)])
def test_nothing_is_infeasible_that_is_stable(tilt, above):
    stance = overhanging(tilt, above, apart=True)
    assert check_equilibrium(stance).verdict == "stable"
    for ask in (
        optimise_contact_forces,
        lambda s: optimise_contact_forces(s, "reference", reference_forces={"left": [0, 0, 0]}),
        lambda s: minimise_largest_wrench(s, "force", "contact"),
        lambda s: distribute(s, "qp", cop_weight=0.0),
        lambda s: largest_payload(s, (0, 0, 0)),
    ):
        try:
            answer = ask(stance)
        except EngineError as error:
            assert "was not settled" in str(error)
        else:
            assert answer.status in ("solved", "unbounded")


def test_an_engine_that_denies_forces_which_exist_is_not_believed(monkeypatch):
    stance = between_walls(0.5)
    data = assemble(stance)
    x = _balanced(data)
    assert max(force_residuals(data, ConeChoice(), x)) <= 1e-12
    good = SimpleNamespace(status="solved", detail="solved", variables={"x": x})
    none = SimpleNamespace(status=INFEASIBLE, detail="infeasible")
    engines = [SimpleNamespace(name="first"), SimpleNamespace(name="second")]
    monkeypatch.setattr(force_answer, "engines_for", lambda engine, form: engines)

    def denying(one):
        return none if one.name == "first" else good

    found, handovers = settled(data, ConeChoice(), "auto", denying, "a program", "socp", balances=True)
    assert found is good and handovers == 1
    assert settled(data, ConeChoice(), "auto", denying, "a program", "socp")[0] is none
    with pytest.raises(EngineError, match="a program was not settled .*infeasible though forces balance"):
        settled(data, ConeChoice(), "auto", lambda one: none, "a program", "socp", balances=True)


def _balanced(data):
    """Both points press with two weights and carry half of one each."""
    x = np.zeros(data.wrench_map.shape[1])
    x[data.normal] = 2.0
    return x - np.linalg.lstsq(data.wrench_map, data.wrench_map @ x + data.load, rcond=None)[0]
