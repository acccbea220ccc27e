"""A suite of programs: every model on stances of every kind of contact, and the margin program's constraints written out again."""

from __future__ import annotations

from functools import cache
from typing import Any, NamedTuple

import numpy as np

from socp_statics.cones.choice import ConeChoice
from socp_statics.contacts import (
    ContactSet,
    ExternalWrench,
    FrictionlessPointContact,
    FrictionlessSurfaceContact,
    Handle,
    LineContact,
    PointContact,
    SoftFingerContact,
    Stance,
    SurfaceContact,
)
from socp_statics.models import MODELS
from socp_statics.models.capability import CapabilityShape
from socp_statics.models.contact_forces import ContactForcesShape
from socp_statics.models.contact_forces_set import force_shape, force_values
from socp_statics.models.disturbance import DisturbanceShape
from socp_statics.models.force_rule import RuleShape
from socp_statics.models.hard_rows import hard_values
from socp_statics.models.inscribed_ellipsoid import EllipsoidShape, padded
from socp_statics.models.minimax_wrench import MinimaxShape
from socp_statics.models.orin_oh import OrinOhShape
from socp_statics.models.posture_optimization import PostureStepShape
from socp_statics.models.repeated_forces import block_rows, repeated_forces
from socp_statics.models.rule_check import RuleCheckShape
from socp_statics.models.support_region import RegionShape
from socp_statics.models.torque_feasibility import TorqueShape
from socp_statics.optimization.force_rows import force_rows, groups
from socp_statics.optimization.minimax_wrench import MEASURES, measured
from socp_statics.stability.robustness.load_slice import resultant_map
from socp_statics.statics import assemble, wrench_range

UP = (0.0, 0.0, 1.0)
COMPONENTS = ("fx", "fy", "fz", "mx", "my", "mz")
CONES = {
    "socp": (ConeChoice(), "socp"),
    "sdp": (ConeChoice(), "sdp"),
    "inscribed": (ConeChoice("inscribed", 5, 0.3), "socp"),
    "circumscribed": (ConeChoice("circumscribed", 4), "socp"),
}


def foot(name, x, y, normal=UP, mu=0.6, **more):
    return SurfaceContact(name, [x, y, 0.0], normal=normal, friction=mu, size=[0.22, 0.13], **more)


def limited(k):
    limits = {"fx": (-90.0, 60.0 + k), "fz": (-100.0, 100.0), "mx": (-5.0, 5.0)}
    return Handle("rail", [0.3, 0.1, 0.9], rpy=[0.1, 0.2, 0.3], transmits=["fx", "fy", "fz", "mx"], limits=limits)


