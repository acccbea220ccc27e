"""The convex set of all models: contact forces in their cones that balance a load, within bounds and limits.

    G x + L = 0,   x = (f_t, f_n, m_n, h)
    |f_t| <= mu f_n                       circular cones                                  (3.9)
    |(f_t, (mu/gamma) m_n)| <= mu f_n     elliptic soft fingers
    |m_n| <= gamma f_n                    box soft fingers, with their circular cone      (3.11)
    f_n >= 0                              frictionless points
    lo <= sum of a contact's f_n <= hi    bounds
    H x <= d                              hard rows: handle limits, torque limits

Every cone can be shifted by a reserve t of normal force: ``f - t n`` in K and ``lo + t <= N <= hi - t``.
"""

from __future__ import annotations

from typing import NamedTuple

import cvxpy as cp
import numpy as np
from numpy.typing import NDArray

from socp_statics.cones.choice import ConeChoice
from socp_statics.exceptions import InputError
from socp_statics.spatial import Array
from socp_statics.statics.statics_data import StaticsData

FORMS = ("socp", "sdp")


class ForceShape(NamedTuple):
    """Everything the structure of the set depends on; programs of equal shape share one compilation."""

    circular: int
    box: int
    elliptic: int
    frictionless: int
    handle: int
    rows: int
    lower: int
    upper: int
    equal: int
    limits: int
    joints: int
    sides: int
    inscribed: bool
    form: str

    @property
    def slipping(self) -> int:
        """Points with friction."""
        return self.circular + self.elliptic

    @property
    def points(self) -> int:
        """Unilateral points."""
        return self.slipping + self.frictionless

    @property
    def columns(self) -> int:
        """Length of x."""
        return 2 * self.slipping + self.points + self.box + self.elliptic + self.handle


class BoundRows(NamedTuple):
    """Sums of normal forces that are bounded: rows over the points, and their values."""

    lower: Array
    lower_values: Array
    upper: Array
    upper_values: Array
    equal: Array
    equal_values: Array


def bound_rows(data: StaticsData) -> BoundRows:
    """Split the bounds of the contacts' normal forces: equal ends are equalities, infinite ends are no rows."""
    sums = (data.contact_of_point[None, :] == data.bounded[:, None]).astype(float)
    lo, hi = data.bounds[:, 0], data.bounds[:, 1]
    equal = lo == hi
    upper = ~equal & np.isfinite(hi)
    return BoundRows(sums[~equal], lo[~equal], sums[upper], hi[upper], sums[equal], lo[equal])


def paired_joints(data: StaticsData) -> NDArray[np.int_]:
    """Joints whose torque rows come in pairs, so that one variable y = T x a joint keeps the program sparse.

    Args:
        data: The stance's arrays.

    Returns:
        Indices of the limited joints; none where an end is infinite or the hard rows are not all of the torque limits.
    """
    finite = np.isfinite(data.torques.limits)
    limited = np.flatnonzero(finite.any(axis=1))
    pairs = bool(finite[limited].all()) and len(data.limit_values) - data.handle_limits == 2 * len(limited)
    return limited if pairs else limited[:0]


def force_shape(data: StaticsData, cone: ConeChoice, form: str, rows: int) -> ForceShape:
    """Structure of the set of a stance.

    Args:
        data: The stance's arrays.
        cone: Exact cones or pyramids.
        form: "socp" or "sdp" for exact cones.
        rows: Number of independent balance rows.

    Returns:
        The shape, with circumscribed elliptic soft fingers counted as boxes.

    Raises:
        InputError: There is no such form.
    """
    if form not in FORMS:
        raise InputError(f"form must be one of {', '.join(FORMS)}, got {form!r}", name="form", field="form")
    bounds = bound_rows(data)
    inscribed = cone.kind == "inscribed"
    as_box = data.elliptic if cone.kind == "circumscribed" else 0
    return ForceShape(
        circular=data.circular + as_box,
        box=data.box + as_box,
        elliptic=data.elliptic - as_box,
        frictionless=data.frictionless,
        handle=len(data.contact_of_handle),
        rows=rows,
        lower=len(bounds.lower),
        upper=len(bounds.upper),
        equal=len(bounds.equal),
        limits=len(data.limit_values),
        joints=len(paired_joints(data)),
        sides=cone.sides or 0,
        inscribed=inscribed,
        form=form if cone.kind == "exact" else "socp",
    )


