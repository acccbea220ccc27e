"""Proofs of regions that are empty, a point or a segment: what is proved, and what the verifier refuses to be told."""

import copy
import json
from fractions import Fraction

import numpy as np
import pytest

import socp_statics as ss
from socp_statics.cases.problem import problem_from_tables
from socp_statics.certificates import verify_proof as verifier
from socp_statics.cli import main
from socp_statics.engines import SINGLE

KINDS = {"empty": "degenerate/empty_region", "a point": "degenerate/one_point_beside", "a segment": "degenerate/two_points_beyond"}
MOVED = ("inner corners pulled in by at most", "outer edges pushed out by at most")


def proved(name):
    return json.loads(ss.prove(json.loads(ss.solve(ss.load_problem(name), SINGLE).to_json()), SINGLE).to_json())


def tables(contacts, com=(0.0, 0.0, 1.0), **more):
    return {"model": "support_region", "posture": {"generator": "contacts", "mass": 60.0, "com": list(com), "contacts": contacts, **more}}


def point(name, position, normal=(0.0, 0.0, 1.0), **more):
    placed = {"position": [float(x) for x in position], "normal": [float(x) for x in normal]}
    return {"name": name, "type": "point", **placed, "friction": 0.5, **more}


def proof_of(stated, **parameters):
    problem = problem_from_tables(stated | {"parameters": parameters}, "case", label="case")
    record = json.loads(ss.solve(problem, SINGLE).to_json())
    return record, ss.prove(record, SINGLE)


@pytest.mark.parametrize("words", KINDS)
def test_the_command_line_says_what_is_proved(words, tmp_path, capsys):
    path = tmp_path / "proof.json"
    assert main(["prove", KINDS[words], "--engine", "clarabel", "--json", str(path)]) == 0
    (line,) = [line for line in capsys.readouterr().out.splitlines() if line.startswith("region")]
    assert line.split(None, 1)[1].startswith(f"proved: {words}") and all((part in line) == (words != "empty") for part in MOVED)
    assert verifier.main([str(path)]) == 0
    assert capsys.readouterr().out.strip().endswith(f"proved unstable, region {words}")


@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize("kind", ["exact", "inscribed", "circumscribed"])
def test_two_points_anywhere_hold_what_is_between_them(seed, kind):
    rng = np.random.default_rng(seed)
    ends = rng.uniform(-1, 1, size=(2, 3))
    ends[1, 2] = ends[0, 2] + 0.1 * rng.normal()
    record, proof = proof_of(tables([point("a", ends[0]), point("b", ends[1])], com=(*ends.mean(axis=0)[:2], 1.0)), cone=kind)
    assert record["region"]["kind"] == "segment" and proof.region == "proved", proof.region_reason
    size = float(np.linalg.norm(ends[1] - ends[0]))
    assert proof.pulled < 1e-8 * size and proof.pushed < 1e-8 * size
    found = np.array([[float(Fraction(v)) for v in corner] for corner in proof.document["region"]["outer"]])
    along, away = ends[1, :2] - ends[0, :2], found - ends[0, :2]
    assert np.abs(away[:, 0] * along[1] - away[:, 1] * along[0]).max() < 1e-9, "it lies on the line of the two"


WALLS = [point("left", (0, 0.3, 1), (0, -1, 0), friction=0.2), point("right", (0, -0.3, 1), (0, 1, 0), friction=0.2)]
EMPTY = {
    "a wall alone": tables([point("hand", (0.3, 0, 1), (-1, 0, 0))]),
    "walls that may not be pressed": tables([c | {"normal_force": [0.0, 700.0]} for c in WALLS]),
    "a handle that is too weak": tables(
        [
            {"name": "bar", "type": "handle", "position": [0.1, 0.2, 1.9], "normal": [0.0, 0.0, 1.0], "transmits": ["fx", "fy", "fz"],
             "limits": {"fz": [-500.0, 500.0]}},
        ]
    ),
    "a floor under tilted gravity": tables(
        [point("a", (0, 0, 0)), point("b", (1, 0, 0)), point("c", (0, 1, 0))], gravity=[6.0, 1.0, -7.0]
    ),
    "a rope that lifts": tables(
        [point("a", (0, 0, 0)), point("b", (1, 0, 0)), point("c", (0, 1, 0))],
        external_wrenches=[{"force": [0.0, 0.0, 700.0], "point": [0.3, 0.2, 1.0]}],
    ),
    "ice that somebody pushes over": tables(
        [{"name": "foot", "type": "frictionless_surface", "position": [0.0, 0.0, 0.0], "normal": [0.0, 0.0, 1.0], "size": [0.2, 0.1]}],
        external_wrenches=[{"force": [10.0, 0.0, 0.0], "point": [0.0, 0.0, 1.0]}],
    ),
}  # fmt: skip


