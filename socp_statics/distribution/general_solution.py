"""The general solution of the wrench distribution problem: a particular solution and everything the null space adds (3.5, 3.5.1)."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from socp_statics.distribution.dual_null_space import null_basis, null_projector
from socp_statics.distribution.generalized_inverses import RELATIVE_RANK, pseudoinverse
from socp_statics.exceptions import InputError
from socp_statics.spatial import Array

OUT_OF_REACH = 1e-9
WORDS = ("force along x", "force along y", "force along z", "moment about x", "moment about y", "moment about z")


class OutOfReachError(InputError):
    """The contacts cannot balance the load whatever their cones: wrong input of a closed form, an answer where a verdict is asked for."""


class GeneralSolution(NamedTuple):
    """All contact components that balance a wrench: ``F = particular + N F_a = particular + V F_int``.

    Attributes:
        particular: ``C^# F_e``, shape (c,) [N, N m].
        projector: N(C), shape (c, c).
        basis: V(C), orthonormal columns, shape (c, c - rank).
        rank: Of C. The internal components number c - rank, not c - 6: two point contacts have c = 6, rank 5 and one internal force.
    """

    particular: Array
    projector: Array
    basis: Array
    rank: int

    @property
    def internal(self) -> int:
        """Number of independent internal components, ``c - rank C``."""
        return self.basis.shape[1]

    def with_arbitrary(self, F_a: ArrayLike) -> Array:
        """The member of the solution of an arbitrary vector of contact components, shape (c,)."""
        return self.particular + null_component(self.projector, F_a)

    def with_internal(self, F_int: ArrayLike) -> Array:
        """The member of the solution of internal components, shape (c - rank,)."""
        return self.particular + internal_component(self.basis, F_int)


def loop_wrench(C: ArrayLike, components: ArrayLike) -> Array:
    """The wrench of the reactions at the closure link: ``F_e = C_ce F^c``; the mobility components have no place in statics.

    Implements (3.38).

    Args:
        C: C_ce, shape (..., 6, c).
        components: F^c, shape (..., c) [N, N m].

    Returns:
        Shape (..., 6).
    """
    return (np.asarray(C, dtype=float) @ np.asarray(components, dtype=float)[..., None])[..., 0]


def general_solution(C: ArrayLike, wrench: ArrayLike, inverse: ArrayLike | None = None, *, length: float = 1.0) -> GeneralSolution:
    """``F^c = C^# F_e + F^n``: all distributions of a wrench.

    Implements (3.39).

    Args:
        C: Contact map, shape (6, c), or (m, c) of a planar or another reduced balance.
        wrench: F_e about the point of the map, shape (6,) [N, N m].
        inverse: C^#, shape (c, 6); the pseudoinverse by default.
        length: What a moment is divided by to be compared with a force when it is judged what cannot be balanced [m].

    Returns:
        The solution, with its rank.

    Raises:
        InputError: Directions of the wrench that no contact component reaches.
    """
    C, F = np.asarray(C, dtype=float), np.asarray(wrench, dtype=float)
    if F.shape != C.shape[:1]:
        raise InputError(f"wrench: {len(C)} numbers are expected, got shape {F.shape}", name="wrench", field="wrench")
    sharp = pseudoinverse(C) if inverse is None else np.asarray(inverse, dtype=float)
    refuse_out_of_reach(C, F, length)
    basis = null_basis(C)
    return GeneralSolution(sharp @ F, null_projector(C, sharp), basis, C.shape[1] - basis.shape[1])


def null_component(projector: ArrayLike, F_a: ArrayLike) -> Array:
    """``F^n = N(C) F_a``: the null-space component of an arbitrary vector, which is meant as a contact wrench.

    Implements (3.40).

    Args:
        projector: N(C), shape (c, c).
        F_a: Shape (c,) [N, N m].

    Returns:
        Shape (c,).

    Raises:
        InputError: The wrong number of components.
    """
    return _applied(projector, F_a, "F_a")


def internal_component(basis: ArrayLike, F_int: ArrayLike) -> Array:
    """``F^n = V(C) F_int``: the null-space component of as few numbers as there are internal components.

    Implements (3.41).

    Args:
        basis: V(C), shape (c, c - rank).
        F_int: Shape (c - rank,).

    Returns:
        Shape (c,).

    Raises:
        InputError: The wrong number of components.
    """
    return _applied(basis, F_int, "F_int")


def _applied(matrix: ArrayLike, vector: ArrayLike, word: str) -> Array:
    M, v = np.asarray(matrix, dtype=float), np.asarray(vector, dtype=float)
    if v.shape != M.shape[1:]:
        raise InputError(f"{word}: {M.shape[1]} numbers are expected, got shape {v.shape}", name=word, field=word)
    return M @ v


def unreachable(C: ArrayLike, length: float = 1.0) -> Array:
    """Wrenches that no contact components produce, shape (6, 6 - rank), orthonormal with moments divided by ``length``."""
    C = np.asarray(C, dtype=float)
    scale = np.ones(len(C))
    scale[3:] = length
    U, s, _ = np.linalg.svd(C / scale[:, None], full_matrices=True)
    return U[:, int((s > RELATIVE_RANK * s.max(initial=0.0)).sum()) :]


def refuse_out_of_reach(C: ArrayLike, wrench: ArrayLike, length: float = 1.0, what: str = "the load") -> None:
    """Say which directions of a wrench a rank-deficient map cannot balance.

    Args:
        C: Shape (6, c).
        wrench: Shape (6,) [N, N m].
        length: What moments are divided by [m].
        what: What cannot be balanced, for the sentence.

    Raises:
        OutOfReachError: The wrench is out of reach by more than 1e-9 of its size.
    """
    C, F = np.asarray(C, dtype=float), np.array(wrench, dtype=float)
    lost = unreachable(C, length)
    F[3:] /= length
    missing = lost @ (lost.T @ F)
    if np.linalg.norm(missing) > OUT_OF_REACH * np.linalg.norm(F):
        directions = "; ".join(direction_words(column) for column in _aligned(lost).T)
        message = f"{what} cannot be balanced: the contacts (rank {C.shape[0] - lost.shape[1]} of {C.shape[0]}) give no {directions}"
        raise OutOfReachError(message, name="contacts", field="contacts")


def _aligned(basis: Array) -> Array:
    """The same space with as many zeros as elimination finds, so that its directions can be read."""
    rows, used = basis.T.copy(), 0
    for j in range(rows.shape[1]):
        if used == len(rows):
            break
        pivot = used + int(np.abs(rows[used:, j]).argmax())
        if abs(rows[pivot, j]) < 1e-6:
            continue
        rows[[used, pivot]] = rows[[pivot, used]]
        rows[used] /= rows[used, j]
        others = np.arange(len(rows)) != used
        rows[others] -= rows[others, j][:, None] * rows[used]
        used += 1
    return (rows / np.linalg.norm(rows, axis=1, keepdims=True)).T


def direction_words(direction: Array, labels: Sequence[str] | None = None) -> str:
    """A direction in words, such as ``moment about y`` or ``0.6 moment about x + 0.8 moment about y``.

    Args:
        direction: Shape (m,).
        labels: What the entries are; those of a wrench by default.
    """
    words = labels or (WORDS if len(direction) == 6 else [f"component {i}" for i in range(len(direction))])
    parts = [(value, word) for value, word in zip(direction, words, strict=True) if abs(value) > 1e-6]
    if len(parts) == 1:
        return parts[0][1]
    return " ".join(f"{'-' if v < 0 else '+' if i else ''}{' ' if i else ''}{abs(v):.2g} {word}" for i, (v, word) in enumerate(parts))
