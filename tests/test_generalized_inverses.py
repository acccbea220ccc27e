"""Generalised inverses: the conditions of Moore and Penrose, optimality, and rank-deficient maps."""

import numpy as np
import pytest

from socp_statics.distribution import inverse_of_shares, pseudoinverse, weighted_inverse
from socp_statics.exceptions import InputError

RNG = np.random.default_rng(3)
MAPS = [RNG.normal(size=(6, 12)), RNG.normal(size=(6, 2)) @ RNG.normal(size=(2, 9)), RNG.normal(size=(3, 3))]


@pytest.mark.parametrize("A", MAPS)
def test_the_pseudoinverse_meets_the_four_conditions(A):
    X = pseudoinverse(A)
    assert np.allclose(A @ X @ A, A) and np.allclose(X @ A @ X, X)
    assert np.allclose(A @ X, (A @ X).T) and np.allclose(X @ A, (X @ A).T)


@pytest.mark.parametrize("A", MAPS)
def test_the_weighted_solution_balances_and_no_null_motion_lowers_its_cost(A):
    root = RNG.normal(size=(A.shape[1], A.shape[1]))
    W = root @ root.T + 0.1 * np.eye(len(root))
    b = A @ RNG.normal(size=A.shape[1])
    x = weighted_inverse(A, W) @ b
    assert np.allclose(A @ x, b)
    _, s, Vt = np.linalg.svd(A)
    null = Vt[int((s > 1e-9).sum()) :]
    assert np.allclose(null @ W @ x, 0.0, atol=1e-9)
    assert np.allclose(inverse_of_shares(A, np.linalg.inv(W)), weighted_inverse(A, W), atol=1e-8)


def test_the_printed_formula_where_the_rank_is_full():
    A, w = MAPS[0], RNG.uniform(0.1, 3.0, 12)
    assert np.allclose(weighted_inverse(A, w), np.diag(1 / w) @ A.T @ np.linalg.inv(A @ np.diag(1 / w) @ A.T))
    assert np.allclose(weighted_inverse(A, np.ones(12)), pseudoinverse(A))


def test_a_share_of_zero_uses_nothing():
    A = MAPS[0]
    shares = np.r_[0.0, 0.0, np.ones(10)]
    X = inverse_of_shares(A, shares)
    assert not X[:2].any() and np.allclose(A @ X, np.eye(6))


@pytest.mark.parametrize(
    ("call", "field"),
    [
        (lambda: pseudoinverse([1.0, 2.0]), "A"),
        (lambda: pseudoinverse([[np.nan]]), "A"),
        (lambda: pseudoinverse([["a"]]), "A"),
        (lambda: weighted_inverse(np.eye(2), [1.0, 0.0]), "weights"),
        (lambda: weighted_inverse(np.eye(2), [1.0, 1.0, 1.0]), "weights"),
        (lambda: weighted_inverse(np.eye(2), [[1.0, 2.0], [0.0, 1.0]]), "weights"),
        (lambda: inverse_of_shares(np.eye(2), [1.0, -1.0]), "shares"),
    ],
)
def test_wrong_numbers_are_named(call, field):
    with pytest.raises(InputError) as caught:
        call()
    assert caught.value.field == field
