"""Numbers with units for labels: a few digits, never an exponent where another unit does."""

from __future__ import annotations

import math


def _in_units(value: float, units: list[tuple[float, str]], digits: int) -> str:
    """The value in the last unit of an ascending list that is not larger than it, else in the first."""
    scale, unit = units[0]
    for candidate in units:
        if abs(value) >= candidate[0]:
            scale, unit = candidate
    number = float(f"{value / scale:.{digits - 1}e}")
    if number == 0.0:
        return f"0 {unit}"
    if not 1e-4 <= abs(number) < 1e6:
        return f"{number:.{digits}g} {unit}".replace("-", "\N{MINUS SIGN}")
    decimals = max(0, digits - 1 - math.floor(math.log10(abs(number))))
    text = f"{number:.{decimals}f}"
    return f"{text} {unit}".replace("-", "\N{MINUS SIGN}")


def area_text(square_metres: float) -> str:
    """An area, "138.18 cm²"; square metres from 10 m² on."""
    if abs(square_metres) < 1e-8:
        return f"{1e6 * square_metres:.3g} mm²" if square_metres else "0 cm²"
    return _in_units(square_metres, [(1e-4, "cm²"), (10.0, "m²")] if square_metres < 10.0 else [(1.0, "m²")], 5)


def length_text(metres: float) -> str:
    """A length, "34.1 mm"; metres from 10 m on."""
    return _in_units(metres, [(1e-3, "mm")] if abs(metres) < 10.0 else [(1.0, "m")], 4)


def force_text(newtons: float) -> str:
    """A force, "14.23 N"; kilonewtons from 10 kN on."""
    return _in_units(newtons, [(1.0, "N")] if abs(newtons) < 1e4 else [(1e3, "kN"), (1e6, "MN")], 4)
