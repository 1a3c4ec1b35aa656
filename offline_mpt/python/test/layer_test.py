#!/usr/bin/env python3
"""pf.Layer: inputs of a map and their derivatives, in batches and under PyTorch."""
import importlib.util
import unittest

import numpy as np
import polyfly as pf

A = np.array([[0.0, 1.0], [0.0, -0.2]])
B = np.array([[0.0], [1.5]])


class Layer(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        mpc = pf.MPC(A, B, Ts=0.1, horizon=8, C=np.array([[1.0, 0.0]])).cost([4, 1], [0.5]).bounds(u=(-1, 1))
        cls.map = mpc.explicit(parameters={"e_x0": (-3, 3), "e_x1": (-3, 3)})
        cls.layer = pf.Layer(cls.map)
        cls.thetas = np.random.default_rng(1).uniform(-3, 3, (5, 40, 2))

    def test_inputs_are_those_of_the_map(self):
        u = self.layer(self.thetas)
        self.assertEqual((5, 40, 1), u.shape)
        for place in np.ndindex(5, 40):
            np.testing.assert_array_equal(u[place], self.map(self.thetas[place]))

    def test_slopes_are_those_of_differences(self):
        weights = np.random.default_rng(2).normal(size=(5, 40, 1))
        u, pullback = self.layer.vjp(self.thetas)
        slopes = pullback(weights)
        step = 1e-6
        regions = self.map.locate(self.thetas.reshape(-1, 2)).reshape(5, 40)
        checked = 0
        for k in range(2):
            moved = self.thetas.copy()
            moved[..., k] += step
            same = self.map.locate(moved.reshape(-1, 2)).reshape(5, 40) == regions
            expected = ((self.layer(moved) - u) / step * weights)[..., 0]
            np.testing.assert_allclose(slopes[..., k][same], expected[same], atol=1e-6)
            checked += np.count_nonzero(same)
        self.assertGreater(checked, 300)

    def test_outside_there_is_no_slope(self):
        u, pullback = self.layer.vjp([[0.1, 0.2], [9.0, 0.0]])
        slopes = pullback(np.ones_like(u))
        self.assertTrue(np.all(np.isfinite(slopes[0])))
        self.assertTrue(np.all(np.isnan(slopes[1])) and np.all(np.isnan(u[1])))

    @unittest.skipIf(importlib.util.find_spec("torch") is None, "PyTorch is not installed")
    def test_torch_differentiates_through_a_closed_loop(self):
        import torch
        discrete = torch.tensor([[1.0, 0.1], [0.0, 0.98]], dtype=torch.float64)
        effect = torch.tensor([0.0075, 0.15], dtype=torch.float64)

        def cost(start):
            state = start
            total = torch.zeros((), dtype=torch.float64)
            for _ in range(10):
                u = self.layer(state)
                state = discrete @ state + effect * u
                total = total + (state ** 2).sum() + (u ** 2).sum()
            return total

        start = torch.tensor([0.7, -0.4], dtype=torch.float64, requires_grad=True)
        cost(start).backward()
        for k in range(2):
            step = torch.zeros(2, dtype=torch.float64)
            step[k] = 1e-6
            slope = (cost(start.detach() + step) - cost(start.detach() - step)) / 2e-6
            self.assertAlmostEqual(float(slope), float(start.grad[k]), delta=1e-5)


if __name__ == "__main__":
    unittest.main(verbosity=2)
