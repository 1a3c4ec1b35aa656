"""Explicit and online MPC: solve a problem for all parameters, look up, prove, reduce and draw the map.

    import polyfly as pf
    mpc = pf.MPC(A, B, Ts=0.1, horizon=20, C=C).cost(Q, R).bounds(u=(-0.4, 0.4))
    law = mpc.explicit(parameters={"e_p": (-3, 3), "e_v": (-3, 3)})
    u = law([0.5, -0.2])

Names, units and files are those of the tools. A rule that input breaks raises Error with file, field and rule.
"""
from ._polyfly import (__version__, CertifyReport, Defect, DiffReport, DiscreteModel, Error, LawDifference, Map,
                       MapCover, OnlineProgram, OnlineRobust, OutsideError, Parameter, Picture, Problem,
                       Program, Region, RobustProblem, RobustProof, RobustSampling, Signal, SteadyState, VerifyReport,
                       diff, load_problem, load_program, load_robust_problem, is_robust_file, open, parse_problem,
                       parse_program, parse_robust_problem)
from .disturbance import DisturbanceRange, disturbance_ranges
from .law import Law, RobustLaw
from .layer import Layer
from .mat import load_mat
from .mpc import MPC
from .program import MPLP, MPQP
from .robust import RobustMPC

__all__ = ["CertifyReport", "Defect", "DiffReport", "DiscreteModel", "DisturbanceRange", "Error", "Law",
           "LawDifference", "Layer", "MPC", "MPLP", "MPQP", "Map", "MapCover", "OnlineProgram", "OnlineRobust", "OutsideError", "Parameter", "Picture",
           "Problem", "Program", "Region", "RobustLaw", "RobustMPC", "RobustProblem", "RobustProof", "RobustSampling",
           "Signal", "SteadyState", "VerifyReport", "diff", "disturbance_ranges", "is_robust_file", "load", "load_mat",
           "load_problem", "load_program", "load_robust_problem", "open", "parse_problem", "parse_program", "parse_robust_problem"]


def load(path):
    """The problem of a file: Problem or RobustProblem of a .yaml or .yml file, Program of a .json file."""
    if str(path).endswith(".json"):
        return load_program(path)
    return load_robust_problem(path) if is_robust_file(path) else load_problem(path)