def force_values(data: StaticsData, cone: ConeChoice, basis: Array) -> dict[str, Array]:
    """Numbers of the set's parameters.

    Args:
        data: The stance's arrays.
        cone: Exact cones or pyramids.
        basis: Basis of the balance rows kept, shape (6, rows).

    Returns:
        Values by parameter name; those a shape does not use are ignored by the engines.
    """
    bounds = bound_rows(data)
    mu = data.friction * (1.0 if cone.kind == "exact" else cone.slope_factor())
    joints = paired_joints(data)
    soft_mu = mu[data.circular - data.box : data.slipping]
    values = {
        "G": basis.T @ data.wrench_map,
        "load": basis.T @ data.load,
        "mu": mu,
        "gamma": data.torsion,
        "mu_over_gamma": soft_mu / data.torsion,
        "S_lower": bounds.lower,
        "lo": bounds.lower_values,
        "S_upper": bounds.upper,
        "hi": bounds.upper_values,
        "S_equal": bounds.equal,
        "equal": bounds.equal_values,
        "H": data.limit_rows if not len(joints) else data.limit_rows[: data.handle_limits],
        "T": data.torques.map[joints] if len(joints) else np.zeros((0, 0)),
        "limit": data.limit_values,
    }
    if cone.kind != "exact":
        values["face"] = cone.face_normals()
    return values


class Forces(NamedTuple):
    """The unknown forces as expressions in contact frames."""

    x: cp.Variable
    f_t: cp.Expression
    f_n: cp.Expression
    m_n: cp.Expression
    y: cp.Variable | None
    shape: ForceShape

    @property
    def variables(self) -> dict[str, cp.Variable]:
        """Variables by symbol: x, and y = T x where torque limits come in pairs."""
        return {"x": self.x} if self.y is None else {"x": self.x, "y": self.y}


def declare_forces(shape: ForceShape) -> Forces:
    """The unknown x and its parts; a part that the shape does not have is an empty constant."""
    s = shape
    x = cp.Variable(s.columns, name="x")
    ends = np.cumsum([0, 2 * s.slipping, s.points, s.box + s.elliptic])
    f_t, f_n, m_n = (x[a:b] if b > a else cp.Constant(np.zeros(0)) for a, b in zip(ends[:-1], ends[1:], strict=True))
    y = cp.Variable(s.joints, name="y") if s.joints else None
    return Forces(x, cp.reshape(f_t, (2, s.slipping), order="F") if s.slipping else f_t, f_n, m_n, y, s)


def wrench(forces: Forces) -> cp.Expression:
    """``G x``: the wrench of the contact forces on the balance rows kept."""
    return cp.Parameter((forces.shape.rows, forces.shape.columns), name="G") @ forces.x


def load(forces: Forces) -> cp.Parameter:
    """``L``: the impressed load on the balance rows kept."""
    return cp.Parameter(forces.shape.rows, name="load")


def admissible(
    forces: Forces, reserve: cp.Expression | float = 0.0, relief: cp.Expression | float = 0.0
) -> dict[str, cp.Constraint]:
    """Cones, bounds and hard rows of the set, every unilateral one shifted by a reserve of normal force.

    Args:
        forces: The unknowns.
        reserve: t, a scalar expression or 0.
        relief: What is added to the values of the limits, an expression of their number or 0.

    Returns:
        Constraints by name.
    """
    return {**_cones(forces, reserve), **_bounds(forces, reserve), **_hard_rows(forces, relief)}


def _cones(forces: Forces, reserve: cp.Expression | float) -> dict[str, cp.Constraint]:
    s, f_t, f_n, m_n = forces.shape, forces.f_t, forces.f_n, forces.m_n
    out: dict[str, cp.Constraint] = {}
    face = cp.Parameter((s.sides, 2), name="face") if s.sides else None
    if s.slipping:
        mu = cp.Parameter(s.slipping, name="mu", nonneg=True)
        slope = cp.multiply(mu, f_n[: s.slipping] - reserve)
        if s.circular:
            out |= _circular(s, face, slope[: s.circular], f_t[:, : s.circular])
        if s.box:
            gamma = cp.Parameter(s.box + s.elliptic, name="gamma", nonneg=True)
            spin, grip = m_n[: s.box], cp.multiply(gamma[: s.box], f_n[s.circular - s.box : s.circular] - reserve)
            out["torsion"] = cp.hstack([spin, -spin]) <= cp.hstack([grip, grip])
        if s.elliptic:
            ratio = cp.Parameter(s.box + s.elliptic, name="mu_over_gamma", nonneg=True)
            spin = cp.multiply(ratio[s.box :], m_n[s.box :])
            out |= _elliptic(s, face, slope[s.circular :], f_t[:, s.circular :], spin)
    if s.frictionless:
        out["unilateral"] = f_n[s.slipping :] - reserve >= 0
    return out


