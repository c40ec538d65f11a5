"""A chain as a CSV file, a row for every piece, which is read back without loss."""

from __future__ import annotations

import csv
import math
import os
from collections.abc import Iterator, Sequence
from fractions import Fraction
from pathlib import Path

from beammodes.chains.chain import Chain
from beammodes.checks import shown
from beammodes.files import ordinary_text
from beammodes.problem.ends import Boundary, End

__all__ = ["csv_lines", "read_chain_csv"]

#: Columns of the file after `piece`, by the arguments of `Chain.from_pieces`.
_NAMES = {
    "length": "length_m",
    "mass": "mass_kg",
    "centre": "centre_m",
    "rotary_inertia": "rotary_inertia_kg_m2",
    "joint_stiffness": "hinge_to_next_n_m_per_rad",
}
_COLUMNS = ("piece", *_NAMES.values())
_ENDS = "# supports:"
#: Larger files are refused; within these limits one is read and judged in seconds.
_MOST_BYTES, _MOST_ROWS, _LONGEST_LINE = 16 * 2**20, 100_100, 10_000
#: Products of numbers in between neither overflow nor underflow.
_SMALLEST, _LARGEST = 1e-100, 1e30


def csv_lines(chain: Chain, lines: Sequence[str]) -> Iterator[str]:
    """Yield the lines of a CSV file, headed by comments with `lines`.

    Examples
    --------
    >>> from beammodes.problem.beam import Beam
    >>> for line in csv_lines(Chain(Beam.unit(), "clamped-free", 1), []):
    ...     print(line, end="")
    # pieces of a chain from left to right; centre of mass from a piece's left tip, inertia about it
    # pieces hold the bodies fixed to the ends; the hinge is at a piece's right tip
    # supports: clamped-free
    piece,length_m,mass_kg,centre_m,rotary_inertia_kg_m2,hinge_to_next_n_m_per_rad
    0,0.0,0.0,0.0,0.0,3.0
    1,1.0,1.0,0.5,0.08333333333333333,
    """
    ends = Boundary(*(End(*map(float, end)) for end in chain.support_stiffness))
    yield "# pieces of a chain from left to right; centre of mass from a piece's left tip, inertia about it\n"
    yield "# pieces hold the bodies fixed to the ends; the hinge is at a piece's right tip\n"
    yield from (f"# {line}\n" for line in lines)
    yield f"{_ENDS} {ends.name}\n{','.join(_COLUMNS)}\n"
    columns = (chain.length, chain.mass, chain.centre, chain.rotary_inertia)
    numbers = zip(*(column.tolist() for column in columns), strict=True)
    springs = [*map(repr, chain.joint_stiffness.tolist()), ""]
    for i, (row, spring) in enumerate(zip(numbers, springs, strict=True)):
        yield ",".join([str(i), *map(repr, row), spring]) + "\n"


def read_chain_csv(path: str | os.PathLike[str]) -> Chain:
    """Return the chain of a file that `export_chain` wrote; its numbers are those of the chain, to the bit.

    The bodies at the ends are parts of the outer pieces then, and the beam and its rule are not known. Rows
    must be numbered from 0 in their order, and only the last has no hinge: so a file that is cut short or
    sorted otherwise is refused.

    Parameters
    ----------
    path : str or Path

    Returns
    -------
    Chain
        Without a beam and a rule.

    Raises
    ------
    ValueError
        If the file is no such table, no ordinary file, larger than 16 MiB or of more than 100,000 pieces, or
        a number is larger than 1e30 or smaller than 1e-100; the message names the line.
    OSError
        If it cannot be read.

    Examples
    --------
    >>> import tempfile
    >>> import beammodes as bm
    >>> chain = bm.Chain(bm.Beam(1.2, 85.0, 0.62), "clamped-free", segments=7)
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     written = bm.export_chain(chain, f"{folder}/beam.csv")
    ...     again = bm.read_chain_csv(f"{folder}/beam.csv")
    >>> again.length.tolist() == chain.length.tolist(), again.boundary
    (True, Boundary('clamped-free'))
    """
    if not isinstance(path, str | os.PathLike) or isinstance(os.fspath(path), bytes):
        raise TypeError(f"path must be a str or a Path, got {shown(path)}")
    place = Path(path)
    text = ordinary_text(place, _MOST_BYTES)
    rows = list(enumerate(text.splitlines(), start=1))
    if len(rows) > _MOST_ROWS:
        raise ValueError(f"{place} must have at most {_MOST_ROWS} lines, got {len(rows)}")
    supports = [line for line in rows if line[1].startswith(_ENDS)]
    if len(supports) != 1:
        raise ValueError(f'{place} must have one line "{_ENDS} ...", got {len(supports)}')
    try:
        boundary = Boundary.of(supports[0][1].removeprefix(_ENDS).strip())
        columns = _numbers(place, [row for row in rows if row[1].strip() and not row[1].startswith("#")])
        # Seen from the other end a centre is length - centre; only fractions come back from there unrounded.
        exact = {name: list(map(Fraction, columns.pop(name))) for name in ("length", "centre")}
        return Chain.from_pieces(**exact, **columns, boundary=boundary)
    except ValueError as error:
        message = str(error)
        where = "" if message.startswith(str(place)) else f"{place}: "
        raise ValueError(f"{where}{message}") from None


def _numbers(place: Path, rows: list[tuple[int, str]]) -> dict[str, list[float]]:
    heading = rows[0][1][:_LONGEST_LINE].split(",") if rows else []
    missing = [name for name in _COLUMNS if name not in heading]
    if missing:
        raise ValueError(f"{place} must have a heading with column {missing[0]}")
    table: dict[str, list[float]] = {name: [] for name in _NAMES}
    last = len(rows) - 1
    for i, (number, text) in enumerate(rows[1:], start=1):
        if len(text) > _LONGEST_LINE:
            raise ValueError(f"{place}, line {number}: must have at most {_LONGEST_LINE} characters")
        cells = next(csv.reader([text]))
        if len(cells) != len(heading):
            raise ValueError(f"{place}, line {number}: must have {len(heading)} cells, got {len(cells)}")
        row = dict(zip(heading, cells, strict=True))
        if row["piece"].strip() != str(i - 1):
            raise ValueError(
                f"{place}, line {number}: piece must be {i - 1}, as rows are numbered in their order, got "
                f"{shown(row['piece'])}"
            )
        if (not row[_COLUMNS[-1]].strip()) != (i == last):
            raise ValueError(
                f"{place}, line {number}: {_COLUMNS[-1]} must be empty in the last row and in no other: the "
                "file is cut short or rows are missing"
            )
        for name, column in _NAMES.items():
            if name != "joint_stiffness" or i < last:
                table[name].append(_number(f"{place}, line {number}: {column}", row[column]))
    return table


def _number(name: str, text: str) -> float:
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if not math.isfinite(value):
        raise ValueError(f"{name} must be a finite number, got {shown(text)}")
    if value and not _SMALLEST <= abs(value) <= _LARGEST:
        raise ValueError(f"{name} must be 0 or from {_SMALLEST:g} to {_LARGEST:g} in size, got {shown(text)}")
    return value
