"""Adding up rigid bodies, against the pseudo-inertia, which simply adds up."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from groundwalk.errors import BadValueError
from robots.rigid_body import Inertial, combined, inertia_matrix


def pseudo_inertia(body):
    """(4, 4) integral of (x, 1)(x, 1)^T dm: its blocks are second moment, m c and m."""
    tensor = body.inertia_kg_m2
    second = np.trace(tensor) / 2 * np.eye(3) - tensor
    first = body.mass_kg * body.com_m
    matrix = np.zeros((4, 4))
    matrix[:3, :3] = second + np.outer(first, body.com_m)
    matrix[:3, 3] = matrix[3, :3] = first
    matrix[3, 3] = body.mass_kg
    return matrix


def random_body(generator):
    """A box with uniform mass, turned and moved at random."""
    a, b, c = generator.uniform(0.01, 0.3, 3)
    mass = generator.uniform(0.01, 2.0)
    box = mass / 12 * np.diag([b * b + c * c, a * a + c * c, a * a + b * b])
    turn = Rotation.random(rng=generator).as_matrix()
    return Inertial(mass, generator.uniform(-0.2, 0.2, 3), turn @ box @ turn.T)


@pytest.mark.parametrize("count", [1, 2, 5])
def test_pseudo_inertias_add_up(count):
    generator = np.random.default_rng(count)
    bodies = [random_body(generator) for _ in range(count)]
    expected = sum(pseudo_inertia(body) for body in bodies)
    np.testing.assert_allclose(
        pseudo_inertia(combined(bodies)), expected, rtol=0, atol=1e-15
    )


def test_two_balls_on_a_rod():
    """Two points of mass m, 2 d apart: 2 m d^2 across the rod, nothing along it."""
    point = np.zeros((3, 3))
    body = combined([Inertial(0.5, np.array([1, d, 0.0]), point) for d in (-0.2, 0.2)])
    assert body.mass_kg == 1.0
    np.testing.assert_allclose(body.com_m, [1, 0, 0], atol=1e-15)
    np.testing.assert_allclose(body.inertia_kg_m2, np.diag([0.04, 0, 0.04]), atol=1e-15)


def test_moving_keeps_the_inertia_about_the_centre():
    body = random_body(np.random.default_rng(7))
    offset = np.array([1.0, 2.0, 3.0])
    moved = body.moved(offset)
    np.testing.assert_array_equal(moved.com_m, body.com_m + offset)
    np.testing.assert_array_equal(moved.inertia_kg_m2, body.inertia_kg_m2)


def test_rotor_is_a_thin_disc():
    axis = np.array([1.0, 2.0, -2.0]) / 3
    body = Inertial(1.0, np.zeros(3), np.eye(3))
    added = body.with_rotor(axis, 0.06).inertia_kg_m2 - np.eye(3)
    moments, directions = np.linalg.eigh(added)
    np.testing.assert_allclose(moments, [0.03, 0.03, 0.06], atol=1e-15)
    assert abs(directions[:, 2] @ axis) == pytest.approx(1.0)


def test_matrix_of_six_numbers():
    np.testing.assert_array_equal(
        inertia_matrix([1, 2, 3, 4, 5, 6]), [[1, 4, 5], [4, 2, 6], [5, 6, 3]]
    )


@pytest.mark.parametrize(
    ("mass_kg", "com_m", "moments", "message"),
    [
        (0.0, [0, 0, 0], [1, 1, 1], "mass"),
        (-1.0, [0, 0, 0], [1, 1, 1], "mass"),
        (float("nan"), [0, 0, 0], [1, 1, 1], "mass"),
        (1.0, [0, float("inf"), 0], [1, 1, 1], "mass"),
        (1.0, [0, 0, 0], [-1e-3, 1, 1], "two must add up"),
        (1.0, [0, 0, 0], [1, 1, 2.01], "two must add up"),
    ],
)
def test_bodies_that_cannot_be(mass_kg, com_m, moments, message):
    with pytest.raises(BadValueError, match=message):
        Inertial(mass_kg, np.array(com_m, float), np.diag(np.array(moments, float)))


def test_a_flat_plate_can_be():
    Inertial(1.0, np.zeros(3), np.diag([1.0, 1.0, 2.0]))