def _circular(s: ForceShape, face: cp.Parameter | None, slope: cp.Expression, f_t: cp.Expression) -> dict[str, cp.Constraint]:
    if face is not None:
        return {"friction": face @ f_t <= np.ones((s.sides, 1)) @ cp.reshape(slope, (1, s.circular), order="F")}
    if s.form == "sdp":
        return {f"friction[{i}]": disc_matrix(slope[i], f_t[:, i]) >> 0 for i in range(s.circular)}
    return {"friction": cp.SOC(slope, f_t, axis=0)}


def _elliptic(
    s: ForceShape, face: cp.Parameter | None, slope: cp.Expression, f_t: cp.Expression, spin: cp.Expression
) -> dict[str, cp.Constraint]:
    if face is not None:
        rows = [face @ f_t + np.ones((s.sides, 1)) @ cp.reshape(sign * spin, (1, s.elliptic), order="F") for sign in (1.0, -1.0)]
        return {"soft_finger": cp.vstack(rows) <= np.ones((2 * s.sides, 1)) @ cp.reshape(slope, (1, s.elliptic), order="F")}
    grip = cp.vstack([f_t, cp.reshape(spin, (1, s.elliptic), order="F")])
    if s.form == "sdp":
        return {f"soft_finger[{i}]": arrow_matrix(slope[i], grip[:, i]) >> 0 for i in range(s.elliptic)}
    return {"soft_finger": cp.SOC(slope, grip, axis=0)}


def disc_matrix(radius: cp.Expression, v: cp.Expression) -> cp.Expression:
    """``[[r + v_x, v_y], [v_y, r - v_x]]``, positive semidefinite exactly where |v| <= r, in two dimensions."""
    return cp.bmat([[radius + v[0], v[1]], [v[1], radius - v[0]]])


def arrow_matrix(radius: cp.Expression, v: cp.Expression) -> cp.Expression:
    """``[[r E, v], [v', r]]``, positive semidefinite exactly where |v| <= r."""
    n = v.size
    rows = [[radius if i == j else np.zeros(()) for j in range(n)] + [v[i]] for i in range(n)]
    return cp.bmat([*rows, [*(v[i] for i in range(n)), radius]])


def _bounds(forces: Forces, reserve: cp.Expression | float) -> dict[str, cp.Constraint]:
    s, f_n = forces.shape, forces.f_n
    out: dict[str, cp.Constraint] = {}
    if s.lower:
        out["lower_bound"] = cp.Parameter((s.lower, s.points), name="S_lower") @ f_n >= cp.Parameter(s.lower, name="lo") + reserve
    if s.upper:
        out["upper_bound"] = cp.Parameter((s.upper, s.points), name="S_upper") @ f_n <= cp.Parameter(s.upper, name="hi") - reserve
    return out


def _hard_rows(forces: Forces, relief: cp.Expression | float) -> dict[str, cp.Constraint]:
    """The rows that no reserve shifts: equal bounds and limits ``H x <= d + relief``."""
    s = forces.shape
    out: dict[str, cp.Constraint] = {}
    if s.equal:
        out["equal_bound"] = cp.Parameter((s.equal, s.points), name="S_equal") @ forces.f_n == cp.Parameter(s.equal, name="equal")
    if s.limits:
        limit = cp.Parameter(s.limits, name="limit")
        handles = s.limits - 2 * s.joints
        rows = [cp.Parameter((handles, s.columns), name="H") @ forces.x] if handles else []
        if forces.y is not None:
            out["joints"] = forces.y == cp.Parameter((s.joints, s.columns), name="T") @ forces.x
            rows += [-forces.y, forces.y]
        out["limits"] = cp.hstack(rows) <= limit + relief
    return out
