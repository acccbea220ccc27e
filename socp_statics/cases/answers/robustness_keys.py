"""The record's ``robustness``: what a measure's entry can hold."""

from typing import Any

from socp_statics.cases.answers.answer import RECORD_KEYS, VECTOR

# In the order of `stability.robustness.MEASURES`, which needs a solver to be imported.
MEASURES = ("push", "force", "wrench", "com", "tilt", "friction", "friction_interval", "mass_and_com", "placement",
            "push_ellipsoid", "moment_ellipsoid", "push_rule")  # fmt: skip
DEFAULT_MEASURES = ("push", "force", "com", "tilt", "friction", "placement")

MEASURE_KEYS: dict[str, Any] = {
    "value": None,
    "unit": None,
    "kind": None,
    "bracket": VECTOR,
    "note": None,
    "direction": VECTOR,
    "beyond": RECORD_KEYS["certificate"],
}
MORE_KEYS: dict[str, dict[str, Any]] = {
    "push": {"point": VECTOR, "link": None},
    "wrench": {"length": None},
    "friction_interval": {"verdicts": {"lower": None, "upper": None}},
    "mass_and_com": {"shape": [VECTOR]},
    "placement": {"fails": None},
    "push_ellipsoid": {"point": VECTOR, "link": None, "centre": VECTOR, "semi_axes": [VECTOR]},
    "moment_ellipsoid": {"centre": VECTOR, "semi_axes": [VECTOR]},
    "push_rule": {
        "point": VECTOR,
        "link": None,
        "slack": None,
        "rule": [{"contact": None, "point": VECTOR, "force": VECTOR, "moment": VECTOR, "force_gain": [VECTOR], "moment_gain": [VECTOR]}],
    },
}
ROBUSTNESS_KEYS: dict[str, Any] = {"robustness": {name: MEASURE_KEYS | MORE_KEYS.get(name, {}) for name in MEASURES}}