def contacts_of(kind: str, k: float) -> list[Any]:
    """Contacts of a stance of the suite; k in [0, 1] changes every number but not the structure."""
    tilt = 0.1 * k
    match kind:
        case "feet":
            return [foot("left", 0, 0.1, mu=0.6 - tilt), SurfaceContact("right", [0, -0.1, 0], normal=[tilt, 0, 1], friction=0.5,
                    vertices=[[-0.1, -0.05], [0.1, -0.06], [0.12, 0.05]])]  # fmt: skip
        case "points":
            spots = [(0.3, 0.0, 0.0), (-0.2, 0.25, 0.1), (-0.2, -0.25 - tilt, 0.05)]
            normals = [(-0.3, 0.1, 1), (0.2, -0.4, 1), (0.1 + tilt, 0.3, 1)]
            return [PointContact(f"p{i}", p, normal=n, friction=0.7) for i, (p, n) in enumerate(zip(spots, normals, strict=True))]
        case "wall hand":
            return [foot("foot", 0, 0, normal=(tilt, 0, 1)), PointContact("hand", [0.5, 0.1, 1.2], normal=(-1, tilt, 0.1), friction=0.4)]
        case "elliptic":
            fingers = [(-0.2, (0.2, 0, 1)), (0.2, (-0.3, tilt, 1))]
            return [SoftFingerContact(f"finger{i}", [x, tilt, 0], normal=n, friction=0.6, torsional_friction=0.05)
                    for i, (x, n) in enumerate(fingers)]  # fmt: skip
        case "box and line":
            thumb = SoftFingerContact("thumb", [0.3, 0, tilt], normal=(-0.2, 0, 1), friction=0.5, torsional_friction=0.03, shape="box")
            return [thumb, LineContact("edge", [-0.1, 0, 0], rpy=[0, 0.1, 1.4 + tilt], friction=0.5, size=[0.4])]
        case "frictionless":
            return [FrictionlessSurfaceContact("plate", [0, 0, 0], normal=(tilt, 0, 1), size=[0.4, 0.3]),
                    FrictionlessPointContact("wall", [0.4, 0.1, 0.5], normal=(-1, 0.1, 0.1)),
                    PointContact("peg", [-0.3, -0.1, 0.2], normal=(0.4, 0.1, 1), friction=0.5 + tilt)]  # fmt: skip
        case "bounds":
            return [foot("left", 0, 0.15, normal_force=[20, 400 + 50 * k]), PointContact("prop", [0.3, -0.2, 0], normal=UP, friction=0.4,
                    normal_force=[100 + k, 100 + k]), foot("right", -0.1, -0.15, normal_force=[250, np.inf])]  # fmt: skip
        case "upper bound":
            return [foot("left", 0, 0.15, normal_force=[20, 200 + 10 * k]), foot("right", -0.1, -0.15)]
        case "handle":
            return [foot("foot", 0, 0, normal=(0.2 + tilt, 0, 1)), limited(k)]
        case "grip":
            limits = {word: (-1000.0 - k, 900.0) for word in COMPONENTS}
            return [Handle("bar", [0.1, 0, 2.0 + tilt], rpy=[0, 0.1, 0], transmits=COMPONENTS, limits=limits)]
        case "chimney":
            return [SurfaceContact("left", [0, 0.4, 0.1 * k], normal=(0, -1, tilt), friction=0.8, size=[0.2, 0.1]),
                    SurfaceContact("right", [0, -0.4, 0], normal=(0, 1, 0), friction=0.7, size=[0.2, 0.1])]  # fmt: skip
        case "two points":
            return [PointContact(f"p{i}", [x, 0.2 * x, 0], normal=UP, friction=0.5 + tilt) for i, x in enumerate((-0.3, 0.2))]
        case "all types":
            return [limited(k), foot("foot", 0, 0.1, normal_force=[0, 500]), *contacts_of("box and line", k),
                    SoftFingerContact("finger", [0.2, 0.3, 0.1], normal=(0, -0.2, 1), friction=0.6, torsional_friction=0.05),
                    PointContact("peg", [-0.3, -0.1, 0.2], normal=(0.4, 0.1, 1), friction=0.5),
                    FrictionlessPointContact("wall", [0.4, 0.1, 0.5], normal=(-1, 0.1, 0.1 + tilt))]  # fmt: skip
    raise KeyError(kind)


COM = {"elliptic": (0.0, 0.0, 0.4), "two points": (0.0, 0.0, 0.5), "grip": (0.2, 0.1, 1.2)}
PUSHED = ("wall hand", "all types", "handle")
KINDS = ("feet", "points", "wall hand", "elliptic", "box and line", "frictionless", "bounds", "upper bound", "handle", "grip", "chimney",
         "two points", "all types", "outside")  # fmt: skip


@cache
def stance_of_kind(kind: str, k: float = 0.0) -> Stance:
    """A stance of the suite."""
    wrenches = (ExternalWrench(force=(20.0, 5.0 + k, 0.0), moment=(0.0, 1.0, 2.0), point=(0.0, 0.0, 1.0)),) if kind in PUSHED else ()
    if kind == "outside":
        return Stance(ContactSet(contacts_of("feet", k)), (0.4 + 0.1 * k, 0.0, 0.8), 60.0)
    x, y, z = COM.get(kind, (0.02, 0.01, 0.8))
    on_line = kind == "two points"
    com = (x + 0.01 * k, y + (0.002 if on_line else 0.01) * k, z)
    return Stance(ContactSet(contacts_of(kind, k)), com, 60.0, external_wrenches=wrenches)


class Question(NamedTuple):
    """One program: a model, its shape and the numbers of its parameters."""

    model: Any
    shape: Any
    values: dict[str, Any]


def _least_squares(data, reach, shape, values):
    F = np.vstack([force_rows(data, g) for g in groups(data, "point")])
    F = F[np.abs(F).sum(axis=1) > 0]
    return {"least_squares": (ContactForcesShape(shape, "least_squares", len(F)), values | {"F": F, "reference": np.zeros(len(F))})}


def _contact_forces(data, reach, shape, values):
    g = groups(data, "contact")[0]
    F, wanted = data.rotation[g.contact] @ force_rows(data, g), np.array([0.1, -0.05, 0.3])
    return _least_squares(data, reach, shape, values) | {
        "normal_force": (ContactForcesShape(shape, "normal_force", 0), values),
        "reference": (ContactForcesShape(shape, "reference", 3), values | {"F": F, "reference": wanted}),
    }


