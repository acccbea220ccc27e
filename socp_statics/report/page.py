"""A report as one HTML page that needs nothing else."""

from __future__ import annotations

from html import escape

from socp_statics.report.drawings import histogram, thumbnail
from socp_statics.report.gathering import Gathered
from socp_statics.report.summary import opening, tables

STYLE = """
body { font: 15px/1.45 system-ui, sans-serif; max-width: 62rem; margin: 2rem auto; padding: 0 1rem; color: #1f1f1f; }
h1 { font-size: 1.5rem; } h2 { font-size: 1.1rem; margin-top: 2rem; }
table { border-collapse: collapse; font-variant-numeric: tabular-nums; }
th, td { text-align: left; padding: .15rem .9rem .15rem 0; border-bottom: 1px solid #ddd; vertical-align: top; }
th { font-weight: 600; } th, td { white-space: nowrap; } td.words { white-space: normal; overflow-wrap: anywhere; }
svg text { font: 11px system-ui, sans-serif; fill: #1f1f1f; }
figure { display: inline-block; margin: 0 1rem 1rem 0; vertical-align: top; }
figcaption { font-size: .8rem; max-width: 120px; overflow-wrap: anywhere; }
figure.wide figcaption { max-width: 420px; }
"""


def html(found: Gathered) -> str:
    """The page.

    Args:
        found: What was gathered.
    """
    title = escape(f"Results: {found.name}")
    parts = [f"<h1>{title}</h1>", f"<p>{escape(opening(found))}</p>"]
    for table in tables(found):
        if table.title == "Margins":
            parts.append(_distributions(found))
        head = "".join(f"<th>{escape(cell)}</th>" for cell in map(str, table.head))
        rows = "".join("<tr>" + "".join(map(_cell, row)) + "</tr>\n" for row in table.rows if row)
        parts.append(f"<h2>{escape(table.title)}</h2>\n<table>\n<tr>{head}</tr>\n{rows}</table>")
        if table.title.startswith("Problems"):
            parts.append(_thumbnails(found))
    body = "\n".join(part for part in parts if part)
    return (
        f'<!DOCTYPE html>\n<html lang="en">\n<head>\n<meta charset="utf-8">\n<title>{title}</title>\n<style>{STYLE}</style>\n</head>\n'
        f"<body>\n{body}\n</body>\n</html>\n"
    )


def _cell(text: str) -> str:
    return f'<td class="words">{escape(text)}</td>' if len(text) > 60 else f"<td>{escape(text)}</td>"


def _distributions(found: Gathered) -> str:
    pictures = [
        (histogram(found.margins, "% of the weight", 100.0), "Normal-force margin; negative: unstable"),
        (histogram(found.com_margins, "mm", 1000.0), "CoM margin; negative: outside the region"),
    ]
    shown = [f'<figure class="wide">{svg}<figcaption>{escape(words)}</figcaption></figure>' for svg, words in pictures if svg]
    return "<h2>Distributions</h2>\n" + "\n".join(shown) if shown else ""


def _thumbnails(found: Gathered) -> str:
    shown = [f"<figure>{thumbnail(one)}<figcaption>{escape(one.label)}</figcaption></figure>" for one in found.thumbnails]
    words = "<p>Filled: where the centre of mass may be. Black: contact points. The centre of mass: green stable, red unstable.</p>"
    return f"<h2>Support regions ({len(shown)})</h2>\n{words}\n" + "\n".join(shown) if shown else ""
