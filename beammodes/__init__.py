"""Chains of rigid segments and rotational springs that stand for flexible beams, and how wrong they are.

The workflow, step by step:

1. a beam, in any consistent units

   >>> import beammodes as bm
   >>> beam = bm.Beam(length=1.2, bending_stiffness=85.0, mass_per_length=0.62)

2. its two ends, a rule and N make a chain; these are the springs to type into a multibody tool

   >>> chain = bm.Chain(beam, "clamped-free", segments=6, rule="mitiguy")
   >>> chain.joint_stiffness.round(2)
   array([900., 425., 425., 425., 425., 425.])

3. the chain's nonlinear equations of motion, in symbols, and their exact linearization

   >>> equations = bm.equations_of_motion(chain)
   >>> equations.linearize().mass_matrix[0, 0]
   16*ell**2*m/3

4. the linear model and its natural modes

   >>> modes = bm.solve_modes(bm.linearize(chain), modes=3)
   >>> modes.frequency.round(3)                                         # Hz
   array([ 4.534, 27.539, 74.944])

5. the exact beam, which judges them

   >>> bm.euler_bernoulli(beam, "clamped-free", modes=3).frequency.round(3)
   array([ 4.55 , 28.515, 79.843])

6. the error itself, needing no beam, and how many segments keep it small

   >>> round(bm.frequency_error("clamped-free", segments=6, mode=1), 7)
   -0.0035175
   >>> bm.segments_needed("clamped-clamped", tolerance=0.01, modes=3)
   26

7. the step at which the chain can be integrated, beside the one that the report publishes

   >>> bm.published_time_step(beam, modes=3) > bm.stable_time_step(chain, "rk4")
   True
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

__version__ = "0.1.0"

_HOME = {
    "BOUNDARIES": "ends",
    "Beam": "beam",
    "BeamModes": "exact_beam",
    "Boundary": "ends",
    "Chain": "chain",
    "ENDS": "supports",
    "End": "supports",
    "LinearModel": "linear",
    "Load": "loading",
    "Modes": "modes",
    "RULES": "rules",
    "Rule": "rules",
    "SlendernessWarning": "comparison",
    "SpectralBeamModes": "spectral_shapes",
    "SupportedBeamModes": "supported_beam",
    "Table": "profiles",
    "Weight": "rules",
    "axially_corrected": "axial_rule",
    "beam_statics": "statics",
    "buckling_dataset": "buckling",
    "buckling_load": "buckling",
    "chain_errors": "comparison",
    "chain_frequency": "dispersion",
    "chain_statics": "statics",
    "compile_equations": "numeric",
    "equations_of_motion": "symbolic",
    "error_dataset": "error_table",
    "error_law": "law",
    "euler_bernoulli": "beam_theory",
    "frequency_error": "errors",
    "linearize": "linear",
    "match_springs": "inverse",
    "matched": "inverse",
    "modal_assurance": "shapes",
    "mode_tuned": "tuning",
    "published_time_step": "stability",
    "recommend": "advice",
    "segments_needed": "errors",
    "shape_dataset": "shapes",
    "solve_modes": "modes",
    "stable_time_step": "stability",
    "static_dataset": "static_errors",
    "symbolic_energies": "symbolic",
    "theory_errors": "comparison",
    "wavenumber": "wavenumbers",
}

__all__ = sorted([*_HOME, "__version__"])

if TYPE_CHECKING:
    from beammodes.advice import recommend as recommend
    from beammodes.axial_rule import axially_corrected as axially_corrected
    from beammodes.beam import Beam as Beam
    from beammodes.beam_theory import euler_bernoulli as euler_bernoulli
    from beammodes.buckling import buckling_dataset as buckling_dataset
    from beammodes.buckling import buckling_load as buckling_load
    from beammodes.chain import Chain as Chain
    from beammodes.comparison import SlendernessWarning as SlendernessWarning
    from beammodes.comparison import chain_errors as chain_errors
    from beammodes.comparison import theory_errors as theory_errors
    from beammodes.dispersion import chain_frequency as chain_frequency
    from beammodes.ends import BOUNDARIES as BOUNDARIES
    from beammodes.ends import Boundary as Boundary
    from beammodes.error_table import error_dataset as error_dataset
    from beammodes.errors import frequency_error as frequency_error
    from beammodes.errors import segments_needed as segments_needed
    from beammodes.exact_beam import BeamModes as BeamModes
    from beammodes.inverse import match_springs as match_springs
    from beammodes.inverse import matched as matched
    from beammodes.law import error_law as error_law
    from beammodes.linear import LinearModel as LinearModel
    from beammodes.linear import linearize as linearize
    from beammodes.loading import Load as Load
    from beammodes.modes import Modes as Modes
    from beammodes.modes import solve_modes as solve_modes
    from beammodes.numeric import compile_equations as compile_equations
    from beammodes.profiles import Table as Table
    from beammodes.rules import RULES as RULES
    from beammodes.rules import Rule as Rule
    from beammodes.rules import Weight as Weight
    from beammodes.shapes import modal_assurance as modal_assurance
    from beammodes.shapes import shape_dataset as shape_dataset
    from beammodes.spectral_shapes import SpectralBeamModes as SpectralBeamModes
    from beammodes.stability import published_time_step as published_time_step
    from beammodes.stability import stable_time_step as stable_time_step
    from beammodes.static_errors import static_dataset as static_dataset
    from beammodes.statics import beam_statics as beam_statics
    from beammodes.statics import chain_statics as chain_statics
    from beammodes.supported_beam import SupportedBeamModes as SupportedBeamModes
    from beammodes.supports import ENDS as ENDS
    from beammodes.supports import End as End
    from beammodes.symbolic import equations_of_motion as equations_of_motion
    from beammodes.symbolic import symbolic_energies as symbolic_energies
    from beammodes.tuning import mode_tuned as mode_tuned
    from beammodes.wavenumbers import wavenumber as wavenumber


def __getattr__(name: str) -> Any:
    if name not in _HOME:
        raise AttributeError(f"module 'beammodes' has no attribute {name!r}")
    value = getattr(import_module(f"beammodes.{_HOME[name]}"), name)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return __all__
