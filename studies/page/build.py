"""The page put together: text from files, numbers and pictures from the library and its studies."""

from __future__ import annotations

import json
from collections.abc import Iterable
from pathlib import Path
from string import Template

import beammodes as bm
from beammodes.numerics.blas import one_thread
from studies import PAGE, every_study
from studies.page import added, choice, errors, rods_data, springs, steps, systems
from studies.page.atlas_data import atlas
from studies.page.evidence import EVIDENCE, note, source_list
from studies.page.markup import escaped, figure, picture
from studies.runner import write_bytes

__all__ = ["page", "unused", "write"]

FOLDER = Path(__file__).parent
TEXTS = ("choice", "atlas", "rods", "added", "source", "corrections")


def page(folder: Path) -> str:
    """Return the page as HTML, with the pictures and tables that the studies have written into a folder.

    Raises
    ------
    ArithmeticError
        If two routes to a number of the page do not agree.
    KeyError
        If the text asks for a part that there is not, or leaves one out.
    """
    with one_thread():
        return _put_together(folder)


def _put_together(folder: Path) -> str:
    parts = {f"note_{evidence.key}": note(evidence.key) for evidence in EVIDENCE}
    agreements: dict[str, str] = {}
    for module in (springs, systems, errors, steps, added):
        content, agreed = module.parts(folder)
        parts |= content
        agreements |= agreed
    for content, agreed in (choice.parts(), rods_data.parts()):
        parts |= content
        agreements |= agreed
    parts |= {"atlas_data": _json(atlas()), "rods_data": _json(rods_data.rods())}
    parts |= {name: _read(f"{file}.js") for name, file in _SCRIPTS.items()}
    texts = {name: _read(f"{name}.html") for name in TEXTS}
    placed = [
        name for name in every_study() if any(f"${{picture_{name}}}" in text for text in texts.values())
    ]
    for name in placed:
        parts[f"picture_{name}"] = _figure(folder, name)
    if left := unused(parts, "".join(texts.values())):
        raise KeyError(f"the page's text must have a place for {', '.join(left)}")
    whole = {name: Template(source).substitute(parts) for name, source in texts.items()}
    others = [name for name, study in every_study().items() if study.reproducible and name not in placed]
    whole["further"] = "\n".join(_figure(folder, name) for name in others)
    whole |= {"sources": source_list(agreements), "style": _read("style.css"), "version": bm.__version__}
    whole["reading_script"] = _read("reading.js")
    return Template(_read("report.html")).substitute(whole)


def unused(parts: Iterable[str], text: str) -> list[str]:
    """Return the parts for which a text has no place.

    >>> unused(["table_c", "table_law"], "<p>${table_c}</p>")
    ['table_law']
    """
    return [name for name in parts if f"${{{name}}}" not in text]


_SCRIPTS = {
    "numbers_script": "numbers",
    "atlas_script": "atlas",
    "atlas_plot_script": "atlas_plot",
    "exact_beam_script": "exact_beam",
    "chain_modes_script": "chain_modes",
    "atlas_chains_script": "atlas_chains",
    "atlas_form_script": "atlas_form",
    "rods_script": "rods",
}


def _read(name: str) -> str:
    return (FOLDER / name).read_text(encoding="utf-8")


def _figure(folder: Path, name: str) -> str:
    return figure(picture(folder, name), escaped(every_study()[name].caption), name)


def _json(data: object) -> str:
    """Return data as JSON that may stand in a script element: no tag can begin in it."""
    return json.dumps(data, separators=(",", ":"), ensure_ascii=False).replace("<", "\\u003c")


def write(folder: Path) -> str:
    """Write the page into the folder of its pictures, and return its name."""
    write_bytes(folder / f"{PAGE}.html", page(folder).encode())
    return f"{PAGE}.html"
