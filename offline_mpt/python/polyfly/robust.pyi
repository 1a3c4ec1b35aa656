from collections.abc import Mapping
from fractions import Fraction

from numpy.typing import ArrayLike

from ._polyfly import RobustProblem
from .mpc import Names, Range
from .statement import Statement

Exact = float | str | Fraction


class RobustMPC(Statement):
    def __init__(self, A: ArrayLike, B: ArrayLike, G: ArrayLike, Ts: Exact, horizon: int, C: ArrayLike, *,
                 time: str = "continuous", bits: int | None = None, stack: str | None = None,
                 invariance: str | None = None, floor: Exact | None = None, peak_in_map: bool | None = None,
                 states: Names = None, inputs: Names = None, disturbances: Names = None, name: str = "robust_mpc",
                 description: str = "") -> None: ...
    def tie_break(self, Q: ArrayLike | None = None, R: ArrayLike | None = None,
                  gain: ArrayLike | None = None) -> RobustMPC: ...
    def feedback(self, predictions: str, Q: ArrayLike | None = None, R: ArrayLike | None = None,
                 gain: ArrayLike | None = None) -> RobustMPC: ...
    def bounds(self, u: Range, w: Range, x: Range | None = None) -> RobustMPC: ...
    def reference(self, name: str, state: ArrayLike, input: ArrayLike, unit: str = "1") -> RobustMPC: ...
    def parameters(self, ranges_by_name: Mapping[str, tuple[Exact, Exact]]) -> RobustMPC: ...
    def text(self) -> str: ...
    def problem(self) -> RobustProblem: ...
