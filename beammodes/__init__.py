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
    "Audit": "audit",
    "BOUNDARIES": "ends",
    "BaseMotion": "base_motion",
    "Beam": "beam",
    "BeamModes": "exact_beam",
    "BentModel": "bent_model",
    "Boundary": "ends",
    "Box": "sections",
    "Chain": "chain",
    "Circle": "sections",
    "Damping": "damping",
    "DivergedWarning": "simulation",
    "ENDS": "supports",
    "End": "supports",
    "Equilibrium": "equilibria",
    "EquilibriumNotFound": "equilibria",
    "GivenSection": "sections",
    "ISection": "sections",
    "LinearModel": "linear",
    "Load": "loading",
    "MODULI": "materials",
    "Modes": "modes",
    "RULES": "rules",
    "Rectangle": "sections",
    "Rule": "rules",
    "SlendernessWarning": "comparison",
    "SpectralBeamModes": "spectral_shapes",
    "SupportedBeamModes": "supported_beam",
    "Table": "profiles",
    "Tube": "sections",
    "Weight": "rules",
    "animate": "animation",
    "audit_chain": "audit",
    "axially_corrected": "axial_rule",
    "beam_statics": "statics",
    "buckling_dataset": "buckling",
    "buckling_load": "buckling",
    "chain_errors": "comparison",
    "chain_frequency": "dispersion",
    "chain_statics": "statics",
    "compile_equations": "numeric",
    "damped_modes": "damping_ratio",
    "damped_time_step": "damping_ratio",
    "elastic_modulus": "materials",
    "equations_of_motion": "symbolic",
    "error_dataset": "error_table",
    "error_law": "law",
    "euler_bernoulli": "beam_theory",
    "export_chain": "export",
    "find_equilibrium": "equilibria",
    "frequency_error": "errors",
    "from_sectionproperties": "sections",
    "harmonic": "base_motion",
    "joint_dampers": "damping_ratio",
    "linearize": "linear",
    "match_springs": "inverse",
    "matched": "inverse",
    "modal_assurance": "shapes",
    "modal_response": "superposition",
    "mode_start": "simulation",
    "mode_tuned": "tuning",
    "published_time_step": "stability",
    "read_chain_csv": "chain_csv",
    "recommend": "advice",
    "segments_needed": "errors",
    "shape_dataset": "shapes",
    "simulate": "simulation",
    "solve_modes": "modes",
    "spin_up": "base_motion",
    "stable_time_step": "stability",
    "static_dataset": "static_errors",
    "stiffness_from_deflection": "identification",
    "stiffness_from_frequency": "identification",
    "symbolic_energies": "symbolic",
    "theory_errors": "comparison",
    "wavenumber": "wavenumbers",
}

__all__ = sorted([*_HOME, "__version__"])

if TYPE_CHECKING:
    from beammodes.advice import recommend as recommend
    from beammodes.animation import animate as animate
    from beammodes.audit import Audit as Audit
    from beammodes.audit import audit_chain as audit_chain
    from beammodes.axial_rule import axially_corrected as axially_corrected
    from beammodes.base_motion import BaseMotion as BaseMotion
    from beammodes.base_motion import harmonic as harmonic
    from beammodes.base_motion import spin_up as spin_up
    from beammodes.beam import Beam as Beam
    from beammodes.beam_theory import euler_bernoulli as euler_bernoulli
    from beammodes.bent_model import BentModel as BentModel
    from beammodes.buckling import buckling_dataset as buckling_dataset
    from beammodes.buckling import buckling_load as buckling_load
    from beammodes.chain import Chain as Chain
    from beammodes.chain_csv import read_chain_csv as read_chain_csv
    from beammodes.comparison import SlendernessWarning as SlendernessWarning
    from beammodes.comparison import chain_errors as chain_errors
    from beammodes.comparison import theory_errors as theory_errors
    from beammodes.damping import Damping as Damping
    from beammodes.damping_ratio import damped_modes as damped_modes
    from beammodes.damping_ratio import damped_time_step as damped_time_step
    from beammodes.damping_ratio import joint_dampers as joint_dampers
    from beammodes.dispersion import chain_frequency as chain_frequency
    from beammodes.ends import BOUNDARIES as BOUNDARIES
    from beammodes.ends import Boundary as Boundary
    from beammodes.equilibria import Equilibrium as Equilibrium
    from beammodes.equilibria import EquilibriumNotFound as EquilibriumNotFound
    from beammodes.equilibria import find_equilibrium as find_equilibrium
    from beammodes.error_table import error_dataset as error_dataset
    from beammodes.errors import frequency_error as frequency_error
    from beammodes.errors import segments_needed as segments_needed
    from beammodes.exact_beam import BeamModes as BeamModes
    from beammodes.export import export_chain as export_chain
    from beammodes.identification import stiffness_from_deflection as stiffness_from_deflection
    from beammodes.identification import stiffness_from_frequency as stiffness_from_frequency
    from beammodes.inverse import match_springs as match_springs
    from beammodes.inverse import matched as matched
    from beammodes.law import error_law as error_law
    from beammodes.linear import LinearModel as LinearModel
    from beammodes.linear import linearize as linearize
    from beammodes.loading import Load as Load
    from beammodes.materials import MODULI as MODULI
    from beammodes.materials import elastic_modulus as elastic_modulus
    from beammodes.modes import Modes as Modes
    from beammodes.modes import solve_modes as solve_modes
    from beammodes.numeric import compile_equations as compile_equations
    from beammodes.profiles import Table as Table
    from beammodes.rules import RULES as RULES
    from beammodes.rules import Rule as Rule
    from beammodes.rules import Weight as Weight
    from beammodes.sections import Box as Box
    from beammodes.sections import Circle as Circle
    from beammodes.sections import GivenSection as GivenSection
    from beammodes.sections import ISection as ISection
    from beammodes.sections import Rectangle as Rectangle
    from beammodes.sections import Tube as Tube
    from beammodes.sections import from_sectionproperties as from_sectionproperties
    from beammodes.shapes import modal_assurance as modal_assurance
    from beammodes.shapes import shape_dataset as shape_dataset
    from beammodes.simulation import DivergedWarning as DivergedWarning
    from beammodes.simulation import mode_start as mode_start
    from beammodes.simulation import simulate as simulate
    from beammodes.spectral_shapes import SpectralBeamModes as SpectralBeamModes
    from beammodes.stability import published_time_step as published_time_step
    from beammodes.stability import stable_time_step as stable_time_step
    from beammodes.static_errors import static_dataset as static_dataset
    from beammodes.statics import beam_statics as beam_statics
    from beammodes.statics import chain_statics as chain_statics
    from beammodes.superposition import modal_response as modal_response
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
