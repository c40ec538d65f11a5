"""Output, failures and interrupts of the command line: any encoding, one line for an error, exit codes."""

from __future__ import annotations

import codecs
import errno
import os
import signal
import sys
import threading
import traceback
import warnings
from types import FrameType, MappingProxyType
from typing import Any, TextIO

__all__ = [
    "EXIT_CODES",
    "FAULT",
    "INTERRUPTED",
    "INTERRUPTS",
    "NOT_MET",
    "NO_ANSWER",
    "Unwritable",
    "after_failure",
    "as_a_process",
    "interrupted",
    "put",
    "readable",
    "tell",
    "tell_all",
    "unwritable",
]

NOT_MET, NO_ANSWER, FAULT, INTERRUPTED = 1, 2, 3, 130

#: The meaning of each exit code.
EXIT_CODES = MappingProxyType(
    {
        0: "done",
        NOT_MET: "audit: the tolerance is not met, by the file that is written if there is one",
        NO_ANSWER: "no answer: bad input, or an answer that cannot be written, told in one line",
        FAULT: "a fault of this program, not of the input",
        INTERRUPTED: "interrupted by Ctrl-C",
    }
)

# How a character is written where the encoding lacks it; all others become escapes such as \u2603.
_SPELLED = """
α=alpha β=beta γ=gamma δ=delta ε=epsilon ζ=zeta η=eta θ=theta κ=kappa λ=lambda μ=mu ν=nu ξ=xi π=pi ρ=rho
σ=sigma τ=tau φ=phi χ=chi ψ=psi ω=omega Δ=Delta Σ=sum Φ=Phi Ω=Omega ℓ=ell
ᵀ=^T ⁻=^- ⁰=^0 ¹=^1 ²=^2 ³=^3 ⁴=^4 ⁵=^5 ⁶=^6 ⁷=^7 ⁸=^8 ⁹=^9 ₀=0 ₁=1 ₂=2 ₃=3 ₄=4 ₅=5 ₆=6 ₇=7 ₈=8 ₉=9
√=sqrt ∞=inf ∂=d ∫=integral ∝=~ ≈=~ ≠=!= ≤=<= ≥=>= ±=+- ×=x ·=* ½=1/2 ¼=1/4 ‖=| ′=' °=deg §=section
–=- —=- −=- …=... →=-> ←=<- ’=' “=" ”=" ä=ae ö=oe ü=ue Ä=Ae Ö=Oe Ü=Ue ß=ss é=e è=e
"""
_PLAIN = {word[0]: word[2:] for word in _SPELLED.split()}


def _plainly(error: UnicodeError) -> tuple[str, int]:
    if not isinstance(error, UnicodeEncodeError):
        raise error
    lost = error.object[error.start : error.end]
    plain = "".join(_PLAIN.get(c) or c.encode("ascii", "backslashreplace").decode("ascii") for c in lost)
    return plain, error.end


codecs.register_error("beammodes.plain", _plainly)


def readable(text: str, encoding: str | None) -> str:
    """Return text that an encoding can hold; characters that it lacks are spelled in ASCII.

    Examples
    --------
    >>> readable("√(EI/ρA) in N m², ±1 %, Ö, \\N{SNOWMAN}", "cp1252")
    'sqrt(EI/rhoA) in N m², ±1 %, Ö, \\\\u2603'
    """
    if encoding is None:
        return text
    try:
        return text.encode(encoding, "beammodes.plain").decode(encoding)
    except LookupError:
        return text


class Unwritable(Exception):
    """Standard output takes nothing more; the message says why, and is empty if the reader has left."""


def put(text: str, stream: TextIO | None) -> None:
    """Write text to a stream such as stdout, all of it; raises Unwritable."""
    if stream is None:
        raise Unwritable("standard output is closed")
    try:
        stream.write(readable(text, getattr(stream, "encoding", None)))
        stream.flush()
    except BrokenPipeError:
        # The reader, such as `head`, has seen enough.
        raise Unwritable from None
    except OSError as error:
        # What Windows says of a pipe without a reader.
        if os.name == "nt" and error.errno == errno.EINVAL:
            raise Unwritable from None
        raise Unwritable(error.strerror or str(error)) from None
    except ValueError as error:
        raise Unwritable(str(error)) from None


def tell(message: str) -> None:
    """Write one line to stderr; where that fails, only the exit code tells."""
    try:
        put(f"beammodes: {' '.join(message.splitlines())}\n", sys.stderr)
    except Unwritable:
        _leave(sys.stderr)


def _leave(stream: TextIO | None) -> None:
    """Discard what a stream still holds: Python would complain when it closes it."""
    try:
        nowhere = os.open(os.devnull, os.O_WRONLY)
        os.dup2(nowhere, stream.fileno()) if stream is not None else None
        os.close(nowhere)
    except (OSError, ValueError):
        # A stream without a file behind it keeps nothing.
        return


