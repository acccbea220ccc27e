"""Prices: how much an optimum gains per unit of friction, limit, bound or contact displacement.

A price is the partial derivative of the Lagrangian at the optimum (envelope theorem). With the velocity u of each contact point under the
motion of the multipliers and the point forces f, the friction coefficient of a contact is worth ``-sum u_t . f_t / mu``, the power
that friction dissipates over mu, whatever the cone; a displacement of a contact along a world axis ``w x F``, with w the angular velocity
of its link and F its force; a bound or limit its multiplier. Where forces or multipliers are not unique the derivative may differ
with the sign of the change, and the price says so.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any, NamedTuple

import numpy as np

from socp_statics.certificates.faces import optimal_faces
from socp_statics.certificates.optimum import Multipliers, Optimum
from socp_statics.contacts.contact import COMPONENTS
from socp_statics.models.contact_forces_set import bound_rows
from socp_statics.spatial import Array, cross
from socp_statics.statics.statics_data import Indices

NEGLIGIBLE = 1e-6
SAME = 1e-6
# Share of the load that counts as the size of a bound or limit that is zero.
LEAST_LIMIT = 0.01


class Price(NamedTuple):
    """What one number of the stance is worth.

    Attributes:
        kind: "friction", "torsional_friction", "normal_force", "handle_limits", "torque_limits" or "displacement".
        name: The contact or joint.
        end: "lower", "upper" or "equal" of bounds and limits; of handles after the component, as "fx.lower"; the world axis "x", "y" or
            "z" of a displacement; else "".
        value: Gain per unit: of the coefficient, of the bound or limit as it widens (N or N m; an equal bound as it grows), or per
            metre of displacement.
        weight: Gain if the number changed by all of itself, for comparing prices [unit of the objective].
        unique: Whether decrease and increase gain the same but for the sign.
    """

    kind: str
    name: str
    end: str
    value: float
    weight: float
    unique: bool

    @property
    def words(self) -> str:
        """What it is the price of."""
        what = {
            "friction": "friction",
            "torsional_friction": "torsional friction",
            "normal_force": "fixed normal force" if self.end == "equal" else f"{self.end} normal-force bound",
            "handle_limits": f"{' '.join(self.end.split('.'))} limit",
            "torque_limits": f"{self.end} torque limit",
            "displacement": f"displacement along {self.end}",
        }
        return f"{self.name} {what[self.kind]}"

    @property
    def per(self) -> str:
        """Unit of the number that it is the price of."""
        moments = self.kind == "torque_limits" or self.end.startswith("m")
        return {"friction": "1", "torsional_friction": "m", "displacement": "m"}.get(self.kind, "N m" if moments else "N")


@dataclass(frozen=True)
class Prices:
    """The prices of an optimum.

    Attributes:
        objective: What gains: "margin", "com_margin", "payload", "push" or "shortfall" (which falls).
        unit: Its unit: "N", "m", "kg" or "N m".
        value: Its value.
        entries: All prices; those of limits that stop nothing are zero.
    """

    objective: str
    unit: str
    value: float
    entries: tuple[Price, ...]

    @property
    def stopping(self) -> tuple[Price, ...]:
        """Frictions, bounds and limits of which more would be worth something, the most important first."""
        found = [p for p in self.entries if p.kind != "displacement" and p.weight > 0.0]
        return tuple(sorted(found, key=lambda p: -round(p.weight, 9)))

    @property
    def moving(self) -> tuple[tuple[str, Array], ...]:
        """Contacts whose displacement would be worth something, the most important first, with the gain per metre along world x, y, z."""
        gain: dict[str, list[float]] = {}
        for price in self.entries:
            if price.kind == "displacement":
                gain.setdefault(price.name, []).append(price.value)
        found = [(name, np.array(vector)) for name, vector in gain.items() if any(vector)]
        most = max((float(np.linalg.norm(v)) for _, v in found), default=1.0)
        return tuple(sorted(found, key=lambda entry: -round(float(np.linalg.norm(entry[1])) / most, 9)))

    @property
    def unique(self) -> bool:
        """Whether every price is."""
        return all(p.unique for p in self.entries)

    def doubtful(self) -> Prices:
        """The same prices, none of them called unique."""
        return replace(self, entries=tuple(p._replace(unique=False) for p in self.entries))

    def of(self, kind: str, name: str, end: str = "") -> Price:
        """One price.

        Args:
            kind: Kind.
            name: Contact or joint.
            end: Which end of a bound or limit.

        Raises:
            KeyError: There is no such price.
        """
        for price in self.entries:
            if (price.kind, price.name, price.end) == (kind, name, end):
                return price
        raise KeyError((kind, name, end))

    def as_record(self) -> dict[str, Any]:
        """The record's entry: values by kind and name; bounds and limits that are worth nothing are left out."""
        out: dict[str, Any] = {"value": self.value, "unit": self.unit}
        for price in self.entries:
            table = out.setdefault(price.kind, {})
            if price.kind == "displacement":
                table.setdefault(price.name, []).append(price.value)
            elif price.kind in ("friction", "torsional_friction"):
                table[price.name] = price.value
            elif price.weight > 0.0:
                place = table.setdefault(price.name, {})
                *path, last = price.end.split(".")
                for part in path:
                    place = place.setdefault(part, {})
                place[last] = price.value
        return out | {
            "stopped_by": [{"what": p.words, "price": p.value, "per": p.per} for p in self.stopping],
            "unique": self.unique,
            "not_unique": [p.words for p in self.entries if not p.unique],
        }


