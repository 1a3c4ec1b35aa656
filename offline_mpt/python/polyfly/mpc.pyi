from collections.abc import Mapping, Sequence

from numpy.typing import ArrayLike

from ._polyfly import Problem
from .statement import Statement

Names = Sequence[str | tuple[str, str]] | None
Range = tuple[ArrayLike, ArrayLike]
Softness = float | Mapping[str, float | str] | None


class MPC(Statement):
    def __init__(self, A: ArrayLike, B: ArrayLike, Ts: float, horizon: int, C: ArrayLike, *,
                 Bd: ArrayLike | None = None, time: str = "continuous", states: Names = None, inputs: Names = None,
                 disturbances: Names = None, name: str = "mpc", description: str = "") -> None: ...
    def cost(self, Q: ArrayLike, R: ArrayLike, R_delta: ArrayLike | None = None,
             terminal: str | ArrayLike = "riccati") -> MPC: ...
    def bounds(self, x: Range | None = None, u: Range | None = None, e: Range | None = None,
               soft: Softness = None) -> MPC: ...
    def constraint(self, of: str | Mapping[str, float], lower: float = ..., upper: float = ..., *,
                   name: str | None = None, unit: str | None = None, soft: Softness = None,
                   measured_from: str = "zero") -> MPC: ...
    def parameters(self, ranges_by_name: Mapping[str, tuple[float, float] | float]) -> MPC: ...
    def text(self) -> str: ...
    def problem(self) -> Problem: ...
