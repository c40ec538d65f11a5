"""Model files that only MuJoCo can expand, expanded by it where it is installed, in a process with limits.

What MuJoCo is given is written anew from what was read within bounds: without pictures, sensors and
keyframes, with copies of meshes and attached models that are in the model's own folder. It opens no file by a
name of the user's, and is stopped after 10 s of processor time, or 30 s in all, or at 1 GiB.
"""

from __future__ import annotations

import contextlib
import importlib.util
import os
import subprocess
import sys
import tempfile
from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path
from xml.sax.saxutils import quoteattr

from beammodes.auditing import mujoco_process
from beammodes.auditing.body_tree import Model, SpringPlace
from beammodes.auditing.bounded_xml import MAX_BYTES, BadModel, XmlElement, bounded_bytes, read_xml
from beammodes.checks import shown

__all__ = ["expanded_by_mujoco", "needs_mujoco", "with_places_of_no_file"]

_SECONDS, _WAIT, _BYTES = 10, 30.0, 2**30
_MOST_FILES = 50
#: Parts of a model that do not move a chain, and may name files.
_LEFT_OUT = {"visual", "statistic", "sensor", "keyframe", "texture", "material", "hfield", "skin", "light"}
#: Attributes that name what is left out, or where files are.
_UNSAID = {"material", "texture", "hfield", "meshdir", "texturedir", "assetdir", "strippath", "plugindir"}
_MESHES = (".stl", ".obj", ".msh")
_SHOWN = 200


def needs_mujoco(root: XmlElement) -> str:
    """Return the first element of a model that only MuJoCo can expand, empty if there is none."""
    waiting = [root]
    while waiting:
        element = waiting.pop()
        kind = element.attributes.get("type", "")
        mesh = element.tag == "geom" and ("mesh" in element.attributes or kind in ("mesh", "sdf"))
        shell = element.attributes.get("shellinertia") == "true"
        cable = element.tag == "composite" and kind == "cable"
        if (element.tag in ("attach", "composite") and not cable) or mesh or shell:
            return element.where
        waiting += element.children[::-1]
    return ""


def expanded_by_mujoco(
    root: XmlElement, place: Path, included: Callable[[XmlElement, Path], object]
) -> tuple[XmlElement, str]:
    """Return the root of what MuJoCo makes of a model file, included files in place, and MuJoCo's version.

    `included` puts included files into an attached model. BadModel says in one line why there is none: MuJoCo
    is not installed, refuses the model, or was stopped at a limit.
    """
    if importlib.util.find_spec("mujoco") is None:
        raise BadModel("MuJoCo, which could expand it (pip install mujoco), is not installed")
    if importlib.util.find_spec("resource") is None:
        raise BadModel("MuJoCo could expand it, but is run here only on systems that limit its memory")
    files = _Files(place, included)
    files.contents["model.xml"] = files.written(root, place.parent)
    with tempfile.TemporaryDirectory(prefix="beammodes-") as folder:
        own = Path(folder)
        for name, content in files.contents.items():
            (own / name).write_bytes(content)
        return _run(own)


def _run(folder: Path) -> tuple[XmlElement, str]:
    # Nothing of the user's is an argument, and no shell reads these.
    command = [sys.executable, "-P", mujoco_process.__file__, str(folder), str(_SECONDS), str(_BYTES)]
    own = {"OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"}
    with contextlib.suppress(subprocess.TimeoutExpired):
        subprocess.run(
            command,
            cwd=folder,
            env={**os.environ, **own},
            stdin=subprocess.DEVNULL,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
            timeout=_WAIT,
            check=False,
        )
    refused, expanded = folder / "refused.txt", folder / "expanded.xml"
    if refused.is_file():
        why = " ".join(bounded_bytes(refused).decode(errors="replace").split())[:_SHOWN]
        said = "".join(letter if letter.isprintable() else "?" for letter in why)
        raise BadModel(f"MuJoCo could not expand it: {said}")
    if not (folder / "version.txt").is_file():
        limits = f"{_SECONDS} s, {_BYTES // 2**20} MiB and a file of {MAX_BYTES // 2**20} MiB"
        raise BadModel(f"MuJoCo, which is given {limits}, ended without an answer")
    version = (folder / "version.txt").read_text(encoding="utf-8")
    return read_xml(expanded, f"as MuJoCo {version} expands it"), version


