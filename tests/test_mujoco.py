"""Verdicts and strong stability against rigid-body simulation, a small part of ``tests/sweeps/mujoco_check.py``."""

import numpy as np
import pytest

import socp_statics as ss

pytest.importorskip("mujoco", reason="the physical check needs the extra test")

import mujoco_stances as m  # noqa: E402


@pytest.fixture(scope="module")
def judged():
    """Small stances whose margin is above 2 % of W, with their weak answers."""
    found = []
    for name, stance in m.stances(30):
        if "two_feet" not in name:
            weak = ss.check_equilibrium(stance, engine="clarabel")
            if abs(weak.margin) > 0.02 * stance.weight:
                found.append((name, stance, weak))
    assert len(found) >= 12
    return found


def test_unstable_stances_leave_and_slide_or_open_where_computed(judged):
    unstable = [(name, stance) for name, stance, weak in judged if weak.verdict == "unstable"]
    assert len(unstable) >= 5
    for name, stance in unstable:
        run, found = m.simulate(stance), m.acceleration(stance)
        assert run.leaves, name
        assert m.words(stance, m.at_points(stance, found)) == m.words(stance, run.acceleration), name


def test_strongly_stable_stances_stay(judged):
    stable = [(name, stance) for name, stance, weak in judged if weak.verdict == "stable"]
    strong = [(name, stance) for name, stance in stable if ss.check_strong_stability(stance, engine="clarabel").strong == "strong"]
    assert len(strong) >= 5
    for name, stance in strong:
        assert m.simulate(stance).stays, name


@pytest.mark.parametrize("tilt", [0.5, 0.7])
def test_a_sliding_block_accelerates_as_computed(tilt):
    n = np.array([-np.sin(tilt), 0.0, np.cos(tilt)])
    sole = ss.SurfaceContact("sole", (0, 0, 0), normal=n, friction=0.3, size=(0.4, 0.3))
    stance = ss.Stance(ss.ContactSet([sole]), 0.1 * n, m.MASS, inertia=m.INERTIA)
    assert m.difference(stance, m.acceleration(stance), m.simulate(stance)) < 0.02


def test_between_walls_falls_without_preload():
    stance = m.between_walls(np.random.default_rng(0))
    assert ss.check_equilibrium(stance, engine="clarabel").stable
    assert m.simulate(stance).leaves
