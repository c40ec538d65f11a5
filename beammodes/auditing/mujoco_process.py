"""Run as a script, in a process of its own with limits: what MuJoCo makes of a model.

``python mujoco_process.py FOLDER SECONDS BYTES`` reads model.xml in that folder, with the files that it names
there, and writes expanded.xml and version.txt, or refused.txt. It sees no other file of the user's: the names
are those that the caller has given.
"""

from __future__ import annotations

import ctypes
import sys
from pathlib import Path
from typing import Any

__all__ = ["main"]

#: A file of a chain of 600 bodies has less.
_LARGEST_FILE = 16 * 2**20
#: Digits that tell every double apart.
_DIGITS = 17


def _limit(seconds: int, size: int) -> None:
    """Let the system stop this process beyond these bounds."""
    import resource
    import signal

    for what, most in (
        (resource.RLIMIT_CPU, seconds),
        (resource.RLIMIT_AS, size),
        (resource.RLIMIT_FSIZE, _LARGEST_FILE),
        (resource.RLIMIT_CORE, 0),
    ):
        resource.setrlimit(what, (most, most))
    # A file beyond the bound is an error then, not the end.
    signal.signal(signal.SIGXFSZ, signal.SIG_IGN)


def _write_all_digits(mujoco: Any) -> None:
    """Have numbers written with all their digits, not with six, if this version of MuJoCo can."""
    for library in Path(mujoco.__file__).parent.glob("*mujoco.*"):
        try:
            ctypes.CDLL(str(library))._mjPRIVATE__set_xml_precision(_DIGITS)
        except (OSError, AttributeError):
            continue


def main(folder: Path) -> None:
    """Write what MuJoCo makes of the model in that folder, or why it refuses it."""
    # It ships no types.
    import mujoco  # type: ignore[import-untyped]

    try:
        _write_all_digits(mujoco)
        spec = mujoco.MjSpec.from_file(str(folder / "model.xml"))
        spec.compile()
        text = spec.to_xml()
    except Exception as error:
        # Whatever a library of another language throws.
        (folder / "refused.txt").write_text(f"{error}", encoding="utf-8")
        return
    (folder / "expanded.xml").write_text(text, encoding="utf-8")
    (folder / "version.txt").write_text(mujoco.__version__, encoding="utf-8")


if __name__ == "__main__":
    _limit(int(sys.argv[2]), int(sys.argv[3]))
    main(Path(sys.argv[1]))
