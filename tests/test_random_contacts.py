"""Seeded random contacts: the same from the same four arguments, tilted as asked, in files and in the lists."""

import json

import numpy as np
import pytest

import socp_statics as ss
from socp_statics.cases.problem import problem_from_tables
from socp_statics.cli import main
from socp_statics.contacts.random_contacts import FAMILIES, FRICTION, REACH, SLOPE, random_contacts
from socp_statics.exceptions import InputError


def tables(**posture):
    posture = {"generator": "random_contacts", "family": "sloped_feet", "seed": 3} | posture
    return {"model": "equilibrium", "description": "random", "posture": posture}


@pytest.mark.parametrize("family", FAMILIES)
class TestFamilies:
    def test_the_same_arguments_give_the_same_contacts_and_others_do_not(self, family):
        def drawn(*arguments):
            contacts, com = random_contacts(family, *arguments)
            return json.dumps([[c.statement() for c in contacts], com.tolist()])

        assert drawn(7, 0.5, 0.2) == drawn(7, 0.5, 0.2)
        assert len({drawn(7, 0.5, 0.2), drawn(8, 0.5, 0.2), drawn(7, 0.6, 0.2), drawn(7, 0.5, 0.3), drawn(7)}) == 5

    def test_friction_and_slope_are_as_stated_or_within_their_range(self, family):
        contacts, _ = random_contacts(family, 1, 0.37, 0.1)
        assert {c.friction for c in contacts} == {0.37}
        drawn = [random_contacts(family, seed)[0][0].friction for seed in range(20)]
        assert FRICTION[0] <= min(drawn) < max(drawn) <= FRICTION[1]

    def test_the_centre_of_mass_is_within_reach_and_above(self, family):
        for seed in range(10):
            contacts, com = random_contacts(family, seed, 0.5, 0.2)
            points = np.vstack([c.points_W for c in contacts])
            away = np.linalg.norm((points - points.mean(axis=0))[:, :2], axis=1).max()
            assert np.linalg.norm((com - points.mean(axis=0))[:2]) <= REACH * away + 1e-12
            assert 0.0 <= com[2] - points[:, 2].mean() <= 1.0

    def test_contact_frames_are_turned_at_random(self, family):
        if family == "flat":
            turns = {round(random_contacts(family, seed, 0.5, 0.0)[0][0].rotation[0, 0], 6) for seed in range(5)}
            assert len(turns) == 5


@pytest.mark.parametrize("slope", [0.0, 0.3])
def test_slopes_are_angles_of_the_normals(slope):
    for family in ("flat", "sloped_feet"):
        for seed in range(5):
            contacts, _ = random_contacts(family, seed, 0.5, slope)
            for contact in contacts:
                assert np.arccos(np.clip(contact.rotation[2, 2], -1, 1)) == pytest.approx(slope, abs=1e-7)
    left, right = random_contacts("flat", 2, 0.5, slope)[0]
    assert left.rotation[:, 2] == pytest.approx(right.rotation[:, 2])
    assert (left.position - right.position) @ left.rotation[:, 2] == pytest.approx(0.0, abs=1e-12)
    drawn = [np.arccos(random_contacts("flat", seed)[0][0].rotation[2, 2]) for seed in range(30)]
    assert SLOPE[0] <= min(drawn) < max(drawn) <= SLOPE[1]


def test_a_flat_stance_holds_exactly_up_to_its_friction():
    for slope, mu, verdict in ((0.3, np.tan(0.3) + 0.01, {"stable", "unstable"}), (0.3, np.tan(0.3) - 0.01, {"unstable"})):
        found = set()
        for seed in range(20):
            contacts, com = random_contacts("flat", seed, mu, slope)
            found.add(ss.check_equilibrium(contacts, com, engine="clarabel").verdict)
        assert found == verdict


def test_a_file_solves_and_reads_back(tmp_path, capsys):
    problem = problem_from_tables(tables(friction=0.7, slope=0.2), "mine")
    record = ss.solve(problem, "clarabel")
    assert record["case"]["posture"]["mass"] == 60.0
    assert [c["name"] for c in record["case"]["generated"]["contacts"]] == ["left_foot", "right_foot"]
    stated = {key: record["case"]["generated"][key] for key in ("contacts", "com", "mass")} | {"generator": "contacts"}
    again = ss.solve(problem_from_tables(tables() | {"posture": stated}, "mine"), "clarabel")
    assert again["margin"] == pytest.approx(record["margin"], abs=1e-9)
    file = tmp_path / "shown.toml"
    assert main(["show", "comparison/families", "--toml"]) == 0
    file.write_text(capsys.readouterr().out)
    assert ss.load_problem(file).case(4321).stated() == ss.load_problem("comparison/families").case(4321).stated()
    assert main(["list", "postures"]) == 0
    assert "random_contacts" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("posture", "words"),
    [
        ({"family": "flatt"}, ["posture.family", "did you mean 'flat'"]),
        ({"family": 3}, ["posture.family", "flat", "got 3"]),
        ({"seed": -1}, ["posture.seed", "whole number >= 0", "-1"]),
        ({"seed": 1.5}, ["posture.seed", "1.5"]),
        ({"seed": None}, ["posture.seed"]),
        ({"friction": -0.1}, ["posture.friction", ">= 0"]),
        ({"slope": 2.0}, ["posture.slope", "1.5"]),
        ({"robot": "hoap2"}, ["posture.robot", "not a known key"]),
        ({"mass": 0.0}, ["posture.mass", "> 0"]),
        ({"external_wrenches": [{"force": [1.0, 0.0, 0.0]}]}, ["posture.external_wrenches[0].point"]),
    ],
    ids=str,
)
def test_wrong_keys_are_named(posture, words):
    with pytest.raises(InputError) as caught:
        problem_from_tables(tables(**posture), "mine")
    assert all(word in str(caught.value) for word in words), str(caught.value)


@pytest.mark.parametrize(
    ("arguments", "field"), [(("x", 0), "family"), (("flat", -1), "seed"), (("flat", True), "seed"), (("flat", 0, -1.0), "friction")]
)
def test_wrong_arguments_are_named(arguments, field):
    with pytest.raises(InputError) as caught:
        random_contacts(*arguments)
    assert caught.value.field == field
