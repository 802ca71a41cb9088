# SPDX-FileCopyrightText: The calibrd authors
# SPDX-License-Identifier: Apache-2.0
"""Poses as lists of rows (4x4, m), forward kinematics of a URDF and distances to its meshes, in plain Python:
nothing of it is shared with what it is to judge."""

import math
import struct
import xml.etree.ElementTree as ElementTree
from pathlib import Path

Pose = list[list[float]]
Point = tuple[float, float, float]

IDENTITY: Pose = [[float(i == j) for j in range(4)] for i in range(4)]


def multiply(a: Pose, b: Pose) -> Pose:
    return [[sum(a[i][k] * b[k][j] for k in range(4)) for j in range(4)] for i in range(4)]


def inverse(T: Pose) -> Pose:
    R = [[T[j][i] for j in range(3)] for i in range(3)]
    t = [-sum(R[i][k] * T[k][3] for k in range(3)) for i in range(3)]
    return [[*R[i], t[i]] for i in range(3)] + [[0.0, 0.0, 0.0, 1.0]]


def apply(T: Pose, p: Point) -> Point:
    return tuple(T[i][0] * p[0] + T[i][1] * p[1] + T[i][2] * p[2] + T[i][3] for i in range(3))


def axis_turn(axis: Point, angle_rad: float) -> Pose:
    n = math.sqrt(sum(a * a for a in axis))
    x, y, z = (a / n for a in axis)
    c, s, d = math.cos(angle_rad), math.sin(angle_rad), 1 - math.cos(angle_rad)
    return [[x * x * d + c, x * y * d - z * s, x * z * d + y * s, 0.0],
            [y * x * d + z * s, y * y * d + c, y * z * d - x * s, 0.0],
            [z * x * d - y * s, z * y * d + x * s, z * z * d + c, 0.0],
            [0.0, 0.0, 0.0, 1.0]]


def shift(v: Point) -> Pose:
    return [[float(i == j) for j in range(3)] + [v[i]] for i in range(3)] + [[0.0, 0.0, 0.0, 1.0]]


def difference(a: Pose, b: Pose) -> tuple[float, float]:
    """How far apart two poses are: of their origins (mm), of their rotations (mrad)."""
    apart = math.dist([a[i][3] for i in range(3)], [b[i][3] for i in range(3)])
    D = multiply(inverse(a), b)
    skew = math.hypot(D[2][1] - D[1][2], D[0][2] - D[2][0], D[1][0] - D[0][1]) / 2
    trace = D[0][0] + D[1][1] + D[2][2]
    return apart * 1e3, math.atan2(skew, (trace - 1) / 2) * 1e3


def numbers(text: str) -> list[float]:
    return [float(word) for word in text.split()]


class Robot:
    """Revolute and fixed joints of a URDF, and the STL meshes of its links (unscaled, origin at the link)."""

    def __init__(self, urdf: Path):
        root = ElementTree.parse(urdf).getroot()
        self.joints = root.findall("joint")
        self.meshes = {link.get("name"): urdf.parents[1] / "meshes" / Path(mesh.get("filename")).name
                       for link in root.findall("link") if (mesh := link.find("visual/geometry/mesh")) is not None}
        children = {joint.find("child").get("link") for joint in self.joints}
        self.base = next(link.get("name") for link in root.findall("link") if link.get("name") not in children)

    def link_poses(self, positions_rad: dict[str, float]) -> dict[str, Pose]:
        """T_base_link of every link."""
        poses, waiting = {self.base: IDENTITY}, list(self.joints)
        while waiting:
            joint = next(j for j in waiting if j.find("parent").get("link") in poses)
            waiting.remove(joint)
            origin, axis = joint.find("origin"), joint.find("axis")
            x, y, z = numbers(origin.get("xyz", "0 0 0"))
            roll, pitch, yaw = numbers(origin.get("rpy", "0 0 0"))
            T = multiply(shift((x, y, z)), axis_turn((0, 0, 1), yaw))
            T = multiply(multiply(T, axis_turn((0, 1, 0), pitch)), axis_turn((1, 0, 0), roll))
            if joint.get("type") == "revolute":
                T = multiply(T, axis_turn(tuple(numbers(axis.get("xyz"))), positions_rad[joint.get("name")]))
            poses[joint.find("child").get("link")] = multiply(poses[joint.find("parent").get("link")], T)
        return poses


def read_stl(path: Path) -> list[tuple[Point, Point, Point]]:
    """Triangles of a binary STL file."""
    data = path.read_bytes()
    (count,) = struct.unpack_from("<I", data, 80)
    return [(v[0:3], v[3:6], v[6:9])
            for v in (struct.unpack_from("<9f", data, 84 + 50 * i + 12) for i in range(count))]


def minus(a: Point, b: Point) -> Point:
    return (a[0] - b[0], a[1] - b[1], a[2] - b[2])


def dot(a: Point, b: Point) -> float:
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def distance_to_segment(p: Point, a: Point, b: Point) -> float:
    ab, ap = minus(b, a), minus(p, a)
    s = min(1.0, max(0.0, dot(ap, ab) / max(dot(ab, ab), 1e-30)))
    return math.dist(p, (a[0] + s * ab[0], a[1] + s * ab[1], a[2] + s * ab[2]))


def distance_to_triangle(p: Point, triangle: tuple[Point, Point, Point]) -> float:
    a, b, c = triangle
    ab, ac, ap = minus(b, a), minus(c, a), minus(p, a)
    aa, bb, cc, pa, pb = dot(ab, ab), dot(ab, ac), dot(ac, ac), dot(ap, ab), dot(ap, ac)
    det = aa * cc - bb * bb
    if det > 1e-30:
        u, v = (cc * pa - bb * pb) / det, (aa * pb - bb * pa) / det
        if u >= 0 and v >= 0 and u + v <= 1:
            return math.sqrt(max(0.0, dot(ap, ap) - u * pa - v * pb))
    return min(distance_to_segment(p, a, b), distance_to_segment(p, b, c), distance_to_segment(p, c, a))


class Surface:
    """Triangles sorted into cubes, to find the nearest of them within one cube's length."""

    CUBE_M = 0.02

    def __init__(self, triangles):
        self.cubes: dict[tuple[int, int, int], list] = {}
        for triangle in triangles:
            low = [math.floor(min(v[i] for v in triangle) / self.CUBE_M) for i in range(3)]
            high = [math.floor(max(v[i] for v in triangle) / self.CUBE_M) for i in range(3)]
            for x in range(low[0], high[0] + 1):
                for y in range(low[1], high[1] + 1):
                    for z in range(low[2], high[2] + 1):
                        self.cubes.setdefault((x, y, z), []).append(triangle)

    def distance(self, p: Point) -> float:
        """Distance to the surface in m; what is in no neighbouring cube counts as one cube away."""
        x, y, z = (math.floor(c / self.CUBE_M) for c in p)
        near = {id(t): t for dx in (-1, 0, 1) for dy in (-1, 0, 1) for dz in (-1, 0, 1)
                for t in self.cubes.get((x + dx, y + dy, z + dz), ())}
        return min((distance_to_triangle(p, t) for t in near.values()), default=self.CUBE_M)
