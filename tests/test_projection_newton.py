"""Newton's method by projection: programs whose solution is known by construction, and what it does where it does not take hold."""

from __future__ import annotations

from types import FunctionType

import numpy as np
import pytest

projection_newton = pytest.importorskip("socp_statics.engines.kernel.projection_newton")

from socp_statics.engines.kernel.lanes import RHS, ROW1, U, buffer_size, lane  # noqa: E402
from socp_statics.engines.kernel.lanes import S as STRIDE  # noqa: E402
from socp_statics.engines.kernel.projection_newton import CONVERGED, EQUATION  # noqa: E402


def interpreted(function):
    """An inner function of the kernel, and those that it calls, as Python reads them."""
    plain = getattr(function, "py_func", function)
    names = {name: plain.__globals__[name] for name in plain.__code__.co_names if name in plain.__globals__}
    inner = {name: interpreted(value) for name, value in names.items() if hasattr(value, "py_func")}
    return FunctionType(plain.__code__, {**plain.__globals__, **inner})


optimum, size_of, lane_of = (interpreted(one) for one in (projection_newton.optimum, buffer_size, lane))

FREE, SLIDES, RESTS = "free", "slides", "rests"


class Program:
    """minimise q'y subject to h - G y in K, with the solution it was made from."""

    def __init__(self, states, rng, frictionless=()):
        self.cones = len(states)
        self.friction = np.array([0.0 if k in frictionless else 0.5 for k in range(self.cones)])
        self.G = rng.normal(size=(self.cones, 3, 5))
        self.G[self.friction == 0.0, 1:] = 0.0
        self.y, self.s, self.z = rng.normal(size=5), np.zeros((self.cones, 3)), np.zeros((self.cones, 3))
        for k, state in enumerate(states):
            angle, size, other = rng.uniform(0.0, 2.0 * np.pi), *rng.uniform(0.3, 1.5, 2)
            turn = np.array([np.cos(angle), np.sin(angle)]) if self.friction[k] else np.zeros(2)
            if state == FREE:
                self.s[k] = size, *(0.5 * size * turn)
            elif state == RESTS or not self.friction[k]:
                self.z[k] = size, *(0.5 * size * turn)
            else:
                self.s[k], self.z[k] = (size, *(-size * turn)), (other, *(other * turn))
        self.q = -np.einsum("kci,kc->i", self.G, self.z)
        self.h = self.s + self.G @ self.y

    def solved(self, y, z):
        """What Newton's method makes of a start: whether it succeeded, the unknowns and the multipliers."""
        X, points = np.zeros(size_of(self.cones)), np.zeros((self.cones, 14))
        points[:, 12] = self.friction
        for k in range(self.cones):
            a = lane_of(k)
            for c in range(3):
                X[a + RHS + U(c) * STRIDE] = self.h[k, c]
                for j in range(5):
                    X[a + U(c) * ROW1 + U(j) * STRIDE] = self.G[k, c, j]
        y, kept = y.copy(), z.ravel().copy()
        rows, equations = np.empty(self.cones, np.int64), np.empty((3 * self.cones, EQUATION))
        return optimum(X, self.cones, points, self.q, rows, equations, y, kept), y, kept.reshape(-1, 3)

    def misses(self, y, z):
        """Largest violation of the optimality conditions: both cones, balance, complementarity."""
        s = self.h - self.G @ y
        outside = max((np.where(self.friction > 0.0, np.hypot(v[:, 1], v[:, 2]), 0.0) - v[:, 0]).max() for v in (s, z))
        return max(outside, np.abs(self.q + np.einsum("kci,kc->i", self.G, z)).max(), np.abs((s * z).sum(axis=1)).max())


MIXED = [[SLIDES] * 4 + [FREE] * 3, [RESTS, SLIDES, SLIDES, FREE], [RESTS, RESTS, FREE, FREE], [SLIDES] * 5]


@pytest.mark.parametrize("states", MIXED, ids="-".join)
@pytest.mark.parametrize("seed", range(6))
def test_a_start_near_the_solution_leads_to_one(states, seed):
    rng = np.random.default_rng(seed)
    program = Program(states, rng)
    found, y, z = program.solved(program.y + 0.02 * rng.normal(size=5), program.z + 0.02 * rng.normal(size=program.z.shape))
    assert found
    assert program.misses(y, z) <= 10.0 * CONVERGED
    assert program.q @ y == pytest.approx(program.q @ program.y, abs=1e-10)


@pytest.mark.parametrize("seed", range(6))
def test_a_start_that_takes_every_contact_for_loaded_changes_its_mind(seed):
    program = Program([SLIDES, SLIDES, SLIDES, FREE, FREE], np.random.default_rng(seed))
    program.s[3:] *= 0.1
    program.h = program.s + program.G @ program.y
    wrong = program.z.copy()
    wrong[3:, 0] = program.s[3:, 0]
    found, y, z = program.solved(program.y, wrong)
    assert found
    assert program.misses(y, z) <= 10.0 * CONVERGED
    assert np.all(z[3:] == 0.0)


def test_points_without_friction_are_inequalities():
    rng = np.random.default_rng(3)
    program = Program([SLIDES] * 4 + [RESTS, FREE, FREE], rng, frictionless=(3, 4, 5))
    found, y, z = program.solved(program.y + 0.01 * rng.normal(size=5), program.z + 0.01)
    assert found
    assert program.misses(y, z) <= 10.0 * CONVERGED
    assert z[5, 0] == 0.0


def test_the_solution_itself_is_kept():
    program = Program(MIXED[0], np.random.default_rng(11))
    found, y, z = program.solved(program.y, program.z)
    assert found
    assert np.abs(y - program.y).max() <= 1e-12
    assert np.abs(z - program.z).max() <= 1e-12


def test_a_program_without_an_optimum_is_left_alone():
    program = Program([FREE, FREE, FREE], np.random.default_rng(5))
    program.q = np.array([1.0, 0.0, 0.0, 0.0, 0.0])
    # Balance of the first unknown asks for normal forces that add up to minus one.
    program.G[:, 0, 0], program.G[:, 1:, 0] = 1.0, 0.0
    found, _, _ = program.solved(program.y, program.z)
    assert not found


def test_a_start_out_of_all_proportion_is_refused():
    program = Program(MIXED[0], np.random.default_rng(2))
    found, _, _ = program.solved(program.y + 1e3, program.z)
    assert not found
