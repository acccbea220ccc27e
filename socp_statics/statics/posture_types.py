"""The type of a posture: Table 3.1 and Fig. 3.10, from the subspaces of J_cB, J_B and C_cB, with the numbers behind each label.

With V_B the twist of the base and theta_dot the joint rates, contacts hold where ``C_cB' V_B + J_cB theta_dot = 0``; dually, contact
components F give the base ``C_cB F`` and load the motors with ``-J_cB' F``. Where the printed table is wrong its corrected condition is
used; the sentence of each type says what was decided.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from socp_statics.contacts.joint import constraint_basis, mobility_basis
from socp_statics.contacts.stance import GRAVITY_W
from socp_statics.exceptions import InputError
from socp_statics.postures import Posture
from socp_statics.spatial import Array
from socp_statics.statics.contact_maps import contact_jacobian, contact_map, gravity_wrench
from socp_statics.statics.subspaces import common, subspaces
from socp_statics.statics.wrench_range import SINGULAR

BASE, JOINTS, CONTACTS = "base twist [m/s, rad/s]", "joint rates [rad/s]", "contact components [N, N m]"
BASE_WRENCH, TORQUES = "base wrench [N, N m]", "joint torques [N m]"


@dataclass(frozen=True, eq=False)
class PostureType:
    """One row of Table 3.1.

    Attributes:
        name: As in the table.
        holds: Whether the posture is of this type.
        condition: The condition that was checked, corrected where the table's is wrong.
        dimension: Of the subspace the condition is about.
        basis: The subspace, orthonormal in scaled units (lengths over the contacts' size), columns in SI, shape (m, dimension).
        space: What the columns are.
        sentence: The decision in words, with its numbers.
    """

    name: str
    holds: bool
    condition: str
    dimension: int
    basis: Array = field(repr=False)
    space: str
    sentence: str


@dataclass(frozen=True, eq=False)
class PostureTypes:
    """All rows of Table 3.1 for one posture.

    Attributes:
        rows: The types, in the order of the table.
        constraints: c, number of transmitted components.
        singular_values: Of J_cB, J_B and C_cB in scaled units, by name.
        ranks: Their ranks, by name.
    """

    rows: tuple[PostureType, ...]
    constraints: int
    singular_values: dict[str, Array]
    ranks: dict[str, int]

    def __getitem__(self, name: str) -> PostureType:
        for row in self.rows:
            if row.name == name:
                return row
        raise KeyError(name)

    @property
    def names(self) -> tuple[str, ...]:
        """The types that hold."""
        return tuple(row.name for row in self.rows if row.holds)

    def describe(self) -> str:
        """Several lines of text: the ranks, then every type with its sentence."""
        ranks = ", ".join(f"rank {name} {rank} (least singular value {self._least(name):.3g})" for name, rank in self.ranks.items())
        lines = [f"c = {self.constraints} transmitted components, {ranks}"]
        width = max(len(row.name) for row in self.rows)
        lines += [f"{'yes' if row.holds else 'no':<4}{row.name:<{width}}  {row.sentence}" for row in self.rows]
        return "\n".join(lines)

    def _least(self, name: str) -> float:
        rank = self.ranks[name]
        return float(self.singular_values[name][rank - 1]) if rank else 0.0


def posture_types(posture: Posture) -> PostureTypes:
    """Which types of Table 3.1 a posture belongs to.

    Args:
        posture: A posture on its contacts.

    Returns:
        Every type with its decision and numbers.

    Raises:
        InputError: Not a posture.
    """
    if not isinstance(posture, Posture):
        message = f"posture types are those of a robot on its contacts: a Posture is expected, got {type(posture).__name__}"
        raise InputError(message, name="posture", field="posture")
    maps = _Maps(posture)
    rows = (
        *_base_motion(maps),
        *_internal(maps),
        *_constrained(maps),
        *_stationary(maps),
    )
    fundamental = {"J_cB": maps.J_c, "J_B": maps.J, "C_cB": maps.C}
    return PostureTypes(
        rows, maps.C.matrix.shape[1], {k: m.singular_values for k, m in fundamental.items()}, {k: m.rank for k, m in fundamental.items()}
    )


class _Maps:
    """The fundamental transforms in scaled units, lengths over the contacts' size, and the way back to SI."""

    def __init__(self, posture: Posture):
        contacts = posture.contacts
        length = contacts.size
        J = [posture.jacobian[c.name] for c in contacts]
        held, free = [constraint_basis(c) for c in contacts], [mobility_basis(c) for c in contacts]
        self.twist = np.repeat([length, 1.0], 3)
        self.wrench = np.repeat([1.0 / length, 1.0], 3)
        self.component = np.concatenate([B.T @ self.wrench for B in held])

        def scaled(bases: list[Array]) -> Array:
            return np.concatenate([B.T @ self.wrench for B in bases])[:, None] * contact_jacobian(contacts, J, bases)

        self.J_c, self.J_m = subspaces(scaled(held)), subspaces(scaled(free))
        self.J = subspaces(np.vstack([self.J_c.matrix, self.J_m.matrix]))
        C = contact_map(contacts, posture.p_WB)
        self.C = subspaces(self.twist[:, None] * C * self.component)
        C_m = contact_map(contacts, posture.p_WB, free)
        both = np.hstack([self.C.matrix, self.twist[:, None] * C_m * np.concatenate([B.T @ self.wrench for B in free])])
        self.complete = subspaces(both)
        G_B = gravity_wrench(posture.mass, GRAVITY_W, posture.p_WB, posture.com_W)
        self.gravity_torque = self.J_c.matrix.T @ np.linalg.pinv(self.C.matrix, rcond=SINGULAR) @ (self.twist * G_B)

    @cached_property
    def impossible(self) -> Array:
        """Base twists that no joint rates follow, and dually the base wrenches that no motor resists: ``C_cB N(J_cB')``; scaled."""
        return subspaces(self.C.matrix @ self.J_c.left_null).range


def _si(columns: Array, scale: Array) -> Array:
    return scale[:, None] * columns


def _base_motion(m: _Maps) -> tuple[PostureType, ...]:
    lost = m.impossible
    k = lost.shape[1]
    possible = subspaces(lost.T).null
    structural = _si(lost, 1.0 / m.twist)
    return (
        PostureType("regular", k == 0, "R(C_cB') in R(J_cB)", 6 - k, _si(possible, m.twist), BASE,
                    f"the base can move along {6 - k} of 6 directions"),
        PostureType("singular", k > 0, "R(C_cB') not in R(J_cB)", k, _si(lost, m.twist), BASE,
                    f"the base cannot move along {k} of 6 directions whatever the joints do"),
        PostureType("structural force", k > 0, "C_cB N(J_cB') is not {0}", k, structural, BASE_WRENCH,
                    f"{k} independent base wrenches are resisted without motor load; gravity's reaction G_B, spread by the pseudoinverse, "
                    f"loads motors with up to {float(np.abs(m.gravity_torque).max()):.3g} N m"),
    )  # fmt: skip


def _internal(m: _Maps) -> tuple[PostureType, ...]:
    inside = m.C.null
    k = inside.shape[1]
    torque = subspaces(m.J_c.matrix.T @ inside).range
    self_motion = m.J.null.shape[1]
    return (
        PostureType("internal wrench", k > 0, "N(C_cB) is not {0}", k, _si(inside, m.component), CONTACTS,
                    f"{k} independent internal wrenches, without net wrench on the base, can be added where the cones allow"),
        PostureType("internal joint torque", torque.shape[1] > 0, "J_cB' N(C_cB) is not {0}", torque.shape[1], torque, TORQUES,
                    f"internal wrenches redistribute {torque.shape[1]} independent torques; "
                    f"the {self_motion} torques of N*(J_B) only accelerate joints and are zero in statics"),
    )  # fmt: skip


def _constrained(m: _Maps) -> tuple[PostureType, ...]:
    rank, c, n = m.C.rank, m.C.matrix.shape[1], m.J_c.matrix.shape[1]
    free = m.C.left_null
    consistent = subspaces(m.C.null.T @ m.J_c.matrix).null
    return (
        PostureType("fully constrained", rank == c == 6, "c = rank C_cB = 6", n if rank == c == 6 else 0,
                    np.eye(n) if rank == c == 6 else np.zeros((n, 0)), JOINTS,
                    f"c = {c}, rank C_cB = {rank}" + ("; any joint rates are admissible" if rank == c == 6 else "")),
        PostureType("overconstrained", c > rank, "c > rank C_cB", consistent.shape[1], consistent, JOINTS,
                    f"c = {c}, rank C_cB = {rank}; {consistent.shape[1]} of {n} joint rates are consistent with the contacts"),
        PostureType("underconstrained", rank < 6, "rank C_cB < 6", 6 - rank, _si(free, m.twist), BASE,
                    f"the contacts leave {6 - rank} of 6 base motions free"),
    )  # fmt: skip


def _stationary(m: _Maps) -> tuple[PostureType, ...]:
    base, both = m.J_c.null, m.J.null
    ends = common(m.J_m.null, m.J_c.row_space)
    moving = 6 - subspaces(m.complete.matrix @ m.J.left_null).rank
    return (
        PostureType("stationary base", base.shape[1] > 0, "N(J_cB) is not {0}", base.shape[1], base, JOINTS,
                    f"{base.shape[1]} joint motions leave the base still and the contacts in place"),
        PostureType("stationary base and end links", both.shape[1] > 0, "N(J_B) is not {0}", both.shape[1], both, JOINTS,
                    f"{both.shape[1]} joint motions leave the base and every end link still"),
        PostureType("stationary end links", ends.shape[1] > 0, "N(J_mB) and R(J_cB') share more than {0}", ends.shape[1], ends, JOINTS,
                    f"{ends.shape[1]} joint motions move end links in no free direction; "
                    f"with all end links still the base can move along {moving} of 6 directions"),
    )  # fmt: skip

