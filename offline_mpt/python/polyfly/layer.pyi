from collections.abc import Callable
from typing import Any

from numpy.typing import ArrayLike

from ._polyfly import Array, Map


class Layer:
    map: Map
    def __init__(self, law: Map) -> None: ...
    def vjp(self, thetas: ArrayLike) -> tuple[Array, Callable[[ArrayLike], Array]]: ...
    def __call__(self, thetas: Any) -> Any: ...
