"""The documentation site written:  python -m studies site."""

from __future__ import annotations

import re
import shutil
import tempfile
from pathlib import Path

import beammodes as bm
from studies import PAGE, SITE
from studies.page.build import write as write_report
from studies.site.docstrings import as_markup

__all__ = ["UNLISTED", "chapters", "topics", "write"]

ROOT = Path(__file__).resolve().parent.parent.parent
PAGES = ROOT / "beammodes" / "pages"
FIGURES = ROOT / "figures"

#: Names of no page of their own: the version is text.
UNLISTED = {"__version__"}

#: The report's page and atlas, beside the page `report`.
ATLAS_FILE = "report_and_atlas.html"

_EXTENSIONS = [
    "sphinx.ext.autodoc",
    "sphinx.ext.autosummary",
    "numpydoc",
    "myst_parser",
    "sphinx.ext.viewcode",
]


def chapters() -> dict[str, list[str]]:
    """Return the site's chapters, those of README's list of what to read: pages, by their files' names."""
    listed = (ROOT / "README.md").read_text(encoding="utf-8").partition("## Read on\n")[2]
    return {
        title: [
            stem if stem != "CONTRIBUTING" else "contributing" for stem in re.findall(r"/(\w+)\.md\)", text)
        ]
        for title, text in re.findall(r"^- ([^:]*):(.*?)(?=^\S|\Z)", listed, flags=re.MULTILINE | re.DOTALL)
    }


def topics() -> dict[str, tuple[str, list[str]]]:
    """Return, by the folder that they are from, its line in the package's plan and its public names."""
    plan = dict(re.findall(r"^([a-z_]+)/ +(\S.*)$", bm.__doc__ or "", flags=re.MULTILINE))
    found: dict[str, tuple[str, list[str]]] = {folder: (line, []) for folder, line in plan.items()}
    for name in bm.__all__:
        if name not in UNLISTED:
            found[bm._HOME[name].partition(".")[0]][1].append(name)
    return {folder: part for folder, part in found.items() if part[1]}


def write(figures: Path) -> str:
    """Write the site into a folder beside the figures, and return that folder's name.

    Raises
    ------
    SystemExit
        If Sphinx is not installed.
    RuntimeError
        If Sphinx has warned, as it does of a link that leads nowhere; its warnings are the message.
    """
    try:
        from sphinx.application import Sphinx
    except ImportError:
        raise SystemExit("the site needs Sphinx: pip install -e '.[site]'") from None
    into = figures / SITE
    if not (figures / f"{PAGE}.html").is_file():
        write_report(figures)
    with tempfile.TemporaryDirectory() as scratch:
        source, warnings = Path(scratch, "source"), Path(scratch, "warnings")
        _write_sources(source, figures)
        shutil.rmtree(into, ignore_errors=True)
        with warnings.open("w+", encoding="utf-8") as log:
            site = Sphinx(
                srcdir=source,
                confdir=None,
                outdir=into,
                doctreedir=Path(scratch, "trees"),
                buildername="html",
                confoverrides=_settings(),
                status=None,
                warning=log,
            )
            site.connect("autodoc-process-docstring", as_markup, priority=10)
            site.build()
            log.seek(0)
            if said := log.read():
                raise RuntimeError(f"Sphinx warned:\n{said}")
    return f"{SITE}/index.html"


def _settings() -> dict[str, object]:
    return {
        "project": "beammodes",
        "author": "beammodes contributors",
        "version": bm.__version__,
        "release": bm.__version__,
        "extensions": _EXTENSIONS,
        "html_theme": "furo",
        "html_title": f"beammodes {bm.__version__}",
        "html_static_path": ["_static"],
        "html_css_files": ["site.css"],
        "html_extra_path": ["_extra"],
        "html_show_copyright": False,
        "html_show_sourcelink": False,
        "html_copy_source": False,
        "html_use_index": True,
        "myst_heading_anchors": 3,
        "default_role": "py:obj",
        "autosummary_generate": True,
        "autodoc_typehints": "none",
        "numpydoc_show_class_members": False,
        "numpydoc_xref_param_type": False,
        "templates_path": ["_templates"],
        "nitpicky": False,
    }


