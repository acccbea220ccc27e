"""The committed records: are they those of the named problems as they are now?"""

from pathlib import Path

import socp_statics as ss
from socp_statics.cases.batch import problem_stamp
from socp_statics.runner import stale_problems

RESULTS = Path(__file__).parents[1] / "results"


def test_the_committed_records_are_not_stale():
    if not (RESULTS / "manifest.jsonl").exists():
        # before the first `socp-statics run --out results` there is nothing that could be stale
        return
    assert stale_problems(RESULTS) == {}, "socp-statics run --out results computes what is stale"
    assert (RESULTS / "summary.md").exists(), "socp-statics report results writes it"


def test_hashes_of_the_committed_records_are_those_of_their_problems():
    """The digests that the test above compares are of the text; these are of the cases themselves."""
    if not (RESULTS / "manifest.jsonl").exists():
        return
    for shard in ss.load_results(RESULTS).manifest.shards.values():
        if shard.problem.startswith(("contacts/", "degenerate/")):
            problem = ss.load_problem(shard.problem)
            assert [case[2] for case in shard.cases] == [problem_stamp(problem.case(number), "auto") for number, *_ in shard.cases]