def unwritable(error: Unwritable, code: int) -> int:
    """Return the exit code after an answer that could not be written: the usual one if its reader left."""
    _leave(sys.stdout)
    if not str(error):
        return code
    tell(f"the answer cannot be written: {error}")
    return NO_ANSWER


_OF_PYTHON = (ZeroDivisionError, OverflowError, FloatingPointError)


def after_failure(error: BaseException) -> int:
    """Tell in one line why there is no answer, and return the exit code."""
    if isinstance(error, KeyboardInterrupt) or INTERRUPTS.count:
        # A compiled library may have made another error of the interrupt.
        return interrupted()
    debug = os.environ.get("BEAMMODES_DEBUG", "0") not in ("", "0")
    if debug:
        tell_all("".join(traceback.format_exception(error)))
    if isinstance(error, MemoryError):
        tell("there is not enough memory for this: ask for fewer segments or modes")
        return NO_ANSWER
    # NumPy and SciPy derive errors of their own from ValueError; a text that no codec takes is one, too.
    ours = type(error).__module__.partition(".")[0] in ("builtins", "beammodes", "argparse")
    told = isinstance(error, TypeError | ValueError | OSError) and not isinstance(error, UnicodeError)
    # An ArithmeticError says that there is no answer to be computed; those of Python itself are faults.
    told = told or (isinstance(error, ArithmeticError) and not isinstance(error, _OF_PYTHON))
    if told and ours and isinstance(error, Exception):
        tell(_said(error))
        return NO_ANSWER
    what = "this" if debug else "what it prints with BEAMMODES_DEBUG=1 set"
    tell(
        f"a fault of this program, not of your input: {type(error).__name__}: {error} (please report {what})"
    )
    return FAULT


def tell_all(text: str) -> None:
    """Write lines to stderr."""
    try:
        put(text, sys.stderr)
    except Unwritable:
        _leave(sys.stderr)


def interrupted() -> int:
    """Tell that the user has stopped the command, and return the exit code."""
    INTERRUPTS.ignore()
    tell("interrupted: files that were finished are kept")
    return INTERRUPTED


def _said(error: Exception) -> str:
    if isinstance(error, OSError) and error.filename and error.strerror:
        return f"{error.strerror[0].lower()}{error.strerror[1:]}: {error.filename}"
    message = str(error)
    for name, typed in _TYPED.items():
        message = message.replace(name, typed)
    return message


#: Words of the library's messages, as the user typed them.
_TYPED = {
    "second_bending_stiffness must": "--ei-across must",
    "torsional_stiffness must": "--gj must",
    "polar_inertia_per_length must": "--rho-ip must",
    "axial_stiffness must": "--ea must",
    "bending_stiffness must": "--ei must",
    "mass_per_length must": "--rho-a must",
    "axial_force must": "--axial-force must",
    "tolerance must": "--tolerance must",
    "say by boundary": "say by --boundary",
    "force=True": "--force",
    "second must": "--ei-across must",
    "gravity": "--gravity",
    "tip_force": "--tip-force",
    "load must be left out": "--gravity, --axial-force and --tip-force must be left out",
}


class Interrupts:
    """Ctrl-C while the command line runs: the first stops the work.

    The second is ignored while the work stops. The third ends the process at once, in case a compiled library
    has swallowed the first.
    """

    count = 0
    _listening = False

    def listen(self) -> None:
        """Take Ctrl-C from now on; only the main thread can."""
        if threading.current_thread() is threading.main_thread():
            self._listening = signal.getsignal(signal.SIGINT) is not signal.SIG_IGN
            if self._listening:
                signal.signal(signal.SIGINT, self._heard)
            sys.unraisablehook = self._unraisable

    def ignore(self) -> None:
        """Ignore Ctrl-C from now on: what is left to do takes no time."""
        if self._listening:
            signal.signal(signal.SIGINT, signal.SIG_IGN)

    def _heard(self, _number: int, _frame: FrameType | None) -> None:
        self.count += 1
        if self.count == 1:
            raise KeyboardInterrupt
        if self.count == 3:
            tell("interrupted: files that were finished are kept")
            os._exit(INTERRUPTED)

    def _unraisable(self, what: Any) -> None:
        # An interrupt that came while Python cleaned up would be shown, and then passed over.
        if not self.count:
            sys.__unraisablehook__(what)


INTERRUPTS = Interrupts()


def as_a_process() -> None:
    """Take the signals of the process, and show warnings as one line each."""
    INTERRUPTS.listen()
    warnings.showwarning = _warned


def _warned(message: Warning | str, category: type[Warning], *_where: Any, **_source: Any) -> None:
    tell(f"{category.__name__}: {message}")
