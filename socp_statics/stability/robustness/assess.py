"""How robust is a posture? The measures that are asked for, each in its unit."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from socp_statics.cones.choice import ConeChoice, cone_choice
from socp_statics.contacts import ExternalWrench, Stance
from socp_statics.contacts.numbers import scalar, vector
from socp_statics.contacts.stance import stance_of
from socp_statics.exceptions import InputError
from socp_statics.registry import nearest
from socp_statics.spatial import Array
from socp_statics.stability.equilibrium import EquilibriumAnswer, check_equilibrium
from socp_statics.stability.robustness.ball import Settings, largest_ball, largest_tilt
from socp_statics.stability.robustness.disturbances import HORIZONTAL, Disturbance, com_errors, mass_errors, moments, pushes, wrenches
from socp_statics.stability.robustness.ellipsoid import ellipsoid_measure
from socp_statics.stability.robustness.friction import critical_friction, friction_interval
from socp_statics.stability.robustness.measure import Measure, listed, no_reserve
from socp_statics.stability.robustness.placement import contact_placement
from socp_statics.stability.robustness.push_rule import push_rule, rule_measure
from socp_statics.statics import StaticsData, assemble

UNITS = {
    "push": "N",
    "force": "N",
    "wrench": "N",
    "com": "m",
    "tilt": "deg",
    "friction": "1",
    "friction_interval": "N",
    "mass_and_com": "1",
    "placement": "m",
    "push_ellipsoid": "N",
    "moment_ellipsoid": "N m",
    "push_rule": "N",
}
MEASURES = tuple(UNITS)
DEFAULT_MEASURES = ("push", "force", "com", "tilt", "friction", "placement")
TOLERANCE = 1e-3
LENGTH = 1.0
# One unit of the ellipsoid in (m, m c) unless a shape is given: a tenth of the mass, and 10 mm of the centre of mass times the mass.
MASS_SHARE, FIRST_MOMENT_LENGTH = 0.1, 0.01


@dataclass(frozen=True, eq=False)
class RobustnessAnswer:
    """Measures of robustness, and the verdict they are about.

    Attributes:
        measures: By name, in the order asked.
        equilibrium: Verdict, margin and certificate of the posture as it is.
        point: Where pushes act, world axes, shape (3,) [m].
        link: Link of the robot they act on, or None.
        length: Characteristic length of wrenches [m].
        shape: Of the ellipsoid in (m, m c), shape (4, 4) [kg, kg m].
    """

    measures: dict[str, Measure]
    equilibrium: EquilibriumAnswer
    point: Array
    link: str | None
    length: float
    shape: Array

    def __getitem__(self, name: str) -> Measure:
        return self.measures[name]

    def as_record(self) -> dict[str, Any]:
        """The record's ``robustness``."""
        more: dict[str, dict[str, Any]] = {
            "push": {"point": listed(self.point), "link": self.link},
            "push_ellipsoid": {"point": listed(self.point), "link": self.link},
            "push_rule": {"point": listed(self.point), "link": self.link},
            "wrench": {"length": self.length},
            "mass_and_com": {"shape": [listed(row) for row in self.shape]},
        }
        return {name: measure.as_record() | more.get(name, {}) for name, measure in self.measures.items()}


