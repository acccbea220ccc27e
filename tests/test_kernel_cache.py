"""The kernel's machine code on disk: kept, found again, never trusted, never in the way."""

import hashlib
import json
import os
import pickle
import shutil
import subprocess
import sys
import time
from pathlib import Path

import llvmlite.binding
import numba
import pytest

from socp_statics.engines.kernel import compilation, disk_cache

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


@pytest.fixture
def toy(tmp_path):
    return write_toy(tmp_path)


@pytest.fixture(scope="module")
def compiled_once(tmp_path_factory):
    folder = write_toy(tmp_path_factory.mktemp("once"))
    assert run(folder)[0]["compiled"] == 1
    return folder


@pytest.fixture
def warm_toy(tmp_path, compiled_once):
    """The package with its first entry in the cache, which a copy of the folder takes along."""
    return Path(shutil.copytree(compiled_once, tmp_path / "toy"))


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


def kept(place):
    return sorted(path for path in place.rglob("compiled-*/*") if path.is_file())


def test_an_entry_is_compiled_at_its_first_call_and_found_by_later_processes(toy):
    first, complaints = run(toy, "tell(); import os; assert not os.path.exists('toy/__pycache__')\n" + CALL)
    assert first == {"value": 14.0, "found": 0, "compiled": 1}
    assert complaints == ""  # no terminal, no message
    (file,) = kept(toy)
    assert file.parent.parent == toy / "__pycache__"
    before = file.read_bytes()
    assert run(toy) == ({"value": 14.0, "found": 1, "compiled": 0}, "")
    assert file.read_bytes() == before
    assert not any((toy.parent / "home").iterdir())


def test_a_changed_callee_in_another_file_is_seen_whatever_its_date(warm_toy):
    file = warm_toy / "small.py"
    date = file.stat()
    file.write_text(SMALL.replace("2.0", "3.0"))
    os.utime(file, ns=(date.st_atime_ns, date.st_mtime_ns))
    assert run(warm_toy)[0] == {"value": 21.0, "found": 0, "compiled": 1}
    assert len({file.parent for file in kept(warm_toy)}) == 2


def test_sources_edited_since_they_were_imported_do_not_file_old_code_under_their_digest(toy):
    edit = "file = Path('toy/small.py'); file.write_text(file.read_text().replace('2.0', '3.0'))\n"
    assert run(toy, edit + CALL)[0]["value"] == 14.0
    assert not kept(toy)


def test_another_machine_compiler_or_package_is_another_folder(monkeypatch):
    def name(package="toy"):
        disk_cache._machine.cache_clear()
        return disk_cache._folder_name(compilation.KERNEL, package)

    names = {name(), name("other")}
    assert name() in names
    changes = [(numba, "__version__"), (llvmlite, "__version__"), (numba.config, "OPT"), (numba.config, "CPU_NAME"), (sys, "version")]
    for place, what in changes:
        with monkeypatch.context() as changed:
            changed.setattr(place, what, "another")
            names.add(name())
    with monkeypatch.context() as changed:
        changed.setattr(llvmlite.binding, "get_host_cpu_name", lambda: "another")
        names.add(name())
    assert len(names) == 3 + len(changes)
    assert name() in names


def signed(content):
    return hashlib.sha256(content).digest() + content


def flipped(content):
    middle = len(content) // 2
    return content[:middle] + bytes([content[middle] ^ 1]) + content[middle + 1 :]


