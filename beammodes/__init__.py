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

The plan of the code, a line for each folder; each uses only those above it:

numerics/      arrays, roots, long decimals: what knows no physics
problem/       a beam, its ends, sections and loads
exact/         the beam's own modes, which judge every chain
chains/        rules, and the chains of segments, hinges and springs that they make
equations/     a chain's equations of motion, in symbols and compiled; its shapes at rest
vibration/     the linear model: modes, damping, stable time steps
closed_form/   frequencies of uniform chains at a cost that does not grow with N
accuracy/      how wrong a chain is, why, and how many segments are enough
springs/       springs tuned to one mode, or matched to several
dynamics/      motion in time
exporters/     a chain as a file for a simulator
auditing/      chains that others made: read, judged and mended
batch/         studies of many chains, in chunks, kept in a store
views/         drawings and films
command_line/  the questions that the shell answers
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

#: Public names by the file that defines them: read when first asked for.
_NAMES = {
    "accuracy.advice": "recommend Recommendation Recommendations",
    "accuracy.buckling": "buckling_dataset buckling_load",
    "accuracy.chain_against_beam": "SlendernessWarning chain_errors theory_errors",
    "accuracy.chain_against_rod": "rod_error_dataset rod_errors",
    "accuracy.error_table": "derived_error_dataset error_dataset",
    "accuracy.errors": "frequency_error",
    "accuracy.identification": "stiffness_from_deflection stiffness_from_frequency",
    "accuracy.law": "error_law ErrorLaw law_holds_from",
    "accuracy.loaded_structures": "StructureStatics structure_chain_statics structure_statics",
    "accuracy.random_motion": "random_response",
    "accuracy.remarks": "error_remarks",
    "accuracy.response_law": "response_error",
    "accuracy.responses": "frequency_response",
    "accuracy.segments": "segments_needed ToleranceOutOfReach",
    "accuracy.shapes": "modal_assurance shape_dataset",
    "accuracy.statics": "beam_statics chain_statics static_dataset Statics",
    "accuracy.stressed_structures": "structure_modes_under",
    "accuracy.uncertainty": "EnoughSegments frequency_spread segments_within_spread Tolerance",
    "auditing.audit": "Audit audit_chain StepVerdict Suggestion",
    "auditing.audit_model": "audit_file",
    "auditing.axial_audit": "AxialAudit",
    "auditing.bounded_xml": "BadModel",
    "auditing.mended_files": "MendedFile mend_file",
    "auditing.space_audit": "SpatialAudit",
    "batch.cases": "Case",
    "batch.study": "Study open_study",
    "chains.axial_chain": "AxialChain",
    "chains.chain": "Chain",
    "chains.rods": "MissedFeatureWarning",
    "chains.rules": "axially_corrected AxiallyCorrected Layout NotClosed Rule RULES Weight",
    "chains.spatial_chain": "SpatialChain",
    "chains.structure_chain": "StructureChain",
    "closed_form.chain_frequencies": "chain_frequency",
    "dynamics.base_motion": "BaseMotion bang_bang harmonic point_to_point spin_up",
    "dynamics.simulation": (
        "DivergedWarning NothingMovesWarning UnsavedMotion UnstableStepWarning mode_start simulate"
    ),
    "dynamics.superposition": "modal_response",
    "dynamics.timed_loads": "TimedLoad",
    "dynamics.waveforms": "Chirp Pulse Sine Step WAVEFORMS",
    "equations.derivation": "DerivedChain derive_chain wall_spring_weight",
    "equations.equilibria": "Equilibrium EquilibriumNotFound find_equilibrium",
    "equations.equilibria_in_space": (
        "NoEquilibriumInSpace SpatialEquilibrium critical_factor spatial_equilibrium"
    ),
    "equations.joint_laws": "JOINT_LAWS JointLaw",
    "equations.mechanics": "Energies",
    "equations.numeric": "compile_equations CompiledEquations",
    "equations.symbolic": "equations_of_motion EquationsOfMotion symbolic_energies",
    "exact.axial_beam": "AxialModes",
    "exact.axial_statics": "axial_displacement",
    "exact.axial_theory": "axial_modes",
    "exact.beam_theory": "euler_bernoulli",
    "exact.exact_beam": "BeamModes wavenumber",
    "exact.exact_rod": "RodModes rod_modes",
    "exact.spectral_beam": "SpectralBeamModes",
    "exact.structure_judge": "StructureModes structure_modes",
    "exact.supported_beam": "SupportedBeamModes",
    "exact.timoshenko_beam": "TimoshenkoModes timoshenko",
    "exporters.chain_csv": "read_chain_csv",
    "exporters.export": "export_chain",
    "numerics.distributions": "Normal Uniform",
    "problem.applied_loads": "LineLoad PointLoad",
    "problem.axial_ends": "AxialBoundary AxialEnd",
    "problem.beam": "Beam",
    "problem.end_columns": "Ends",
    "problem.ends": "BOUNDARIES Boundary End ENDS NotPlain",
    "problem.load_in_space": "SpatialLoad",
    "problem.loading": "Load",
    "problem.materials": "MODULI elastic_modulus",
    "problem.profiles": "Table",
    "problem.rod": "Rod",
    "problem.rod_ends": "RodEnd RodEnds",
    "problem.sections": "Box Channel Circle GivenSection ISection Rectangle Tube from_sectionproperties",
    "problem.structure": "Joint Member Station Structure",
    "springs.axial_matching": "AxialMatched AxialMatchedSprings NoPositiveAxialSprings",
    "springs.axial_tuning": "AxialTuned",
    "springs.matched_springs": "match_springs Matched matched MatchedSprings NoPositiveSprings",
    "springs.tuning": "mode_tuned ModeTuned",
    "version": "__version__",
    "vibration.axial_spectrum": "AxialChainModes",
    "vibration.damping": "Damping DampingFitWarning damped_modes joint_dampers",
    "vibration.follower": "FlutterLoad flutter_load follower_modes",
    "vibration.integrators": "INTEGRATORS Integrator",
    "vibration.linear": "BentModel LinearModel linearize",
    "vibration.measured_damping": "DecayRatio ratio_from_decay rayleigh_damping",
    "vibration.modes": "Modes solve_modes",
    "vibration.modes_in_space": "SpatialModes spatial_modes",
    "vibration.spectrum": "Buckled",
    "vibration.stability": "published_time_step stable_time_step",
    "vibration.structure_vibration": "StructureChainModes structure_chain_modes",
    "views.animation": "animate",
    "views.diagrams": "draw_statics",
    "views.response_plot": "plot_response",
    "views.schematic": "draw_chain",
}
_HOME = {name: home for home, names in _NAMES.items() for name in names.split()}