def _minimax(data, reach, shape, values):
    out = {}
    for measure in MEASURES:
        what = measured(data, ConeChoice(), measure, "contact", 0.1 / data.units.length)
        more: dict[str, Any] = {"F": what.rows, "cap": 1.0}
        if measure == "friction_use":
            more |= {"s_mu_N": 0.7 * what.grip, "s_mu_n": 0.7 * what.points * what.grip.max(axis=1, initial=0.0)}
        if what.groups:
            out[measure] = (MinimaxShape(shape, measure, what.groups), values | more)
    return out


def _region(data, reach, shape, values):
    more = {"D": reach.basis.T @ data.com_load, "direction": [0.6, 0.8], "box": [3.0, 3.0]}
    return {"clipped" if clip else "open": (RegionShape(shape, 2, clip), values | more) for clip in (True, False)}


def _load(data, reach, shape, values):
    normal = np.zeros(data.wrench_map.shape[1])
    normal[data.normal][data.contact_of_point == data.contact_of_point.max(initial=0)] = 1.0
    return {"": (RegionShape(shape, 2, False), values | {"D": reach.basis.T @ data.com_load, "c": normal, "cap": 1.0})}


def _reserve(data, reach, shape, values):
    return {"": (RegionShape(shape, 2, False), values | {"D": reach.basis.T @ data.com_load, "cap": 1.0})}


def _joint_rows(columns):
    """Rows like those of two joints: smooth, and different for every unknown."""
    return np.sin(np.arange(1, columns + 1)[None] * np.array([[0.7], [1.3]])) / 3


def _torques(data, reach, shape, values):
    more = {"U": _joint_rows(shape.columns), "u": np.array([0.4, 0.7]), "v": np.array([0.05, -0.1])}
    return {"": (TorqueShape(shape, 2), values | more)}


def _posture(data, reach, shape, values):
    """Two motions within joint limits that change balance and torques; for a CoM margin forces in two directions."""
    waves = np.sin(np.arange(1, 2 * shape.rows + 1).reshape(shape.rows, 2)) / 10
    motion = {"Q": np.array([[1.0, -1.0], [-1.0, 0.5]]), "room": np.array([0.05, 0.02]), "trust": 0.1, "cap": 1.0, "rho": 1e-6}
    limits = {"V": np.array([[0.2, -0.1], [0.1, 0.3]]), "d_torque": np.array([0.45, 0.6]), "u_torque": np.array([0.4, 0.7])}
    one = values | motion | limits | {"A": waves, "H_torque": _joint_rows(shape.columns)}
    both = repeated_forces(shape, values, 2)
    two = both.values | motion | {name: np.concatenate([value, value]) for name, value in limits.items()}
    two |= {
        "A": np.vstack([waves, -waves]),
        "H_torque": block_rows(_joint_rows(shape.columns), both.columns, both.shape.columns),
        "D": np.kron(np.eye(2), reach.basis.T @ data.com_load),
        "d": np.array([[0.6, 0.8, 0.0, 0.0], [0.0, 0.0, -1.0, 0.0]]),
    }
    return {name: (PostureStepShape(shape, 2, 2, 2, name), one) for name in ("margin", "torque")} | {
        "com_margin": (PostureStepShape(both.shape, 2, 4, 2, "com_margin", 2), two)
    }


def _orin_oh(data, reach, shape, values):
    more = {"P": _joint_rows(shape.columns), "p0": np.array([0.1, -0.2]), "b": 0.5}
    return {"joints": (OrinOhShape(shape, 2), values | more), "no joints": (OrinOhShape(shape, 0), values | more)}


def _capability(data, reach, shape, values):
    """A payload above the centre of the contacts, where limits are eased and tightened by it in turn."""
    point, force = np.array([0.3, -0.2, 0.5]), np.array([0.2, 0.1, -1.0])
    P = np.concatenate([force, np.cross(point, force)])
    reach = wrench_range(np.hstack([data.wrench_map, P[:, None]]))
    shape = shape._replace(rows=reach.rank)
    more = {"G": reach.basis.T @ data.wrench_map, "load": reach.basis.T @ data.load, "P": reach.basis.T @ P, "cap": 1.0}
    more["r"] = 0.1 * np.sin(np.arange(shape.limits))
    return {"capped" if cap else "open": (CapabilityShape(shape, cap), values | more) for cap in (False, True)}


