"""The floors of the house: imports only go down, heavy libraries stay in their rooms, no room without a name."""

import ast
import subprocess
import sys
from pathlib import Path

import pytest

PACKAGE = Path(__file__).parents[1] / "socp_statics"
FLOORS = {
    "exceptions": 0.0,
    "registry": 0.0,
    "spatial": 0.0,
    "cones": 0.1,
    "contacts": 0.2,
    "wrench_cones": 0.3,
    "robots": 1.0,
    "postures": 1.1,
    "statics": 1.2,
    "distribution": 1.3,
    "models": 2.0,
    "engines": 2.1,
    "certificates": 3.0,
    "stability": 4.0,
    "regions": 4.0,
    "following": 4.5,
    "optimization": 5.0,
    "cases": 6.0,
    "colours": 6.9,
    "comparison": 7.0,
    "runner": 7.0,
    "figures": 7.0,
    "viewer": 7.0,
    "report": 7.1,
    "report_figures": 7.1,
    "cli": 8.0,
    "__main__": 9.0,
    "__init__": 9.0,
}
GROUND = {"exceptions", "registry", "spatial"}
HOMES = {
    "cvxpy": {"models", "engines"},
    "clarabel": {"engines"},
    "numba": {"engines"},
    "pinocchio": {"robots", "postures", "statics", "distribution", "viewer"},
    "pink": {"postures"},
    "example_robot_data": {"robots"},
    "cdd": {"wrench_cones"},
    "matplotlib": {"figures"},
    "viser": {"viewer"},
    "trimesh": {"viewer"},
    "coal": {"viewer"},
    "pydantic": {"cases"},
    "typer": {"cli"},
    "rich": {"cli", "runner"},
    "distributed": {"runner"},
    "pyarrow": {"runner", "report"},
}
NAMELESS = {"utils", "util", "misc", "helpers", "helper", "common", "tools", "core", "base"}
FILES = sorted(PACKAGE.rglob("*.py"))


def room(path):
    return path.relative_to(PACKAGE).parts[0].removesuffix(".py")


def imports(path):
    """Modules a file imports, wherever in the file, without those for type checkers only."""
    tree = ast.parse(path.read_text())
    typing_only = {
        id(node)
        for branch in ast.walk(tree)
        if isinstance(branch, ast.If) and ast.unparse(branch.test) == "TYPE_CHECKING"
        for node in ast.walk(branch)
    }
    for node in ast.walk(tree):
        if id(node) in typing_only:
            continue
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            assert node.level == 0, f"{path}: a relative import"
            yield node.module
            yield from (f"{node.module}.{alias.name}" for alias in node.names)


@pytest.mark.parametrize("path", FILES, ids=lambda p: str(p.relative_to(PACKAGE)))
def test_imports_only_go_down(path):
    here = room(path)
    assert here in FLOORS, f"{here} has no floor"
    for module in imports(path):
        parts = module.split(".")
        if parts[0] == "socp_statics" and len(parts) > 1 and parts[1] in FLOORS:
            there = parts[1]
            allowed = there == here or FLOORS[there] < FLOORS[here] or {here, there} <= GROUND
            assert allowed, f"{here} imports {there}, which is not below it"
        if parts[0] in HOMES:
            assert here in HOMES[parts[0]], f"{here} imports {parts[0]}, which belongs in {sorted(HOMES[parts[0]])}"


@pytest.mark.parametrize("path", FILES, ids=lambda p: str(p.relative_to(PACKAGE)))
def test_files_are_small_and_named(path):
    assert path.stem not in NAMELESS
    assert len(path.read_text().splitlines()) <= 400


def test_importing_the_package_imports_only_the_standard_library():
    code = "import sys; before = set(sys.modules); import socp_statics; print(*sorted(set(sys.modules) - before))"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    roots = {name.split(".")[0] for name in done.stdout.split()}
    assert roots - set(sys.stdlib_module_names) == {"socp_statics"}


def test_every_public_name_exists():
    import socp_statics

    assert len(socp_statics._HOMES) > 20
    for name in socp_statics._HOMES:
        assert getattr(socp_statics, name) is not None
    with pytest.raises(AttributeError, match="no attribute 'nothing'"):
        _ = socp_statics.nothing
