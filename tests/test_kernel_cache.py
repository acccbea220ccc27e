"""The kernel's machine code on disk: kept, found again, never trusted, never in the way."""

import hashlib
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
from toy_package import CALL, ROOT, SMALL, finish, run, start, write_toy

from socp_statics.engines.kernel import compilation, disk_cache


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
    folder = compilation.folder_of(compilation.KERNEL, compilation.PACKAGE)
    assert folder.parent == tmp_path / "place" and folder.name.startswith("compiled-")
    assert list(folder.iterdir()) == []
    monkeypatch.setenv("SOCP_STATICS_CACHE", "/proc/no_such_place")
    assert compilation.folder_of(compilation.KERNEL, compilation.PACKAGE) is None
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


def test_an_entry_calls_nothing_but_its_own(toy):
    code = """
total(7.0, 1)
(made,) = total.load().overloads.values()
functions = [one for one in made.library._final_module.functions if not one.is_declaration]
tell(sorted({one.linkage.name for one in functions if "scaled" in one.name or "total" not in one.name}))
"""
    assert set(run(toy, code)[0]["value"]) <= {"internal", "private"}


INNER = """
from numba import njit
from toy.small import scaled
total(7.0, 1)
assert len(scaled.overloads) == 1 and not any(one.library._finalized for one in scaled.overloads.values())
said = []
for call in (scaled, njit(lambda x: scaled(x))):
    try:
        call(3.0)
    except Exception as error:
        said.append(str(error))
tell([said, scaled.py_func(3.0)])
"""


def test_an_inner_function_is_compiled_with_entries_only(toy):
    # It is lowered for them, but never made machine code of its own, which is what Python and other compiled code would call.
    said, value = run(toy, INNER)[0]["value"]
    assert len(said) == 2 and "scaled is an inner function: only entries can call it; Python can call its py_func" in said[0]
    assert "scaled is an inner function: only entries can call it" in said[1]
    assert value == 6.0


ORDERS = ("tracing.trace", "reserves.reserves"), ("reserves.reserves", "tracing.trace")
ANSWERS = """
import sys
from importlib import import_module
import numpy as np
import socp_statics as ss
for name in sys.argv[1:]:
    module, _, entry = name.partition(".")
    getattr(import_module("socp_statics.engines.kernel." + module), entry).load()
places = (("a", 0, 0.2, 0.3), ("b", 0.1, -0.2, -0.4))
feet = [ss.SurfaceContact(n, (x, y, 0), rpy=(r, 0.2, 0), friction=0.4, size=(0.2, 0.1)) for n, x, y, r in places]
hand = ss.PointContact("hand", (0.5, 0.1, 0.9), normal=(-1, 0.2, 0.1), friction=0.6)
contacts = ss.ContactSet([*feet, hand])
region = ss.trace_support_region(contacts, 1e-4, engine="kernel")
coms = np.random.default_rng(3).normal(size=(200, 3)) * 0.2 + (0.0, 0.0, 0.8)
margins = ss.check_equilibrium_many(contacts, coms, mass=40.0, engine="kernel").margin
print(region.inner.tobytes().hex(), region.outer.tobytes().hex(), margins.tobytes().hex())
"""


def test_answers_do_not_depend_on_what_was_asked_before():
    environment = {**os.environ, "PYTHONPATH": str(ROOT)}
    said = [subprocess.run([sys.executable, "-c", ANSWERS, *order], env=environment, check=True, capture_output=True) for order in ORDERS]
    assert len(said[0].stdout) > 10_000 and said[0].stdout == said[1].stdout
