"""Records of cases that a run refuses: what was asked, why there is no answer, and nothing that a reader of records stumbles over."""

from __future__ import annotations

import numpy as np
import pytest

import socp_statics as ss
from socp_statics.cli import main
from socp_statics.runner import run

REFUSED = """model = "{model}"
[posture]
generator = "contacts"
mass = 60.0
com = [0, 0, 1]
[[posture.contacts]]
name = "foot"
type = "surface"
position = [0, 0, 0]
normal = [0, 0, 1]
friction = 0.5
size = [0.2, 0.1]
[sweep]
{sweep}
"""
REFUSALS = {
    "a contact": ("equilibrium", '"posture.contacts.foot.friction" = [0.5, -1.0]', "friction", 0, False),
    "gravity": ("equilibrium", '"posture.gravity" = [[0, 0, -9.81], "down"]', "gravity", 0, True),
    "half a force": ("equilibrium", '"posture.external_wrenches" = [[], [{ force = [1, 2] }]]', "force", 0, True),
    "a force in words": ("equilibrium", '"posture.external_wrenches" = [[], [{ force = [0, 0, "x"] }]]', "force", 0, True),
    "a method": ("wrench_distribution", '"parameters.method" = ["all", "statics_consistent"]', "lever rule", 1, False),
}



@pytest.fixture(scope="module")
def done(tmp_path_factory):
    """A run in which every other case is refused: its folder, the files, and the exit status."""
    folder = tmp_path_factory.mktemp("refused")
    paths = []
    for number, (model, sweep, *_) in enumerate(REFUSALS.values()):
        paths.append(folder / f"refused_{number}.toml")
        paths[-1].write_text(REFUSED.format(model=model, sweep=sweep))
    out = folder / "out"
    return out, [str(path) for path in paths], main(["run", *map(str, paths), "--out", str(out), "--workers", "1", "--quiet"])


def test_the_run_says_that_some_failed_and_keeps_them(done):
    out, paths, status = done
    assert status == 1
    assert run(paths, out, workers=1).computed == 0, "what was refused is kept, and not asked again"


@pytest.mark.parametrize("what", REFUSALS)
def test_records_of_refused_cases_are_read_as_all_others(what, done):
    number, (_, _, word, contacts, kept_apart) = list(REFUSALS).index(what), REFUSALS[what]
    results = ss.load_results(done[0])
    mine = [record for record in results if record["problem"].endswith(f"refused_{number}")]
    fine, refused = sorted(mine, key=lambda record: record["sweep"]["case"])
    assert set(fine) - set(refused) <= {"distribution"} and set(refused) - set(fine) <= {"failure", "failure_kind"}
    assert (refused["status"], refused["verdict"], refused["failure_kind"]) == ("failed", "undecided", "input")
    assert word in refused["failure"]
    case = refused["case"]
    made, asked = case["generated"], case["posture"]
    assert set(made) >= {"contacts", "com", "mass"} and len(made["contacts"]) == contacts and isinstance(made["mass"], float)
    loads = [asked.get("gravity", [0, 0, -9.81]), *(w.get("force", [0, 0, 0]) for w in asked.get("external_wrenches", []))]
    assert np.array(loads, dtype=float).shape == (len(loads), 3) and np.array(made["com"], dtype=float).ndim == 1
    # The wrong value is still there.
    key, value = next(iter(refused["sweep"]["values"].items()))
    assert ("asked" in case) == kept_apart
    if kept_apart:
        assert case["asked"]["posture"][key.removeprefix("posture.")] == value


def test_the_table_has_a_row_for_each(done):
    masses = ss.load_results(done[0]).table()["mass"]
    assert sorted(masses, key=str) == [60.0] * 6 + [None] * 4