class _Files:
    """The files of a model that MuJoCo is given, under names of our own."""

    def __init__(self, place: Path, included: Callable[[XmlElement, Path], object]) -> None:
        self.inside = place.parent.resolve()
        #: Models that are being written.
        self.open = [place.resolve()]
        self.included = included
        self.contents: dict[str, bytes] = {}
        self.names: dict[Path, str] = {}

    def written(self, root: XmlElement, folder: Path) -> bytes:
        """Return a model as text, with the files that it names under their new names."""
        said = [each for each in root.children if each.tag == "compiler"]
        where = {key: value for each in said for key, value in each.attributes.items()}
        meshes = folder / where.get("meshdir", where.get("assetdir", ""))
        exact = XmlElement("compiler", {"saveinertial": "true"} if _has_meshes(root) else {}, 0)
        root = replace(root, tag="mujoco", children=[*root.children, exact])
        return "".join(self._text(root, meshes, folder)).encode()

    def _text(self, root: XmlElement, meshes: Path, folder: Path) -> Iterator[str]:
        waiting: list[XmlElement | str] = [root]
        while waiting:
            element = waiting.pop()
            if isinstance(element, str):
                yield element
                continue
            if element.tag in _LEFT_OUT or element.attributes.get("type") == "hfield":
                continue
            if not element.tag.isidentifier():
                element.refuse("must have a plain name")
            own = {key: value for key, value in element.attributes.items() if key not in _UNSAID}
            for key in [key for key in own if key.startswith("file")]:
                base = {"mesh": meshes, "model": folder}.get(element.tag)
                if key != "file" or base is None:
                    element.refuse(f"must name no file by {key} for MuJoCo to expand it")
                own.setdefault("name", Path(own[key]).stem)
                own[key] = self._name(element, base / own[key])
                own.pop("content_type", None)
            # Line breaks in values would be blanks when they are read again.
            pairs = "".join(f" {key}={quoteattr(value)}" for key, value in own.items())
            yield f"<{element.tag}{pairs}>\n"
            waiting += [f"</{element.tag}>\n", *element.children[::-1]]

    def _name(self, element: XmlElement, path: Path) -> str:
        """Return the name under which MuJoCo has a file; refuse one outside the model's folder."""
        place = path.resolve()
        said = shown(element.attributes["file"])
        if self.inside not in place.parents:
            element.refuse(f"must name a file in the model's own folder, got {said}")
        if place in self.open:
            element.refuse(f"must not attach a model to itself, got {said}")
        if place in self.names:
            return self.names[place]
        if len(self.names) >= _MOST_FILES:
            element.refuse(f"must be one of at most {_MOST_FILES} files")
        kind = ".xml" if element.tag == "model" else place.suffix.lower()
        if element.tag == "mesh" and kind not in _MESHES:
            element.refuse(f"must be a mesh of type {', '.join(_MESHES)}, got {said}")
        self.names[place] = name = f"{element.tag}{len(self.names)}{kind}"
        try:
            if element.tag == "model":
                root = read_xml(place, said)
                self.included(root, place.parent)
                self.open.append(place)
                self.contents[name] = self.written(root, place.parent)
                self.open.pop()
            else:
                self.contents[name] = _plain(bounded_bytes(place), kind)
        except OSError as error:
            element.refuse(f"must name a file that can be read: {error.strerror or error}")
        if sum(map(len, self.contents.values())) > 4 * MAX_BYTES:
            element.refuse(f"must name files of at most {4 * MAX_BYTES // 2**20} MiB in all")
        return name


def _has_meshes(root: XmlElement) -> bool:
    waiting = [root]
    while waiting:
        element = waiting.pop()
        if "mesh" in element.attributes or element.tag == "mesh" or "shellinertia" in element.attributes:
            return True
        waiting += element.children
    return False


def _plain(content: bytes, kind: str) -> bytes:
    """Return a mesh without the names of further files."""
    if kind != ".obj":
        return content
    return b"\n".join(line for line in content.splitlines() if not line.lstrip().startswith(b"mtllib"))


def with_places_of_no_file(model: Model, version: str, element: str) -> Model:
    """Return a model that MuJoCo expanded, whose springs have no places in the user's file."""
    place = SpringPlace(
        "attribute", 0, refusal=f"the file was expanded by MuJoCo {version}: save that, and mend it"
    )
    bodies = tuple(
        replace(body, joints=tuple(replace(joint, place=place) for joint in body.joints))
        for body in model.bodies
    )
    ties = tuple(replace(tie, place=place) for tie in model.ties)
    given = (f"read as MuJoCo {version} expands it, for {element}", *model.given)
    rods = tuple(replace(rod, place=place) for rod in model.rods)
    return replace(model, bodies=bodies, ties=ties, given=given, rods=rods)