def _write_sources(source: Path, figures: Path) -> None:
    """Write what Sphinx reads: pages with their pictures, topics of public names, the report's page."""
    source.mkdir()
    (source / "figures").mkdir()
    names = sorted({name for part in chapters().values() for name in part})
    texts = {path.stem: path.read_text(encoding="utf-8") for path in sorted(PAGES.glob("*.md"))}
    texts["contributing"] = (ROOT / ".github" / "CONTRIBUTING.md").read_text(encoding="utf-8")
    if set(names) != set(texts):
        raise KeyError(f"README must lead to every page once, got {sorted(set(names) ^ set(texts))}")
    texts["index"] = (ROOT / "README.md").read_text(encoding="utf-8") + _contents()
    texts["atlas"] = _ATLAS
    for name, text in texts.items():
        (source / f"{name}.md").write_text(
            _with_pictures(text, source / "figures", figures), encoding="utf-8"
        )
    (source / "api").mkdir()
    for folder, (line, members) in topics().items():
        (source / "api" / f"{folder}.rst").write_text(_topic(folder, line, members), encoding="utf-8")
    listed = "\n".join(f"   {folder}" for folder in topics())
    (source / "api" / "index.rst").write_text(_API.format(listed=listed), encoding="utf-8")
    for folder in ("_static", "_extra", "_templates/autosummary"):
        (source / folder).mkdir(parents=True)
    shutil.copy(Path(__file__).parent / "site.css", source / "_static")
    shutil.copy(figures / f"{PAGE}.html", source / "_extra" / ATLAS_FILE)
    for name, template in (("class", _CLASS), ("base", _OTHER)):
        (source / "_templates" / "autosummary" / f"{name}.rst").write_text(template, encoding="utf-8")


def _with_pictures(text: str, pictures: Path, figures: Path) -> str:
    """Return a page whose links lead to where the site has what they name; copy its pictures."""
    text = re.sub(r"\]\((?:\.\./)*(?:\.\./)?beammodes/pages/", "](", text)
    text = re.sub(r"\]\((?:\.\./)*\.github/CONTRIBUTING\.md", "](contributing.md", text)
    text = re.sub(r"\]\((?:\.\./)+figures/", "](figures/", text)
    # The line that ends a doctest before its fence is nothing to show.
    text = re.sub(r"^(```\w+\n.*?)\n+(^```$)", r"\1\n\2", text, flags=re.MULTILINE | re.DOTALL)
    for name in set(re.findall(r"\]\(figures/([\w.]+)\)", text)):
        target = pictures / name
        target.write_bytes((figures / name).read_bytes())
        if target.suffix == ".md":
            target.write_text(
                f"---\norphan: true\n---\n\n{target.read_text(encoding='utf-8')}", encoding="utf-8"
            )
        elif target.suffix == ".csv":
            text = text.replace(f"](figures/{name})", f"](path:figures/{name})")
    return text


def _contents() -> str:
    parts = [
        f"\n```{{toctree}}\n:hidden:\n:caption: {title}\n\n" + "\n".join(names) + "\n```\n"
        for title, names in chapters().items()
    ]
    parts.insert(-1, "\n```{toctree}\n:hidden:\n:caption: Reference\n\napi/index\natlas\n```\n")
    return "".join(parts)


def _topic(folder: str, line: str, members: list[str]) -> str:
    title = f"{folder.replace('_', ' ').capitalize()}: {line}"
    names = "\n".join(f"   {name}" for name in members)
    head = f"{title}\n{'=' * len(title)}\n\n.. currentmodule:: beammodes\n\n"
    return f"{head}.. autosummary::\n   :toctree: generated\n   :nosignatures:\n\n{names}\n"


_API = """API
===

All names are in the package: ``import beammodes as bm``, then ``bm.Beam`` and so on.

.. toctree::
   :maxdepth: 1

{listed}
"""

_ATLAS = f"""# The atlas, and the report regenerated

One page of its own (7 MB). First an atlas of all ends and rules, in bending and twist: springs, segments
needed, stable steps and errors, in SI units if the beam's numbers are given, with bodies at free ends; and
rods in space. Then the whole report regenerated, ours beside what it prints.

<a href="{ATLAS_FILE}">Open the page.</a>
"""

_CLASS = """{{ objname | escape | underline }}

.. currentmodule:: {{ module }}

.. autoclass:: {{ objname }}
   :members:
   :inherited-members:
"""

_OTHER = """{{ objname | escape | underline }}

.. currentmodule:: {{ module }}

.. auto{{ objtype }}:: {{ objname }}
"""
