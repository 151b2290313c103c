"""A direction is sampled from the BSDF or from the tree. Its weight divides by the density of the mixture of both."""

import math

from draw import Drawing

FLOOR = 130
BSDF_X, TREE_X, MIXTURE_X = 104, 318, 536
TOWARDS_LIGHT = 0.75


def bsdf(angle):
    return max(0.0, math.cos(angle))


def tree(angle):
    return 0.2 + 1.4 * math.exp(-(((angle - TOWARDS_LIGHT) / 0.22) ** 2))


def mixture(angle):
    return 0.5 * bsdf(angle) + 0.5 * tree(angle)


def plot(d, x, density, role):
    """`density` by the angle from the normal, as distance from the point."""
    angles = [(i / 240 - 0.5) * 2 * math.pi for i in range(241)]
    points = [at(x, density, angle) for angle in angles]
    d.line((x - 80, FLOOR), (x + 80, FLOOR), width=2)
    d.polygon(*points, role=role, fill=(role, 0.16), width=2)
    d.dot(x, FLOOR)


def at(x, density, angle, scale=74):
    r = scale * density(angle)
    return x + r * math.sin(angle), FLOOR - r * math.cos(angle)


def draw():
    d = Drawing(640, 220, "Direction sampling: one direction from the BSDF or the tree, divided by the density of the mixture of both")
    plot(d, BSDF_X, bsdf, "blue")
    plot(d, TREE_X, tree, "orange")
    plot(d, MIXTURE_X, mixture, "green")
    d.arrow((MIXTURE_X, FLOOR), at(MIXTURE_X, lambda a: 1.35, TOWARDS_LIGHT), width=2)
    d.text(MIXTURE_X + 76, 56, "ω")
    d.text(208, FLOOR - 20, "+", anchor="middle", style="bold")
    d.text(428, FLOOR - 20, "=", anchor="middle", style="bold")
    d.text(BSDF_X, 180, "α · p_bsdf", role="blue", anchor="middle")
    d.text(BSDF_X, 202, "the material", role="blue", anchor="middle")
    d.text(TREE_X, 180, "(1 − α) · p_tree", role="orange", anchor="middle")
    d.text(TREE_X, 202, "light of earlier frames", role="orange", anchor="middle")
    d.text(MIXTURE_X, 180, "p", role="green", anchor="middle")
    d.text(MIXTURE_X, 202, "weight f cos θ / p", role="green", anchor="middle")
    return d
