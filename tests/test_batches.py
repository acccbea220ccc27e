"""Many problems by one call: the same bytes as one by one, and cases of a sweep that are read alike."""

from collections import Counter

import pytest

import socp_statics as ss
from socp_statics.cases.batch import one_answered, solve_many
from socp_statics.cases.named_problems import problem_names
from socp_statics.cases.problem import problem_from_tables
from socp_statics.cases.sweep_cases import Cases

ROBOT = {"generator": "random_joint_angles", "robot": "hoap2", "friction": 0.6}
MANY = {
    "regions": {"model": "support_region", "posture": ROBOT, "parameters": {"prices": False}},
    "priced regions": {"model": "support_region", "posture": ROBOT, "parameters": {"safety": 0.01}},
    "pyramids": {"model": "support_region", "posture": ROBOT, "parameters": {"cone": "inscribed", "sides": 5}},
    "verdicts": {"model": "equilibrium", "posture": ROBOT | {"spread": 0.5}, "parameters": {"cone": "circumscribed"}},
    "torque limits": {"model": "support_region", "posture": ROBOT | {"torque_limits": {"default": 4.0}},
                      "parameters": {"torque_limits": True, "prices": False}},
}  # fmt: skip


@pytest.mark.parametrize("tables", MANY.values(), ids=MANY)
def test_a_batch_has_the_bytes_of_one_by_one(tables):
    sweep = {"posture.seed": range(30)}
    cases = Cases(tables, sweep, "population", "population", None)
    batch = solve_many([cases.case(number) for number in range(30)])
    problem = problem_from_tables(tables | {"sweep": {"posture.seed": {"from": 0, "to": 29}}}, "population")
    alone = [ss.solve(problem.case(number)).line() for number in range(30)]
    assert [one.record.line() for one in batch] == alone
    kinds = Counter(one.record["verdict"] for one in batch)
    assert kinds["stable"] and kinds["unstable"]


def test_a_batch_of_everything_has_the_bytes_of_one_by_one():
    names = [n for n in problem_names() if n.startswith(("contacts/push", "contacts/slope", "degenerate/"))]
    problems = [case for name in names for case in ss.load_problem(name).cases()]
    problems = [p for p in problems if p.model in ("equilibrium", "support_region")]
    batch = solve_many(problems)
    assert [one.record.line() for one in batch] == [one_answered(problem, "auto").record.line() for problem in problems]
    assert {one.record["verdict"] for one in batch} == {"stable", "unstable", "undecided"}


@pytest.mark.parametrize("name", ["comparison/families", "hoap2/half_squat_sweep", "contacts/slope_block_sweep", "g1/random_slopes"])
def test_cases_read_alike_are_those_read_one_by_one(name):
    problem = ss.load_problem(name)
    cases = Cases(problem.raw, problem.sweep, problem.name, problem.label, problem.path)
    for number in (*range(5), problem.case_count - 1, problem.case_count // 2):
        found, expected = cases.case(number), problem.case(number)
        assert found.stated() == expected.stated() and found.label == expected.label and found.raw == expected.raw
        assert (found.number, found.swept) == (expected.number, expected.swept) == (number, found.swept)


def test_random_joint_angles_are_drawn_from_their_seed():
    import numpy as np

    from socp_statics.postures.random_joint_angles import generate

    robot = ss.load_robot("hoap2")
    one, again, other = (generate(robot, seed=seed, spread=0.2, friction=0.4) for seed in (3, 3, 4))
    assert (one.angles == again.angles).all() and not (one.angles == other.angles).any()
    drawn = one.angles - robot.neutral
    assert 0.15 < np.abs(drawn).max() <= 0.2 and (one.angles >= robot.lower).all() and (one.angles <= robot.upper).all()
    assert (generate(robot, seed=3, spread=0.0).angles == robot.neutral).all()
    for wrong in ({"seed": -1}, {"seed": True}, {"spread": -0.1}):
        with pytest.raises(ss.InputError, match=f"{next(iter(wrong))} must be"):
            generate(robot, **wrong)


@pytest.mark.parametrize("model", ["equilibrium", "support_region"])
def test_prices_can_be_left_out(model):
    problem = ss.load_problem("contacts/flat_double_stance").with_values({"model": model, "parameters": {}, "expect": {}})
    priced, bare = ss.solve(problem), ss.solve(problem.with_values({"parameters.prices": False}))
    assert priced["prices"] and bare["prices"] == {} and "prices" not in priced["case"]["parameters"]
    same = set(priced) - {"prices", "hash", "case"}
    assert {key: priced[key] for key in same} == {key: bare[key] for key in same}
