#!/usr/bin/env python3
# SPDX-FileCopyrightText: The calibrd authors
# SPDX-License-Identifier: Apache-2.0
"""Checks the yardstick of the end-to-end tests."""

import math
import unittest

from poses import IDENTITY, Surface, apply, axis_turn, difference, distance_to_triangle, inverse, multiply, shift


class Poses(unittest.TestCase):
    T = multiply(shift((1, 2, 3)), axis_turn((1, 1, 0), 0.7))

    def test_the_inverse_undoes_a_pose(self):
        for row, wanted in zip(multiply(self.T, inverse(self.T)), IDENTITY):
            for value, one in zip(row, wanted):
                self.assertAlmostEqual(value, one, places=12)

    def test_a_quarter_turn_about_z_takes_x_to_y(self):
        for value, wanted in zip(apply(axis_turn((0, 0, 2), math.pi / 2), (1, 0, 0)), (0, 1, 0)):
            self.assertAlmostEqual(value, wanted)

    def test_difference_is_in_mm_and_mrad(self):
        other = multiply(multiply(shift((0, 0.003, 0)), self.T), axis_turn((0, 1, 0), 1e-4))
        mm, mrad = difference(self.T, other)
        self.assertAlmostEqual(mm, 3)
        self.assertAlmostEqual(mrad, 0.1)
        self.assertAlmostEqual(difference(IDENTITY, axis_turn((1, 0, 0), 3.0))[1], 3000)

    def test_distance_to_a_triangle_is_to_its_face_edge_or_corner(self):
        triangle = ((0, 0, 0), (1, 0, 0), (0, 1, 0))
        for point, wanted in (((0.2, 0.2, 0.5), 0.5), ((0.5, -2, 0), 2), ((2, 0, 0), 1), ((1, 1, 0), math.sqrt(0.5))):
            self.assertAlmostEqual(distance_to_triangle(point, triangle), wanted)

    def test_a_surface_finds_its_nearest_triangle(self):
        surface = Surface([((0, 0, 0), (0.1, 0, 0), (0, 0.1, 0)), ((0, 0, 1), (0.1, 0, 1), (0, 0.1, 1))])
        self.assertAlmostEqual(surface.distance((0.03, 0.03, 0.004)), 0.004)
        self.assertAlmostEqual(surface.distance((0.03, 0.03, 0.999)), 0.001)


if __name__ == "__main__":
    unittest.main()