def _pushes(data, reach, shape):
    """Pushes at a point above the contacts in two coordinates, as far as the contacts can resist them."""
    point, axes = np.array([0.2, -0.1, 0.6]), np.array([[0.8, 0.1], [0.2, -0.7], [0.1, 0.3]])
    B = reach.basis.T @ np.vstack([axes, np.cross(point, axes.T).T])
    return {"B": B, "R": 0.1 * np.sin(np.arange(2 * shape.limits)).reshape(-1, 2)}


def _disturbance(data, reach, shape, values):
    """One direction of pushes; with limited sums of forces too."""
    more = _pushes(data, reach, shape) | {"clip": 3.0, "direction": np.array([0.6, -0.8])}
    few = more | {"F_contact": resultant_map(data), "total": 3.0}
    return {"free": (DisturbanceShape(shape, 2, 0), values | more), "total": (DisturbanceShape(shape, 2, len(data.names)), values | few)}


def _force_rule(data, reach, shape, values):
    return {"": (RuleShape(shape._replace(joints=0), 2), values | _pushes(data, reach, shape) | {"cap": 3.0})}


def _rule_check(data, reach, shape, values):
    """Quadratics of as many cones as there are points with friction, most of them nonnegative on the disc."""
    rows = np.sin(np.arange(1, 9 * max(data.slipping, 1) + 1)).reshape(-1, 3, 3)
    return {"": (RuleCheckShape(len(rows), 2), {"Q": np.vstack([2.0 * np.outer(r[0], r[0]) + np.eye(3) - r[1:].T @ r[1:] for r in rows])})}


def _inscribed_ellipsoid(data, reach, shape, values):
    """Inside the half-spaces of as many directions as there are unknowns, in the plane and in space."""
    out = {}
    for name, k in (("plane", 2), ("space", 3)):
        normals = np.vstack([np.eye(k), -np.eye(k), np.sin(np.arange(k * data.wrench_map.shape[1]) ** 1.5).reshape(-1, k)])
        normals = normals[np.linalg.norm(normals, axis=1) > 0.1]
        a, b = padded(normals / np.linalg.norm(normals, axis=1)[:, None], 1.0 + 0.2 * np.cos(np.arange(len(normals))))
        out[name] = (EllipsoidShape(*a.shape), {"a": a, "b": b})
    return out


def _hard_rows(data, reach, shape, values):
    return {"": hard_values(data, reach.basis)}


def _margin(data, reach, shape, values):
    return {"": (shape, values | {"cap": 1.0})}


BUILDERS = {
    "equilibrium": _margin,
    "contact_forces": _contact_forces,
    "minimax_wrench": _minimax,
    "support_region": _region,
    "contact_load": _load,
    "largest_reserve": _reserve,
    "disturbance": _disturbance,
    "force_rule": _force_rule,
    "rule_check": _rule_check,
    "inscribed_ellipsoid": _inscribed_ellipsoid,
    "hard_rows": _hard_rows,
    "capability": _capability,
    "torque_feasibility": _torques,
    "orin_oh": _orin_oh,
    "posture_optimization": _posture,
}


@cache
def questions(model: str, kind: str, cone: str, k: float = 0.0) -> dict[str, Question]:
    """The programs of a model on a stance of the suite, by variant."""
    choice, form = CONES[cone]
    data = assemble(stance_of_kind(kind, k))
    reach = wrench_range(data.wrench_map)
    shape, values = force_shape(data, choice, form, reach.rank), force_values(data, choice, reach.basis)
    return {name: Question(MODELS.load(model), s, v) for name, (s, v) in BUILDERS[model](data, reach, shape, values).items()}


VARIANTS = {
    "contact_forces": ("least_squares", "normal_force", "reference"),
    "minimax_wrench": MEASURES,
    "support_region": ("clipped", "open"),
    "capability": ("open", "capped"),
    "disturbance": ("free", "total"),
    "inscribed_ellipsoid": ("plane", "space"),
    "orin_oh": ("joints", "no joints"),
    "posture_optimization": ("margin", "torque", "com_margin"),
}


def turn(model: str, kind: str, cone: str) -> str:
    """The variant of a model whose turn it is on a stance; variants take turns over stances and cones."""
    asked, wanted = questions(model, kind, cone), VARIANTS.get(model, ("",))
    start = (KINDS.index(kind) + list(CONES).index(cone)) % len(wanted)
    return next(name for name in (*wanted[start:], *wanted) if name in asked)


