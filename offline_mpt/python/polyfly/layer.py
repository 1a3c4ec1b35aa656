"""A map as a layer that can be differentiated, for gradients through a control law."""
from __future__ import annotations

import functools
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import ArrayLike

    from ._polyfly import Map


class Layer:
    """The inputs of a map at many parameters, with their exact derivatives.

        layer = pf.Layer(map)
        u, pullback = layer.vjp(thetas)      # thetas (..., p), u (..., q)
        slope = pullback(weights)            # weights (..., q): their sum times du/dtheta, (..., p)

    Where the map has no answer, u and slope are NaN. On a face between regions the slope is that of the region that the
    look-up finds. `layer(thetas)` gives u alone; of a PyTorch tensor it is a tensor that autograd differentiates.
    """

    def __init__(self, law: Map) -> None:
        self.map = law
        self._gains = np.stack([region.K for region in law.regions])

    def vjp(self, thetas: ArrayLike) -> tuple[np.ndarray, Callable[[ArrayLike], np.ndarray]]:
        """u, and the function that takes weights of u back to weights of theta."""
        thetas = np.asarray(thetas, dtype=float)
        rows = np.ascontiguousarray(thetas.reshape(-1, thetas.shape[-1]))
        u = np.asarray(self.map.evaluate(rows))
        found = self.map.locate(rows)

        def pullback(weights):
            weights = np.asarray(weights, dtype=float).reshape(u.shape)
            slopes = np.einsum("iq,iqp->ip", weights, self._gains[found])
            slopes[found < 0] = np.nan
            return slopes.reshape(thetas.shape)

        return u.reshape(thetas.shape[:-1] + u.shape[1:]), pullback

    def __call__(self, thetas: Any) -> Any:
        if type(thetas).__module__.partition(".")[0] == "torch":
            return _torch_function().apply(thetas, self)
        return self.vjp(thetas)[0]


@functools.lru_cache(maxsize=None)
def _torch_function():
    import torch  # only where a tensor was given

    class MapFunction(torch.autograd.Function):
        @staticmethod
        def forward(ctx, thetas, layer):
            u, ctx.pullback = layer.vjp(thetas.detach().cpu().numpy())
            return torch.as_tensor(u, dtype=thetas.dtype, device=thetas.device)

        @staticmethod
        def backward(ctx, weights):
            slopes = ctx.pullback(weights.detach().cpu().numpy())
            return torch.as_tensor(slopes, dtype=weights.dtype, device=weights.device), None

    return MapFunction
