"""Entries that are compiled at the same time, in processes of their own."""

import os

import pytest
from toy_package import ROOT, run, write_toy

from socp_statics.engines.kernel import compilation


@pytest.fixture
def toy(tmp_path):
    return write_toy(tmp_path)


MORE = """
from socp_statics.engines.kernel.compilation import entry

@entry("int64(int64)")
def doubled(n):
    return 2 * n
"""
SIDE_BY_SIDE = """
from toy.more import doubled
from socp_statics.engines.kernel import side_by_side
children = []
start = side_by_side._child
side_by_side._child = lambda group: children.append(start(group)) or children[-1]
shared = (("work",), ("more",))
side_by_side.load_side_by_side((total, next_one, doubled), shared)
hits = [bool(one.load().stats.cache_hits) for one in (total, next_one, doubled)]
assert (total(7.0, 1), next_one(1), doubled(4)) == (14.0, 2, 8)
tell([hits, [child.returncode for child in children]])
"""


def test_groups_of_entries_are_compiled_at_the_same_time(toy):
    (toy / "more.py").write_text(MORE)
    # One group here, the other by a process that leaves its code on disk; the next time everything is there and nothing is started.
    cpus = {"PYTHONPATH": os.pathsep.join((str(ROOT), str(toy.parent)))}
    first = run(toy, "os.cpu_count = lambda: 2\n" + SIDE_BY_SIDE, **cpus)[0]["value"]
    assert first == [[False, False, True], [0]]
    assert run(toy, "os.cpu_count = lambda: 2\n" + SIDE_BY_SIDE, **cpus)[0]["value"] == [[True, True, True], []]


@pytest.mark.parametrize("processors, children", [(2, 1), (3, 2), (8, 2)])
def test_there_are_no_more_processes_than_processors(toy, processors, children):
    (toy / "more.py").write_text(MORE)
    (toy / "most.py").write_text(MORE.replace("doubled", "tripled").replace("2 * n", "3 * n"))
    code = f"os.cpu_count = lambda: {processors}\nfrom toy.most import tripled\n" + SIDE_BY_SIDE
    code = code.replace('("more",))', '("more",), ("most",))').replace("next_one, doubled)", "next_one, doubled, tripled)")
    code = code.replace("doubled(4)) == (14.0, 2, 8)", "doubled(4), tripled(4)) == (14.0, 2, 8, 12)")
    hits, codes = run(toy, code, PYTHONPATH=os.pathsep.join((str(ROOT), str(toy.parent))))[0]["value"]
    assert hits == [False, False, True, True] and codes == [0] * children


@pytest.mark.parametrize("why", ["one processor", "a child that fails"])
def test_what_no_child_compiled_is_compiled_here(toy, why):
    (toy / "more.py").write_text(MORE)
    code = "os.cpu_count = lambda: 1\n" + SIDE_BY_SIDE
    if why == "a child that fails":
        code = "os.cpu_count = lambda: 2\nsys.executable = '/bin/false'\n" + SIDE_BY_SIDE
    hits, codes = run(toy, code)[0]["value"]
    assert hits == [False, False, False] and codes == ([1] if "child" in why else [])


def test_every_module_with_entries_is_in_a_group():
    from socp_statics.engines.kernel.side_by_side import SHARED

    modules = {one.__module__.rpartition(".")[2] for one in compilation.entries_of(compilation.PACKAGE)}
    assert modules == {name for names in SHARED for name in names}
