"""Registries list without importing, and help with misspelt names."""

import subprocess
import sys
from importlib import metadata

import pytest

from socp_statics.exceptions import InputError, StaticsError
from socp_statics.registry import Registry, nearest, suggestion


def fractions_registry(group=None):
    registry = Registry("number", group=group)
    registry.add("fraction", "a ratio", "fractions:Fraction")
    registry.add("absent", "not there", "no_such_module_anywhere:THING")
    return registry


def test_names_keep_their_order_and_say_one_line():
    registry = fractions_registry()
    assert registry.names() == ("fraction", "absent")
    assert registry.describe() == {"fraction": "a ratio", "absent": "not there"}


def test_listing_does_not_import_what_it_lists():
    registry = fractions_registry()
    registry.describe()
    assert "no_such_module_anywhere" not in sys.modules


def test_an_entry_is_loaded_by_name():
    from fractions import Fraction

    assert fractions_registry().load("fraction") is Fraction


def test_an_unknown_name_offers_near_ones():
    with pytest.raises(InputError, match="number 'fracton' is not known .*did you mean 'fraction'") as caught:
        fractions_registry().load("fracton")
    assert caught.value.name == "fracton"


def test_a_name_like_nothing_lists_what_is_known():
    with pytest.raises(InputError, match="known: fraction, absent"):
        fractions_registry().check("zzz")


def test_a_name_cannot_be_registered_twice():
    with pytest.raises(ValueError, match="registered twice"):
        fractions_registry().add("fraction", "again", "fractions:Fraction")


def test_a_target_names_a_module_and_an_attribute():
    with pytest.raises(ValueError, match="module:attribute"):
        fractions_registry().add("other", "line", "fractions")


def test_a_broken_entry_of_the_package_is_a_bug_and_shows_as_one():
    with pytest.raises(ModuleNotFoundError):
        fractions_registry().load("absent")


def test_plugins_join_by_entry_point_and_never_replace(monkeypatch):
    points = [
        metadata.EntryPoint("decimal", "decimal:Decimal", "g"),
        metadata.EntryPoint("fraction", "decimal:Decimal", "g"),
        metadata.EntryPoint("broken", "no_such_module_anywhere:THING", "g"),
    ]
    monkeypatch.setattr(metadata, "entry_points", lambda group: [point for point in points if point.group == group])
    registry = fractions_registry(group="g")
    assert registry.names() == ("fraction", "absent", "broken", "decimal")
    assert registry.load("decimal").__name__ == "Decimal"
    assert registry.load("fraction").__name__ == "Fraction"
    with pytest.raises(StaticsError, match="plugin no_such_module_anywhere:THING cannot be loaded"):
        registry.load("broken")


def test_the_models_are_listed_without_a_solver():
    code = "from socp_statics.cases.answers import ANSWERS; ANSWERS.describe(); import sys; sys.exit('cvxpy' in sys.modules)"
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0


def test_names_that_begin_with_the_word_are_offered_before_those_that_look_like_it():
    known = ["contacts/flat_double_stance", "contacts/ladder", "contacts/idle_wall", "robots"]
    assert suggestion("contacts/flat", known) == " (did you mean 'contacts/flat_double_stance'?)"
    assert suggestion("contacts/laddr", known).startswith(" (did you mean 'contacts/ladder'")
    assert suggestion("robot", known) == " (did you mean 'robots'?)"
    assert suggestion("nonsense", known) == suggestion("r", known) == ""
    assert nearest("nonsense", known) == f" (known: {', '.join(known)})"