@dataclass(frozen=True)
class Scale:
    """Name and unit of the objective, and what one scaled unit of it is in SI."""

    objective: str
    unit: str
    one: float


def prices_of(optimum: Optimum, scale: Scale) -> Prices:
    """The prices of an optimum.

    Args:
        optimum: Forces and multipliers.
        scale: What the objective is called and measured in.

    Returns:
        Prices in SI; what is below 1e-6 of the objective's unit when a number changes by all of itself is zero.
    """
    labels = _labels(optimum, scale)
    values = np.concatenate([_bilinear(optimum, optimum.x, optimum.multipliers), optimum.multipliers.packed[6:]])
    unique = _unique(optimum, values)
    entries = []
    for (kind, name, end, unit, amount), scaled, alone in zip(labels, values.tolist(), unique.tolist(), strict=True):
        if not optimum.coned and not kind.endswith("limits"):
            continue
        value = scaled * unit
        weight = abs(value) * amount
        counts = weight > NEGLIGIBLE * scale.one
        entries.append(Price(kind, name, end, value if counts else 0.0, weight if counts else 0.0, alone))
    return Prices(scale.objective, scale.unit, optimum.value * scale.one, tuple(entries))


def _bilinear(optimum: Optimum, x: Array, m: Multipliers) -> Array:
    """Prices of friction, torsional friction and displacement, linear in forces and in multipliers, scaled."""
    data = optimum.data
    u = optimum.contact_map @ m.packed
    slip = (u[data.tangential] * x[data.tangential]).reshape(-1, 2).sum(axis=1)
    friction, torsion = np.zeros(len(data.names)), np.zeros(len(data.names))
    np.add.at(friction, data.contact_of_point[: data.slipping], -slip / data.friction)
    np.add.at(torsion, _soft(optimum), -u[data.torsional] * x[data.torsional] / data.torsion)
    moved = cross(optimum.angular_velocities(m), optimum.resultants(x))
    return np.concatenate([friction[_sliding(optimum)], torsion[_soft(optimum)], moved.ravel()])


def _sliding(optimum: Optimum) -> Indices:
    """Contacts with friction."""
    return np.unique(optimum.data.contact_of_point[: optimum.data.slipping])


def _soft(optimum: Optimum) -> Indices:
    """Contact of each soft finger."""
    data = optimum.data
    return data.contact_of_point[data.circular - data.box : data.slipping]


def _unique(optimum: Optimum, values: Array) -> Any:
    """Which prices stay the same over the optimal faces."""
    faces, m = optimal_faces(optimum), optimum.multipliers
    n = len(values) - len(m.packed) + 6
    directions = [m.like(d) for d in faces.multipliers]
    change = np.zeros(len(values))
    for d in directions:
        change[:n] = np.maximum(change[:n], np.abs(_bilinear(optimum, optimum.x, d)))
        change[n:] = np.maximum(change[n:], np.abs(d.packed[6:]))
    for dx in faces.forces:
        for d in (m, *directions):
            change[:n] = np.maximum(change[:n], np.abs(_bilinear(optimum, dx, d)))
    return change <= SAME


def _labels(optimum: Optimum, scale: Scale) -> list[tuple[str, str, str, float, float]]:
    """Of each value in turn: kind, name, end, one scaled price in SI, and the size of the number that it is the price of [SI]."""
    data, one = optimum.data, scale.one
    W, length, names = data.units.force, data.units.length, data.names
    mu = {int(k): float(v) for k, v in zip(data.contact_of_point[: data.slipping], data.friction, strict=True)}
    out = [("friction", names[k], "", one, mu[int(k)]) for k in _sliding(optimum)]
    out += [("torsional_friction", names[k], "", one / length, g * length) for k, g in zip(_soft(optimum), data.torsion, strict=True)]
    out += [("displacement", name, axis, one / length, length) for name in names for axis in "xyz"]
    rows = bound_rows(data)
    for sums, ends, end in ((rows.lower, rows.lower_values, "lower"), (rows.upper, rows.upper_values, "upper"),
                            (rows.equal, rows.equal_values, "equal")):  # fmt: skip
        for row, value in zip(sums, ends, strict=True):
            owner = names[data.contact_of_point[int(np.argmax(row))]]
            out.append(("normal_force", owner, end, one / W, W * max(float(value), LEAST_LIMIT)))
    for row, value in zip(data.limit_rows[: data.handle_limits], data.limit_values, strict=False):
        (j,) = np.flatnonzero(row[data.handle])
        i = int(data.component_of_handle[j])
        unit = W if i < 3 else W * length
        end = f"{COMPONENTS[i]}.{'upper' if row[data.handle][j] > 0 else 'lower'}"
        amount = unit * max(abs(float(value)), LEAST_LIMIT)
        out.append(("handle_limits", names[data.contact_of_handle[j]], end, one / unit, amount))
    limits = data.torques.limits
    for column, end in ((1, "upper"), (0, "lower")):
        for k in np.flatnonzero(np.isfinite(limits[:, column])):
            amount = W * length * max(abs(float(limits[k, column])), LEAST_LIMIT)
            out.append(("torque_limits", data.torques.names[k], end, one / (W * length), amount))
    return out