def measure_robustness(
    contacts: Any,
    com: Any = None,
    mass: float | None = None,
    *,
    measures: Iterable[str] = DEFAULT_MEASURES,
    point: Any = None,
    link: str | None = None,
    length: float = LENGTH,
    ellipsoid: Any = None,
    friction_intervals: Mapping[str, Any] | None = None,
    tolerance: float = TOLERANCE,
    cone: str | ConeChoice = "exact",
    sides: int | None = None,
    heading: float | None = None,
    form: str = "socp",
    engine: str | Sequence[str] = "auto",
    gravity: Any = None,
    external_wrenches: Iterable[ExternalWrench | dict[str, Any]] = (),
    torque_limits: bool | Mapping[str, Any] = False,
) -> RobustnessAnswer:
    """How much may go wrong before a posture no longer holds.

    Args:
        contacts: Contacts; a Stance, which brings everything else; or a Posture, which brings centre of mass and mass.
        com: Centre of mass in world axes, shape (3,) [m].
        mass: Mass [kg].
        measures: Of ``push`` (any horizontal force at the point [N]), ``force`` (any force at the centre of mass [N]), ``wrench`` (any
            wrench about it, moments over ``length`` [N]), ``com`` (any displacement of the centre of mass [m]), ``tilt`` (of gravity in
            any direction [deg]), ``friction`` (smallest common scale of all coefficients that holds), ``friction_interval`` (least margin
            over intervals [N]), ``mass_and_com`` (largest scaling of an ellipsoid in (m, m c)), ``placement`` (of every contact [m]),
            ``push_ellipsoid`` (geometric mean of the semi-axes of the largest ellipsoid of horizontal pushes at the point, wherever its
            centre [N]), ``moment_ellipsoid`` (the same of moments on the base [N m]), ``push_rule`` (as ``push``, by forces ``f_0 + F u``
            [N]); the last three are semidefinite programs.
        point: Where pushes act, world axes, shape (3,) [m]; the centre of mass by default.
        link: Link of the robot they act on; the base by default. Their torques count where torque limits do.
        length: Characteristic length of wrenches [m].
        ellipsoid: Maps the unit ball to errors of ``(m, m c)``, shape (4, 4) [kg, kg m], or its diagonal, shape (4,); by default a tenth of
            the mass and 10 mm times the mass.
        friction_intervals: ``[lo, hi]`` of the friction coefficient by contact, "default" for the others.
        tolerance: Relative width of a bracket that counts as exact, between 0 and 1.
        cone: "exact", "inscribed" or "circumscribed", or a ConeChoice.
        sides: Sides of the pyramids.
        heading: Heading of the pyramids [rad].
        form: "socp" or "sdp".
        engine: "auto", the name of an engine, or several to be tried in turn.
        gravity: Acceleration of gravity in world axes, shape (3,) [m/s^2].
        external_wrenches: Wrenches impressed on the robot.
        torque_limits: Whether forces have to respect joint-torque limits: the robot's own, or a mapping of limits. Errors of the centre of
            mass and of the mass leave gravity torques and Jacobians of the posture as they are.

    Returns:
        The measures.

    Raises:
        InputError: A number, name or choice is wrong.
        EngineError: No engine settled a program.
    """
    stance = stance_of(contacts, com, mass, gravity, external_wrenches, torque_limits)
    settings = Settings(cone_choice(cone, sides, heading), form, engine, checked_tolerance(tolerance))
    question = _Question(stance, settings, checked_measures(measures), point, link, length, ellipsoid, friction_intervals)
    return question.answer()


def checked_measures(measures: Iterable[str]) -> tuple[str, ...]:
    """Names of measures, each once.

    Raises:
        InputError: One is not known, or there is none.
    """
    names = (measures,) if isinstance(measures, str) else tuple(measures)
    for name in names:
        if name not in MEASURES:
            raise InputError(f"measure {name!r} is not known{nearest(str(name), MEASURES)}", name=str(name), field="measures")
    if not names:
        raise InputError(f"measures: at least one of {', '.join(MEASURES)} is expected, got none", name="measures", field="measures")
    return tuple(dict.fromkeys(names))


def checked_tolerance(tolerance: float) -> float:
    """A tolerance between 0 and 1.

    Raises:
        InputError: It is not.
    """
    value = scalar("robustness", "tolerance", tolerance, above=0.0, kind="question")
    if value >= 1.0:
        raise InputError(f"question 'robustness': tolerance must be < 1, got {tolerance!r}", name="robustness", field="tolerance")
    return value