@pytest.mark.parametrize("name", EMPTY)
def test_nowhere_to_put_the_centre_of_mass_is_a_theorem(name):
    record, proof = proof_of(EMPTY[name])
    assert record["region"]["kind"] == "empty" and proof.verdict == "unstable"
    assert proof.region == "proved", proof.region_reason
    statement = verifier.read_statement(verifier.Place(proof.document["statement"], "statement"))
    (edge,) = verifier.Place(proof.document["region"], "region")("edges").each()
    normal, offset = verifier.half_plane(statement, verifier.read_motion(statement, edge), edge.at)
    assert normal == [0, 0] and offset < 0, "exactly, not nearly"


def test_torque_limits_that_no_posture_of_the_trunk_meets_are_proved():
    stated = ss.load_problem("hoap2/torque_infeasible").raw | {"model": "support_region"}
    stated = {key: value for key, value in stated.items() if key not in ("expect", "sweep")}
    record, proof = proof_of(stated, torque_limits=True)
    assert record["verdict"] == proof.verdict == "unstable" and proof.region == "proved", proof.region_reason
    assert verifier.verify(json.loads(proof.to_json())).startswith("proved unstable, region")


def _claim(document, outer):
    return document | {"region": document["region"] | {"outer": outer}}


def test_the_verifier_refuses_a_region_that_is_smaller_than_what_is_proved():
    none, one, line = (proved(name) for name in KINDS.values())
    flat = proved("contacts/flat_double_stance")
    (a, b), (p,) = line["region"]["outer"], one["region"]["outer"]
    assert verifier.verify(_claim(line, [a, b])) == "proved unstable, region a segment"
    shorter = [a, [str(Fraction(b[0]) * 9 / 10), str(Fraction(b[1]) * 9 / 10)]]
    turned = [[str(Fraction(a[0]) + Fraction(1, 100)), a[1]], b]
    beside = [[str(Fraction(p[0]) + Fraction(1, 1000)), p[1]]]
    for document, outer in ((line, shorter), (line, turned), (line, [a]), (one, beside), (flat, [a, b]), (flat, [p])):
        with pytest.raises(verifier.Refuted, match=r"region.outer\[\d\]"):
            verifier.verify(_claim(document, outer))
    for document in (line, one, flat):
        with pytest.raises(verifier.Refuted, match="region.edges: no motion is driven wherever"):
            verifier.verify(_claim(document, []))
    moving = copy.deepcopy(none)
    moving["region"]["edges"][0]["angular"] = ["1/1000", "0", "0"]
    with pytest.raises(verifier.Refuted, match="region.edges"):
        verifier.verify(moving)


def test_a_polygon_without_area_does_not_pass_for_one():
    line = proved(KINDS["a segment"])
    a, b = ([Fraction(v) for v in corner] for corner in line["region"]["outer"])
    # its edges all lie on one line, which alone would not say where it ends
    near = [[str(x + (y - x) * share) for x, y in zip(a, b, strict=True)] for share in (Fraction(1, 4), Fraction(1, 2), Fraction(3, 4))]
    for corners in (near, near[::-1]):
        with pytest.raises(verifier.Unreadable, match="a polygon with an area, counter-clockwise, is expected"):
            verifier.verify(_claim(line, corners))
    flat = proved("contacts/flat_double_stance")
    with pytest.raises(verifier.Unreadable, match="counter-clockwise"):
        verifier.verify(_claim(flat, flat["region"]["outer"][::-1]))


def test_a_record_with_another_segment_is_refused_or_left_open():
    record = json.loads(ss.solve(ss.load_problem(KINDS["a segment"]), SINGLE).to_json())
    shorter, longer = copy.deepcopy(record), copy.deepcopy(record)
    shorter["region"]["outer"][0][1] *= 0.9
    assert ss.prove(shorter, SINGLE).region == "undecided"
    longer["region"]["inner"][0][1] *= 1.1
    with pytest.raises(ss.StaticsError, match=r"region.inner\[0\]"):
        ss.prove(longer, SINGLE)
    empty = json.loads(ss.solve(ss.load_problem("contacts/flat_double_stance"), SINGLE).to_json())
    empty["region"] |= {"kind": "empty", "inner": [], "outer": [], "inner_forces": [], "outer_multipliers": []}
    assert ss.prove(empty, SINGLE).region == "undecided"