DAMAGE = {
    "empty": lambda content: b"",
    "cut after the checksum": lambda content: content[:32],
    "cut in half": lambda content: content[: len(content) // 2],
    "one bit": flipped,
    "noise": lambda content: bytes(range(256)) * 100,
    # With a sound checksum: what another version of this file might have written.
    "signed noise": lambda content: signed(b"\x80\x05noise"),
    "another content": lambda content: signed(pickle.dumps({"code": 1})),
    "missing parts": lambda content: signed(pickle.dumps(((), ("code",)))),
    "a missing module": lambda content: signed(b"cno_such_module\nthing\n."),
}


def test_damaged_files_are_compiled_afresh_and_replaced(warm_toy):
    (file,) = kept(warm_toy)
    sound = file.read_bytes()
    (warm_toy.parent / "damaged").mkdir()
    for name, damage in DAMAGE.items():
        (warm_toy.parent / "damaged" / name).write_bytes(damage(sound))
    code = f"""
file = Path({str(file)!r})
for damaged in sorted(Path("damaged").iterdir()):
    file.write_bytes(damaged.read_bytes())
    assert anew() == "compiled", damaged
    assert len(file.read_bytes()) > 5000 and file.read_bytes() != damaged.read_bytes(), damaged
tell(len(os.listdir("damaged")))
"""
    assert run(warm_toy, code) == ({"value": len(DAMAGE), "found": 0, "compiled": 0}, "")
    assert run(warm_toy) == ({"value": 14.0, "found": 1, "compiled": 0}, "")


def test_a_file_that_vanishes_or_cannot_be_read_nor_replaced_is_passed_over(warm_toy):
    (file,) = kept(warm_toy)
    code = f"""
file = Path({str(file)!r})
read = Path.read_bytes
def vanishing(path):
    if path == file:
        path.unlink()
    return read(path)
Path.read_bytes = vanishing
first = anew()
Path.read_bytes = read
second = anew()
file.unlink()
(file / "in the way").mkdir(parents=True)
tell([first, second, anew(), anew()])
"""
    told, complaints = run(warm_toy, code)
    assert told["value"] == ["compiled", "found", "compiled", "found"] and complaints == ""
    # The next place took what the first one could not.
    assert [path.name for path in kept(warm_toy.parent / "home")] == [file.name]


BOTH = "next_one(1)\n" + CALL


def the_warning(complaints):
    lines = [line for line in complaints.splitlines() if "Warning" in line]
    assert len(lines) == 1, complaints
    assert "RuntimeWarning: the compiled kernel could not be kept in" in lines[0]
    return lines[0]


def test_without_a_place_to_write_it_compiles_in_memory_and_warns_once(toy):
    (toy.parent / "blocked").touch()
    code = f"""
{BOTH}
for place in ("/proc/no_such_place", "blocked/below"):
    os.environ["SOCP_STATICS_CACHE"] = place
    assert anew() == "compiled"
"""
    told, complaints = run(toy, code, SOCP_STATICS_CACHE="blocked", PYTHONWARNINGS="always")
    assert told == {"value": 14.0, "found": 0, "compiled": 2}
    assert str(toy.parent / "blocked") in the_warning(complaints)


@pytest.mark.skipif(sys.platform in ("darwin", "win32"), reason="XDG folders")
def test_the_places_in_turn(toy):
    (toy / "__pycache__").touch()
    # The first run has no home: nothing can be written, and the home is not made.
    code = """
assert anew() == anew() == "compiled"
for name, value in {"HOME": "home", "XDG_CACHE_HOME": "user", "SOCP_STATICS_CACHE": "named"}.items():
    os.environ[name] = os.path.abspath(value)
    assert [anew(), anew()] == ["compiled", "found"], name
tell()
"""
    complaints = run(toy, code, HOME=str(toy.parent / "absent"))[1]
    assert str(toy / "__pycache__") in the_warning(complaints)
    assert not (toy.parent / "absent").exists()
    for place in ("home/.cache/socp_statics", "user/socp_statics", "named"):
        assert len(kept(toy.parent / place)) == 1
    assert len(kept(toy.parent)) == 3


def test_a_full_or_read_only_disk_is_read_without_a_word_and_complained_of_only_when_something_was_compiled(warm_toy):
    code = """
import warnings
def write(path, content):
    raise OSError(28, "No space left on device")
disk_cache._write = write
with warnings.catch_warnings():
    warnings.simplefilter("error")
    total.load()
tell(next_one(1))
"""
    told, complaints = run(warm_toy, code)
    assert told == {"value": 2, "found": 1, "compiled": 1}
    the_warning(complaints)


def test_processes_and_threads_that_compile_at_once_all_succeed(toy):
    threads = """
from concurrent.futures import ThreadPoolExecutor
with ThreadPoolExecutor(4) as pool:
    assert set(pool.map(next_one, range(20))) == set(range(1, 21))
"""
    together = [start(toy, threads + CALL) for _ in range(2)]
    for process in together:
        told, complaints = finish(process)
        assert told["value"] == 14.0 and told["found"] + told["compiled"] == 2 and complaints == ""
    assert len(kept(toy)) == 2  # nothing half written is left
    assert run(toy, BOTH) == ({"value": 14.0, "found": 2, "compiled": 0}, "")


def test_folders_nobody_used_for_a_month_go(toy):
    place = toy / "__pycache__"
    ages = {"compiled-old": 31, "compiled-recent": 29, "something_else": 400}
    for name, days in ages.items():
        (place / name).mkdir(parents=True)
        os.utime(place / name, (time.time() - days * 86400,) * 2)
    # A folder in use does not age.
    code = """
first = anew()
(folder,) = [path.parent for path in Path("toy/__pycache__").glob("compiled-*/*")]
os.utime(folder, (0, 0))
tell([first, anew(), folder.stat().st_mtime])
"""
    first, second, used = run(toy, code)[0]["value"]
    assert (first, second) == ("compiled", "found")
    assert time.time() - used < 3600
    left = {path.name for path in place.iterdir()}
    assert len(left) == 3 and {"compiled-recent", "something_else"} < left


@pytest.mark.skipif(sys.platform == "win32", reason="no pseudo-terminals")
def test_a_terminal_is_told_once(toy):
    import pty

    (toy / "engine.py").write_text("raise ImportError('needs more than Numba')")
    code = """
from socp_statics.engines.kernel.compilation import compile_all
compile_all("toy")
os.environ["SOCP_STATICS_CACHE"] = os.path.abspath("later")
tell(anew())
"""

    def terminal():
        ours, theirs = pty.openpty()
        process = start(toy, code, stderr=theirs, SOCP_STATICS_CACHE=str(toy.parent / "place"))
        told = finish(process)[0]
        os.write(theirs, b"the end\n")
        said = ""
        while "the end\r\n" not in said:
            said += os.read(ours, 1000).decode()
        os.close(ours)
        os.close(theirs)
        return told, said.split("\r\n")[:-2]

    told, said = terminal()
    assert told == {"value": "compiled", "found": 0, "compiled": 2}
    assert len(said) == 2
    assert said[0] == "socp-statics: compiling the kernel for this machine, once; this takes about half a minute"
    assert said[1].startswith("socp-statics: compiled in ") and said[1].endswith(" s")
    assert terminal() == ({"value": "found", "found": 2, "compiled": 0}, [])


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


def test_interpreted_functions_work_too(toy):
    assert run(toy, "assert total.load() is total.py_func\n" + CALL, NUMBA_DISABLE_JIT="1")[0]["value"] == 14.0


def test_copies_made_by_a_factory_are_refused():
    def copy(x):
        return x

    with pytest.raises(TypeError, match="copy must be at the top level of its module"):
        compilation.inner(copy)
    with pytest.raises(TypeError, match="copy must be at the top level of its module"):
        compilation.entry("int64(int64)")(copy)


def square(x):
    return x * x


def test_options_replace_those_of_the_kernel():
    usual = compilation.inner(square).targetoptions
    assert usual == {**usual, "fastmath": {"reassoc", "contract", "arcp", "nsz"}, "nogil": True, "error_model": "numpy"}
    assert compilation.inner(fastmath=False)(square).targetoptions == {**usual, "fastmath": False}


def test_the_folder_of_the_kernel(tmp_path, monkeypatch):
    monkeypatch.setenv("SOCP_STATICS_CACHE", str(tmp_path / "place"))
    folder = compilation.cache_folder()
    assert folder.parent == tmp_path / "place" and folder.name.startswith("compiled-")
    assert list(folder.iterdir()) == []
    monkeypatch.setenv("SOCP_STATICS_CACHE", "/proc/no_such_place")
    assert compilation.cache_folder() is None
    monkeypatch.delenv("SOCP_STATICS_CACHE")
    assert compilation.KERNEL / "__pycache__" in disk_cache._places(compilation.KERNEL)


def test_neither_the_package_nor_clarabel_imports_numba():
    # cvxpy imports every solver that is installed, and one of the peers in the benchmarks imports Numba.
    code = """
import sys
sys.modules["moreau"] = None
import socp_statics as ss
assert "numba" not in sys.modules
foot = ss.SurfaceContact("foot", (0, 0, 0), normal=(0, 0, 1), friction=0.5, size=(0.2, 0.1))
answer = ss.check_equilibrium(ss.ContactSet([foot]), (0, 0, 0.8), mass=60.0, engine="clarabel")
assert answer.stable
sys.exit(bool({"numba", "llvmlite"} & set(sys.modules)))
"""
    subprocess.run([sys.executable, "-c", code], env={**os.environ, "PYTHONPATH": str(ROOT)}, check=True)