def margin_constraints(kind: str, cone: str):
    """Length of x, and constraint functions by name: (cone, (x, t) -> value), from the chapter's inequalities."""
    choice, form = CONES[cone]
    d = assemble(stance_of_kind(kind))
    basis = wrench_range(d.wrench_map).basis
    slope = 1.0 if choice.kind == "exact" else choice.slope_factor()
    as_box = choice.kind == "circumscribed"
    circular = d.slipping if as_box else d.circular
    box = d.box + (d.elliptic if as_box else 0)
    out: dict[str, Any] = {
        "balance": ("zero", lambda x, t: basis.T @ (d.wrench_map @ x + d.load)),
        "cap": ("le", lambda x, t: np.array([t - 1.0])),
    }
    f_t, f_n, m_n = (lambda x: x[d.tangential].reshape(-1, 2)), (lambda x: x[d.normal]), (lambda x: x[d.torsional])

    def grip(x, t):
        return d.friction * slope * (f_n(x)[: d.slipping] - t)

    def disc(r, v):
        return np.array([[r + v[0], v[1]], [v[1], r - v[0]]])

    def arrow(r, v):
        return np.block([[r * np.eye(len(v)), v[:, None]], [v[None], np.array([[r]])]])

    def ball(x):
        spin = m_n(x)[box:] * (slope * d.friction[circular:] / d.torsion[box:])
        return np.column_stack([f_t(x)[circular:], spin])

    if circular and choice.kind != "exact":
        out["friction"] = ("le", lambda x, t: (choice.face_normals() @ f_t(x)[:circular].T - grip(x, t)[:circular]).ravel("F"))
    elif circular and form == "sdp":
        out |= {f"friction[{i}]": ("psd", lambda x, t, i=i: disc(grip(x, t)[i], f_t(x)[i])) for i in range(circular)}
    elif circular:
        out["friction"] = ("soc", lambda x, t: np.column_stack([grip(x, t)[:circular], f_t(x)[:circular]]))
    if box:
        hold = slice(circular - box, circular)
        out["torsion"] = ("le", lambda x, t: np.hstack([m_n(x)[:box], -m_n(x)[:box]]) - np.tile(d.torsion[:box] * (f_n(x)[hold] - t), 2))
    if d.slipping > circular and choice.kind == "inscribed":

        def rows(x, t, s):
            return choice.face_normals() @ ball(x)[:, :2].T + s * ball(x)[:, 2] - grip(x, t)[circular:]

        out["soft_finger"] = ("le", lambda x, t: np.vstack([rows(x, t, 1), rows(x, t, -1)]).ravel("F"))
    elif d.slipping > circular and form == "sdp":
        more = range(d.slipping - circular)
        out |= {f"soft_finger[{i}]": ("psd", lambda x, t, i=i: arrow(grip(x, t)[circular + i], ball(x)[i])) for i in more}
    elif d.slipping > circular:
        out["soft_finger"] = ("soc", lambda x, t: np.column_stack([grip(x, t)[circular:], ball(x)]))
    if d.frictionless:
        out["unilateral"] = ("le", lambda x, t: t - f_n(x)[d.slipping :])
    S, (lo, hi) = (d.contact_of_point == d.bounded[:, None]).astype(float), d.bounds.T
    equal, upper = lo == hi, np.isfinite(hi) & (lo != hi)
    if (~equal).any():
        out["lower_bound"] = ("le", lambda x, t: (lo + t - S @ f_n(x))[~equal])
    if upper.any():
        out["upper_bound"] = ("le", lambda x, t: (S[upper] @ f_n(x) - (hi[upper] - t)))
    if equal.any():
        out["equal_bound"] = ("zero", lambda x, t: (S @ f_n(x) - lo)[equal])
    if len(d.limit_values):
        out["limits"] = ("le", lambda x, t: d.limit_rows @ x - d.limit_values)
    return d.wrench_map.shape[1], out


def outside_cone(kind: str, value: np.ndarray) -> float:
    """How far a value is outside its cone; multipliers of `le` rows are given with the sign changed."""
    match kind:
        case "zero":
            return float(np.abs(value).max())
        case "le":
            return float(value.max())
        case "soc":
            return float((np.linalg.norm(value[:, 1:], axis=1) - value[:, 0]).max())
    return -float(np.linalg.eigvalsh(0.5 * (value + value.T))[0])


def lagrangian(n: int, constraints, duals):
    """(x, t) -> sum of multipliers times constraints, cones entering with a minus."""
    sign = {"zero": 1.0, "le": 1.0, "soc": -1.0, "psd": -1.0}

    def value(z):
        return sum(sign[k] * float(duals[name] @ c(z[:n], z[n]).ravel("F" if k == "psd" else "C")) for name, (k, c) in constraints.items())

    return value, np.array([value(e) - value(np.zeros(n + 1)) for e in np.eye(n + 1)])
