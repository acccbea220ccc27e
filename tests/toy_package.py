"""A package of two small entries, and processes that use it, for the tests of how the kernel's machine code is kept."""

import json
import os
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).parents[1]
SMALL = """
from socp_statics.engines.kernel.compilation import inner

@inner
def scaled(x):
    return 2.0 * x
"""
WORK = """
from socp_statics.engines.kernel.compilation import entry
from toy.small import scaled

@entry("float64(float64, int64)")
def total(x, n):
    s = 0.0
    for i in range(n):
        s += scaled(x)
    return s

@entry("int64(int64)")
def next_one(n):
    return n + 1
"""
# The package of the engines imports cvxpy, which takes longer than everything here; a bare one in its place does as well.
PRELUDE = f"""
import json, os, sys, types
from pathlib import Path
bare = types.ModuleType("socp_statics.engines")
bare.__path__ = [{str(ROOT / "socp_statics" / "engines")!r}]
sys.modules[bare.__name__] = bare
from toy.work import total, next_one
from socp_statics.engines.kernel import disk_cache
from socp_statics.engines.kernel.compilation import OPTIONS, Entry

def anew():
    "Call an entry made anew, which looks for its file as a new process does."
    again = Entry(total.py_func, total.signature, OPTIONS)
    assert again(7.0, 1) == 14.0
    return "found" if again.load().stats.cache_hits else "compiled"

def tell(value=None):
    entries = [one for one in (total, next_one) if hasattr(one._call, "stats")]
    count = lambda what: sum(sum(getattr(one._call.stats, what).values()) for one in entries)
    print(json.dumps(dict(value=value, found=count("cache_hits"), compiled=count("cache_misses"))))
"""
CALL = "tell(total(7.0, 1))"


def write_toy(place):
    """A package with two entries and an inner function in another file."""
    folder = place / "toy"
    folder.mkdir()
    (folder / "__init__.py").touch()
    (folder / "small.py").write_text(SMALL)
    (folder / "work.py").write_text(WORK)
    return folder

def start(toy, code=CALL, stderr=subprocess.PIPE, **environment):
    clean = {name: value for name, value in os.environ.items() if not name.startswith(("SOCP_", "XDG_", "NUMBA_"))}
    # A home of its own, so that a place that should not be used shows; and no bytecode, so that __pycache__ holds the kernel only.
    home = toy.parent / "home"
    home.mkdir(exist_ok=True)
    stated = {"HOME": str(home), "PYTHONPATH": os.pathsep.join((str(ROOT), str(toy.parent))), "PYTHONDONTWRITEBYTECODE": "1"}
    command = [sys.executable, "-c", PRELUDE + code]
    every = {**clean, **stated, **environment}
    return subprocess.Popen(command, env=every, stdout=subprocess.PIPE, stderr=stderr, text=True, cwd=toy.parent)


def finish(process):
    said, complaints = process.communicate(timeout=120)
    assert process.returncode == 0, complaints
    return json.loads(said.splitlines()[-1]), complaints


def run(toy, code=CALL, **environment):
    return finish(start(toy, code, **environment))