__all__ = sorted(_HOME)

if TYPE_CHECKING:
    from beammodes.accuracy.advice import Recommendation as Recommendation
    from beammodes.accuracy.advice import Recommendations as Recommendations
    from beammodes.accuracy.advice import recommend as recommend
    from beammodes.accuracy.buckling import buckling_dataset as buckling_dataset
    from beammodes.accuracy.buckling import buckling_load as buckling_load
    from beammodes.accuracy.chain_against_beam import SlendernessWarning as SlendernessWarning
    from beammodes.accuracy.chain_against_beam import chain_errors as chain_errors
    from beammodes.accuracy.chain_against_beam import theory_errors as theory_errors
    from beammodes.accuracy.chain_against_rod import rod_error_dataset as rod_error_dataset
    from beammodes.accuracy.chain_against_rod import rod_errors as rod_errors
    from beammodes.accuracy.error_table import derived_error_dataset as derived_error_dataset
    from beammodes.accuracy.error_table import error_dataset as error_dataset
    from beammodes.accuracy.errors import frequency_error as frequency_error
    from beammodes.accuracy.identification import stiffness_from_deflection as stiffness_from_deflection
    from beammodes.accuracy.identification import stiffness_from_frequency as stiffness_from_frequency
    from beammodes.accuracy.law import ErrorLaw as ErrorLaw
    from beammodes.accuracy.law import error_law as error_law
    from beammodes.accuracy.law import law_holds_from as law_holds_from
    from beammodes.accuracy.loaded_structures import StructureStatics as StructureStatics
    from beammodes.accuracy.loaded_structures import structure_chain_statics as structure_chain_statics
    from beammodes.accuracy.loaded_structures import structure_statics as structure_statics
    from beammodes.accuracy.random_motion import random_response as random_response
    from beammodes.accuracy.remarks import error_remarks as error_remarks
    from beammodes.accuracy.response_law import response_error as response_error
    from beammodes.accuracy.responses import frequency_response as frequency_response
    from beammodes.accuracy.segments import ToleranceOutOfReach as ToleranceOutOfReach
    from beammodes.accuracy.segments import segments_needed as segments_needed
    from beammodes.accuracy.shapes import modal_assurance as modal_assurance
    from beammodes.accuracy.shapes import shape_dataset as shape_dataset
    from beammodes.accuracy.statics import Statics as Statics
    from beammodes.accuracy.statics import beam_statics as beam_statics
    from beammodes.accuracy.statics import chain_statics as chain_statics
    from beammodes.accuracy.statics import static_dataset as static_dataset
    from beammodes.accuracy.stressed_structures import structure_modes_under as structure_modes_under
    from beammodes.accuracy.uncertainty import EnoughSegments as EnoughSegments
    from beammodes.accuracy.uncertainty import Tolerance as Tolerance
    from beammodes.accuracy.uncertainty import frequency_spread as frequency_spread
    from beammodes.accuracy.uncertainty import segments_within_spread as segments_within_spread
    from beammodes.auditing.audit import Audit as Audit
    from beammodes.auditing.audit import StepVerdict as StepVerdict
    from beammodes.auditing.audit import Suggestion as Suggestion
    from beammodes.auditing.audit import audit_chain as audit_chain
    from beammodes.auditing.audit_model import audit_file as audit_file
    from beammodes.auditing.axial_audit import AxialAudit as AxialAudit
    from beammodes.auditing.bounded_xml import BadModel as BadModel
    from beammodes.auditing.mended_files import MendedFile as MendedFile
    from beammodes.auditing.mended_files import mend_file as mend_file
    from beammodes.auditing.space_audit import SpatialAudit as SpatialAudit
    from beammodes.batch.cases import Case as Case
    from beammodes.batch.study import Study as Study
    from beammodes.batch.study import open_study as open_study
    from beammodes.chains.axial_chain import AxialChain as AxialChain
    from beammodes.chains.chain import Chain as Chain
    from beammodes.chains.rods import MissedFeatureWarning as MissedFeatureWarning
    from beammodes.chains.rules import RULES as RULES
    from beammodes.chains.rules import AxiallyCorrected as AxiallyCorrected
    from beammodes.chains.rules import Layout as Layout
    from beammodes.chains.rules import NotClosed as NotClosed
    from beammodes.chains.rules import Rule as Rule
    from beammodes.chains.rules import Weight as Weight
    from beammodes.chains.rules import axially_corrected as axially_corrected
    from beammodes.chains.spatial_chain import SpatialChain as SpatialChain
    from beammodes.chains.structure_chain import StructureChain as StructureChain
    from beammodes.closed_form.chain_frequencies import chain_frequency as chain_frequency
    from beammodes.dynamics.base_motion import BaseMotion as BaseMotion
    from beammodes.dynamics.base_motion import bang_bang as bang_bang
    from beammodes.dynamics.base_motion import harmonic as harmonic
    from beammodes.dynamics.base_motion import point_to_point as point_to_point
    from beammodes.dynamics.base_motion import spin_up as spin_up
    from beammodes.dynamics.simulation import DivergedWarning as DivergedWarning
    from beammodes.dynamics.simulation import NothingMovesWarning as NothingMovesWarning
    from beammodes.dynamics.simulation import UnsavedMotion as UnsavedMotion
    from beammodes.dynamics.simulation import UnstableStepWarning as UnstableStepWarning
    from beammodes.dynamics.simulation import mode_start as mode_start
    from beammodes.dynamics.simulation import simulate as simulate
    from beammodes.dynamics.superposition import modal_response as modal_response
    from beammodes.dynamics.timed_loads import TimedLoad as TimedLoad
    from beammodes.dynamics.waveforms import WAVEFORMS as WAVEFORMS
    from beammodes.dynamics.waveforms import Chirp as Chirp
    from beammodes.dynamics.waveforms import Pulse as Pulse
    from beammodes.dynamics.waveforms import Sine as Sine
    from beammodes.dynamics.waveforms import Step as Step
    from beammodes.equations.derivation import DerivedChain as DerivedChain
    from beammodes.equations.derivation import derive_chain as derive_chain
    from beammodes.equations.derivation import wall_spring_weight as wall_spring_weight
    from beammodes.equations.equilibria import Equilibrium as Equilibrium
    from beammodes.equations.equilibria import EquilibriumNotFound as EquilibriumNotFound
    from beammodes.equations.equilibria import find_equilibrium as find_equilibrium
    from beammodes.equations.equilibria_in_space import NoEquilibriumInSpace as NoEquilibriumInSpace
    from beammodes.equations.equilibria_in_space import SpatialEquilibrium as SpatialEquilibrium
    from beammodes.equations.equilibria_in_space import critical_factor as critical_factor
    from beammodes.equations.equilibria_in_space import spatial_equilibrium as spatial_equilibrium
    from beammodes.equations.joint_laws import JOINT_LAWS as JOINT_LAWS
    from beammodes.equations.joint_laws import JointLaw as JointLaw
    from beammodes.equations.mechanics import Energies as Energies
    from beammodes.equations.numeric import CompiledEquations as CompiledEquations
    from beammodes.equations.numeric import compile_equations as compile_equations
    from beammodes.equations.symbolic import EquationsOfMotion as EquationsOfMotion
    from beammodes.equations.symbolic import equations_of_motion as equations_of_motion
    from beammodes.equations.symbolic import symbolic_energies as symbolic_energies
    from beammodes.exact.axial_beam import AxialModes as AxialModes
    from beammodes.exact.axial_statics import axial_displacement as axial_displacement
    from beammodes.exact.axial_theory import axial_modes as axial_modes
    from beammodes.exact.beam_theory import euler_bernoulli as euler_bernoulli
    from beammodes.exact.exact_beam import BeamModes as BeamModes
    from beammodes.exact.exact_beam import wavenumber as wavenumber
    from beammodes.exact.exact_rod import RodModes as RodModes
    from beammodes.exact.exact_rod import rod_modes as rod_modes
    from beammodes.exact.spectral_beam import SpectralBeamModes as SpectralBeamModes
    from beammodes.exact.structure_judge import StructureModes as StructureModes
    from beammodes.exact.structure_judge import structure_modes as structure_modes
    from beammodes.exact.supported_beam import SupportedBeamModes as SupportedBeamModes
    from beammodes.exact.timoshenko_beam import TimoshenkoModes as TimoshenkoModes
    from beammodes.exact.timoshenko_beam import timoshenko as timoshenko
    from beammodes.exporters.chain_csv import read_chain_csv as read_chain_csv
    from beammodes.exporters.export import export_chain as export_chain
    from beammodes.numerics.distributions import Normal as Normal
    from beammodes.numerics.distributions import Uniform as Uniform
    from beammodes.problem.applied_loads import LineLoad as LineLoad
    from beammodes.problem.applied_loads import PointLoad as PointLoad
    from beammodes.problem.axial_ends import AxialBoundary as AxialBoundary
    from beammodes.problem.axial_ends import AxialEnd as AxialEnd
    from beammodes.problem.beam import Beam as Beam
    from beammodes.problem.end_columns import Ends as Ends
    from beammodes.problem.ends import BOUNDARIES as BOUNDARIES
    from beammodes.problem.ends import ENDS as ENDS
    from beammodes.problem.ends import Boundary as Boundary
    from beammodes.problem.ends import End as End
    from beammodes.problem.ends import NotPlain as NotPlain
    from beammodes.problem.load_in_space import SpatialLoad as SpatialLoad
    from beammodes.problem.loading import Load as Load
    from beammodes.problem.materials import MODULI as MODULI
    from beammodes.problem.materials import elastic_modulus as elastic_modulus
    from beammodes.problem.profiles import Table as Table
    from beammodes.problem.rod import Rod as Rod
    from beammodes.problem.rod_ends import RodEnd as RodEnd
    from beammodes.problem.rod_ends import RodEnds as RodEnds
    from beammodes.problem.sections import Box as Box
    from beammodes.problem.sections import Channel as Channel
    from beammodes.problem.sections import Circle as Circle
    from beammodes.problem.sections import GivenSection as GivenSection
    from beammodes.problem.sections import ISection as ISection
    from beammodes.problem.sections import Rectangle as Rectangle
    from beammodes.problem.sections import Tube as Tube
    from beammodes.problem.sections import from_sectionproperties as from_sectionproperties
    from beammodes.problem.structure import Joint as Joint
    from beammodes.problem.structure import Member as Member
    from beammodes.problem.structure import Station as Station
    from beammodes.problem.structure import Structure as Structure
    from beammodes.springs.axial_matching import AxialMatched as AxialMatched
    from beammodes.springs.axial_matching import AxialMatchedSprings as AxialMatchedSprings
    from beammodes.springs.axial_matching import NoPositiveAxialSprings as NoPositiveAxialSprings
    from beammodes.springs.axial_tuning import AxialTuned as AxialTuned
    from beammodes.springs.matched_springs import Matched as Matched
    from beammodes.springs.matched_springs import MatchedSprings as MatchedSprings
    from beammodes.springs.matched_springs import NoPositiveSprings as NoPositiveSprings
    from beammodes.springs.matched_springs import match_springs as match_springs
    from beammodes.springs.matched_springs import matched as matched
    from beammodes.springs.tuning import ModeTuned as ModeTuned
    from beammodes.springs.tuning import mode_tuned as mode_tuned
    from beammodes.version import __version__ as __version__
    from beammodes.vibration.axial_spectrum import AxialChainModes as AxialChainModes
    from beammodes.vibration.damping import Damping as Damping
    from beammodes.vibration.damping import DampingFitWarning as DampingFitWarning
    from beammodes.vibration.damping import damped_modes as damped_modes
    from beammodes.vibration.damping import joint_dampers as joint_dampers
    from beammodes.vibration.follower import FlutterLoad as FlutterLoad
    from beammodes.vibration.follower import flutter_load as flutter_load
    from beammodes.vibration.follower import follower_modes as follower_modes
    from beammodes.vibration.integrators import INTEGRATORS as INTEGRATORS
    from beammodes.vibration.integrators import Integrator as Integrator
    from beammodes.vibration.linear import BentModel as BentModel
    from beammodes.vibration.linear import LinearModel as LinearModel
    from beammodes.vibration.linear import linearize as linearize
    from beammodes.vibration.measured_damping import DecayRatio as DecayRatio
    from beammodes.vibration.measured_damping import ratio_from_decay as ratio_from_decay
    from beammodes.vibration.measured_damping import rayleigh_damping as rayleigh_damping
    from beammodes.vibration.modes import Modes as Modes
    from beammodes.vibration.modes import solve_modes as solve_modes
    from beammodes.vibration.modes_in_space import SpatialModes as SpatialModes
    from beammodes.vibration.modes_in_space import spatial_modes as spatial_modes
    from beammodes.vibration.spectrum import Buckled as Buckled
    from beammodes.vibration.stability import published_time_step as published_time_step
    from beammodes.vibration.stability import stable_time_step as stable_time_step
    from beammodes.vibration.structure_vibration import StructureChainModes as StructureChainModes
    from beammodes.vibration.structure_vibration import structure_chain_modes as structure_chain_modes
    from beammodes.views.animation import animate as animate
    from beammodes.views.diagrams import draw_statics as draw_statics
    from beammodes.views.response_plot import plot_response as plot_response
    from beammodes.views.schematic import draw_chain as draw_chain


def __getattr__(name: str) -> Any:
    if name not in _HOME:
        raise AttributeError(f"module 'beammodes' has no attribute {name!r}")
    value = getattr(import_module(f"beammodes.{_HOME[name]}"), name)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return __all__