def checked_ellipsoid(ellipsoid: Any, mass: float) -> Array:
    """Shape of the ellipsoid in (m, m c).

    Args:
        ellipsoid: None, four semi-axes, or a matrix.
        mass: Mass [kg].

    Returns:
        Symmetric positive semidefinite, shape (4, 4) [kg, kg m].

    Raises:
        InputError: It is of another size, not finite, not symmetric or not positive semidefinite.
    """
    if ellipsoid is None:
        return np.diag([MASS_SHARE * mass] + 3 * [FIRST_MOMENT_LENGTH * mass])
    flat = np.ndim(ellipsoid) == 1
    given = vector("robustness", "ellipsoid", ellipsoid, 4, shape=(4,) if flat else (4, 4), kind="question")
    matrix = np.diag(given) if flat else np.array(given)
    wrong = not np.allclose(matrix, matrix.T) or float(np.linalg.eigvalsh(matrix)[0]) < -1e-12 * float(np.abs(matrix).max())
    if wrong or not matrix.any():
        message = "question 'robustness': ellipsoid must be symmetric, positive semidefinite and not zero"
        raise InputError(f"{message}, got {matrix.tolist()}", name="robustness", field="ellipsoid")
    return matrix


class _Question:
    """One stance, and what is asked about it."""

    def __init__(self, stance: Stance, settings: Settings, names: tuple[str, ...], point: Any, link: str | None, length: float,
                 ellipsoid: Any, intervals: Mapping[str, Any] | None):  # fmt: skip
        self.stance, self.settings, self.names = stance, settings, names
        self.link, self.point = link, self._point(point, link)
        self.length = scalar("robustness", "length", length, above=0.0, kind="question")
        self.shape = checked_ellipsoid(ellipsoid, stance.mass)
        self.intervals = intervals
        if "friction_interval" in names and not intervals:
            message = "friction_intervals are missing, the measure 'friction_interval' needs [lo, hi] by contact, or as 'default'"
            raise InputError(message, name="friction_interval", field="friction_intervals")
        self.data: StaticsData = assemble(stance)
        self.equilibrium = check_equilibrium(stance, cone=settings.cone, form=settings.form, engine=settings.engine)

    def _point(self, point: Any, link: str | None) -> Array:
        posture = self.stance.posture
        if link is not None and posture is None:
            raise InputError(f"link {link!r} of the push needs a robot, this stance has none", name=link, field="link")
        origin = self.stance.com if link is None else posture.link_placement(link)[1]
        return np.array(origin if point is None else vector("robustness", "point", point, 3, kind="question"))

    def answer(self) -> RobustnessAnswer:
        """All measures."""
        found: dict[str, Measure] = {}
        for name in self.names:
            found[name] = self._measure(name, found)
        return RobustnessAnswer(found, self.equilibrium, self.point, self.link, self.length, self.shape)

    def _measure(self, name: str, found: Mapping[str, Measure]) -> Measure:
        stance, data, settings, unit = self.stance, self.data, self.settings, UNITS[name]
        if name == "friction":
            return critical_friction(stance, settings)
        if name == "friction_interval":
            assert self.intervals is not None
            return friction_interval(stance, self.intervals, settings)
        if not self.equilibrium.stable:
            return no_reserve(name, unit, self.equilibrium.verdict)
        match name:
            case "tilt":
                return largest_tilt(stance, data, settings)
            case "placement":
                return self._placement(found)
            case "push_ellipsoid":
                return ellipsoid_measure(name, unit, data, self._pushes, settings)
            case "moment_ellipsoid":
                return ellipsoid_measure(name, unit, data, moments(data), settings)
            case "push_rule":
                disc = found.get("push") or self._measure("push", found)
                return rule_measure(name, unit, push_rule(data, self._pushes, settings), disc, settings.tolerance)
            case "push":
                what = self._pushes
            case "force":
                what = pushes(stance, data, np.array(stance.com), None, np.eye(3))
            case "wrench":
                what = wrenches(data, np.array(stance.com), self.length)
            case "com":
                what = com_errors(stance, data)
            case _:
                what = mass_errors(stance, data, self.shape)
        return largest_ball(name, unit, data, what, settings)

    @property
    def _pushes(self) -> Disturbance:
        return pushes(self.stance, self.data, self.point, self.link, HORIZONTAL)

    def _placement(self, found: Mapping[str, Measure]) -> Measure:
        if self.stance.torque_limits is not None:
            note = "not answered with torque limits: displaced contacts change the joint torques too"
            return Measure("placement", None, UNITS["placement"], None, note=note)
        com_error = found.get("com") or self._measure("com", found)
        return contact_placement(self.stance, self.data, self.equilibrium, com_error, self.settings)
