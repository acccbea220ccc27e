"""The committed records: are they those of the named problems as they are now?"""

from pathlib import Path

import socp_statics as ss
from socp_statics.cases.batch import problem_stamp
from socp_statics.cases.named_problems import problem_names
from socp_statics.runner import stale_problems
from socp_statics.runner.selection import select

RESULTS = Path(__file__).parents[1] / "results"
# All named problems but the populations of the comparison, thousands of stances of which results/comparison/ keeps the rates.
SELECTORS = ["[!c]*/*", "contacts/*", "chapter/*", "comparison/pushed*"]


def test_the_committed_records_are_not_stale():
    command = " ".join(f"'{selector}'" for selector in SELECTORS)
    assert stale_problems(RESULTS, SELECTORS) == {}, f"socp-statics run {command} --out results computes what is stale"
    assert (RESULTS / "summary.md").exists(), "socp-statics report results writes it"


def test_only_the_populations_are_left_out():
    left = {name for name in problem_names() if name not in {question.name for question in select(SELECTORS)}}
    assert left == {"comparison/families", "comparison/level_floor"}


def test_hashes_of_the_committed_records_are_those_of_their_problems():
    """The digests that the test above compares are of the text; these are of the cases themselves."""
    for shard in ss.load_results(RESULTS).manifest.shards.values():
        if shard.problem.startswith(("contacts/", "degenerate/")):
            problem = ss.load_problem(shard.problem)
            assert [case[2] for case in shard.cases] == [problem_stamp(problem.case(number), "auto") for number, *_ in shard.cases]
