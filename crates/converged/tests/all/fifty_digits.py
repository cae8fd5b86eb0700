"""The integrals of `fifty_digits_cases.json` in 60 digits: what `cube3-converged` is held against.

Written from the book (docs/src/raycast.md, scene-files.md, volumes.md) with mpmath 1.4.1, and from no line of the crate:

    python -m pip install mpmath==1.4.1
    cd crates/converged/tests/all && python fifty_digits.py            # every case, in minutes
    cd crates/converged/tests/all && python fifty_digits.py 17 tent    # those of a number or of a word in the name, printed only

A ray is split at cell faces and at every place where its integrand is not analytic: bends and steps of opacity, colour and threshold,
layers of gradients, ends of light and of the depth cue, clamped colours, gradients that vanish. Cubics along the ray are exact, in
fractions. On a piece opacity's integral and the pixel's are those of the polynomial through Gauss-Legendre nodes, with 24 and with 48 of
them; a piece on which the two do not agree to 27 digits is halved, and where it ends in a logarithm or a root it is taken over
t = end + length * exp(-u). The error that is written is the sum of what was left between 24 and 48 nodes, which those with 48 are
far below.
"""

import json
import sys
import time
from fractions import Fraction
from pathlib import Path

from mpmath import mp, mpf

mp.dps = 60
HERE = Path(__file__).resolve().parent
NODES = (24, 48)
AGREE = mpf(10) ** -27
# Where a graded piece ends: exp(-TAIL) of its length is left out.
TAIL = 90
NOTHING = mpf(10) ** -45
# Transmittance below which nothing is seen.
DARK = mpf(10) ** -40


def real(x):
    """A fraction or a double, in mp."""
    if isinstance(x, Fraction):
        return mpf(x.numerator) / x.denominator
    return mpf(x)


# Polynomials: lists of coefficients, the constant first, of fractions.


def p_add(a, b):
    n = max(len(a), len(b))
    return [(a[i] if i < len(a) else 0) + (b[i] if i < len(b) else 0) for i in range(n)]


def p_scale(a, k):
    return [x * k for x in a]


def p_mul(a, b):
    out = [0] * (len(a) + len(b) - 1)
    for i, x in enumerate(a):
        for j, y in enumerate(b):
            out[i + j] += x * y
    return out


def p_at(a, t):
    out = a[-1]
    for x in reversed(a[:-1]):
        out = out * t + x
    return out


def p_real(a):
    return [real(x) for x in a]


def trimmed(a):
    while len(a) > 1 and a[-1] == 0:
        a = a[:-1]
    return a


def roots(a, low, high):
    """Real roots of odd order of the polynomial, in mp, strictly between low and high; and of even order, if a root to all digits."""
    a = trimmed(a)
    if len(a) == 1:
        return []
    slope = [x * i for i, x in enumerate(a)][1:]
    turns = [low] + roots(slope, low, high) + [high]
    size = sum(abs(x) * max(abs(low), abs(high)) ** i for i, x in enumerate(a))
    found = []
    for x in turns[1:-1]:
        if abs(p_at(a, x)) <= size * mpf(10) ** -50:
            found.append(x)
    for left, right in zip(turns, turns[1:]):
        f, g = p_at(a, left), p_at(a, right)
        if (f < 0 < g) or (g < 0 < f):
            found.append(crossing(lambda t: p_at(a, t), left, right, f))
    return sorted(x for x in found if low < x < high)


def crossing(function, left, right, at_left):
    """Where the function changes its sign, by Newton's secants held to the bracket."""
    at_right = function(right)
    smallest = mpf(10) ** -58 * max(abs(left), abs(right), mpf(10) ** -10)
    side = 0
    for step in range(2000):
        if right - left <= smallest:
            break
        middle = (left + right) / 2
        if step % 3 != 2:
            secant = (left * at_right - right * at_left) / (at_right - at_left)
            middle = min(max(secant, left), right)
            if middle <= left or middle >= right:
                # The secant ends on an end: look right beside it.
                beside = smallest / 2
                middle = left + beside if abs(at_left) < abs(at_right) else right - beside
        value = function(middle)
        if value == 0:
            return middle
        if (value < 0) == (at_left < 0):
            left, at_left = middle, value
            if side == -1:
                at_right /= 2
            side = -1
        else:
            right, at_right = middle, value
            if side == 1:
                at_left /= 2
            side = 1
    return (left + right) / 2


# Quadrature: nodes, weights, and the integrals from the left end to each node of the polynomial through all of them.


def gauss(n):
    nodes = []
    for i in range(n):
        x = mp.cos(mp.pi * (i + mpf(3) / 4) / (n + mpf(1) / 2))
        for _ in range(12):
            p0, p1 = mpf(1), x
            for k in range(2, n + 1):
                p0, p1 = p1, ((2 * k - 1) * x * p1 - (k - 1) * p0) / k
            slope = n * (x * p1 - p0) / (x * x - 1)
            move = p1 / slope
            x -= move
            if abs(move) < mpf(10) ** -40:
                break
        p0, p1 = mpf(1), x
        for k in range(2, n + 1):
            p0, p1 = p1, ((2 * k - 1) * x * p1 - (k - 1) * p0) / k
        slope = n * (x * p1 - p0) / (x * x - 1)
        nodes.append((-x, 2 / ((1 - x * x) * slope * slope)))
    xs = [x for x, _ in nodes]
    ws = [w for _, w in nodes]
    legendre = []
    for x in xs:
        p = [mpf(1), x]
        for k in range(2, n + 1):
            p.append(((2 * k - 1) * x * p[-1] - (k - 1) * p[-2]) / k)
        legendre.append(p)
    # Of P_k from -1 to x: (P_{k+1} - P_{k-1})/(2k + 1).
    matrix = []
    for i in range(n):
        p = legendre[i]
        upto = [p[1] + 1] + [(p[k + 1] - p[k - 1]) / (2 * k + 1) for k in range(1, n)]
        row = []
        for j in range(n):
            q = legendre[j]
            row.append(ws[j] * mp.fdot([(upto[k] * (2 * k + 1) / 2, q[k]) for k in range(n)]))
        matrix.append(row)
    return xs, ws, matrix


RULES = None


class Transfer:
    """Opacity and colour of a scene, piece by piece."""

    def __init__(self, scene):
        transfer = scene["transfer"]
        layers = transfer.get("layer") or []
        self.layers = [(mpf(layer["gradient"]), layer["opacity"]) for layer in layers] or [(mpf(0), transfer["opacity"])]
        self.two = bool(layers)
        self.colour = [[point["value"], point["rgb"]] for point in transfer["colour"]]
        threshold = scene.get("threshold") or {}
        self.low, self.high = threshold.get("low"), threshold.get("high")
        values = [point[0] for _, points in self.layers for point in points] + [point[0] for point in self.colour]
        self.values = sorted(set(values + [x for x in (self.low, self.high) if x is not None]))
        self.gradients = sorted(set(g for g, _ in self.layers)) if self.two else []

    def removed(self, value):
        return (self.low is not None and value < self.low) or (self.high is not None and value > self.high)

    @staticmethod
    def linear(points, value):
        """(a, b, at): a + b*(v - at) is what the points say around the value."""
        after = sum(1 for point in points if mpf(point[0]) <= value)
        if after == 0:
            return mpf(points[0][1]), mpf(0), mpf(points[0][0])
        if after == len(points):
            return mpf(points[-1][1]), mpf(0), mpf(points[-1][0])
        lower, upper = points[after - 1], points[after]
        return mpf(lower[1]), (mpf(upper[1]) - mpf(lower[1])) / (mpf(upper[0]) - mpf(lower[0])), mpf(lower[0])

    def alpha(self, value, magnitude):
        """The opacity as a function of value and magnitude around a value and a magnitude; and whether it is 0, 1 everywhere."""
        below = [i for i, (g, _) in enumerate(self.layers) if g <= magnitude]
        i = below[-1] if below else 0
        a, b, at = self.linear(self.layers[i][1], value)
        if not below or i + 1 == len(self.layers):
            return (lambda v, g: a + b * (v - at)), (a if b == 0 else None)
        a2, b2, at2 = self.linear(self.layers[i + 1][1], value)
        from_g, width = self.layers[i][0], self.layers[i + 1][0] - self.layers[i][0]
        same = a if b == 0 and b2 == 0 and a == a2 else None

        def between(v, g):
            near = a + b * (v - at)
            return near + (a2 + b2 * (v - at2) - near) * (g - from_g) / width

        return between, same

    def rgb(self, value):
        """Each channel as (a, b, at)."""
        return [self.linear([[point[0], point[1][k]] for point in self.colour], value) for k in range(3)]


class Field:
    """The volume, as polynomials along a ray."""

    def __init__(self, case, volume):
        self.dims = volume["dims"]
        self.samples = [Fraction(x) for x in volume["samples"]]
        self.border = Fraction(case["border"])
        spacing = [Fraction(x) for x in volume["spacing"]]
        self.spacing = spacing
        self.per_voxel = [s / min(spacing) for s in spacing]
        self.labels = case["scene"]["volume"].get("labels", False)
        self.origin = [Fraction(x) for x in case["origin"]]
        self.direction = [Fraction(x) for x in case["direction"]]

    def voxel(self, at):
        if any(x < 0 or x >= n for x, n in zip(at, self.dims)):
            return self.border
        x, y, z = at
        return self.samples[(z * self.dims[1] + y) * self.dims[0] + x]

    def at(self, t):
        return [o + d * t for o, d in zip(self.origin, self.direction)]

    def faces(self):
        """Parameters at which the ray crosses a face between cells."""
        out = []
        for o, d, n in zip(self.origin, self.direction, self.dims):
            if d != 0:
                at = [k + Fraction(1, 2) for k in range(-1, n)] if self.labels else range(n)
                out += [(k - o) / d for k in at]
        return out

    def cell(self, t):
        """Value and gradient around the parameter, as polynomials."""
        if self.labels:
            home = [min(max((x + Fraction(1, 2)).__floor__(), 0), n - 1) for x, n in zip(self.at(t), self.dims)]
        else:
            home = [min(max(x.__floor__(), 0), n - 2) for x, n in zip(self.at(t), self.dims)]
        gradient = []
        for axis in range(3):
            ahead, behind = list(home), list(home)
            ahead[axis] += 1
            behind[axis] -= 1
            difference = p_add(self.values(ahead, home), p_scale(self.values(behind, home), -1))
            gradient.append(trimmed(p_scale(difference, Fraction(1, 2) / self.per_voxel[axis])))
        return trimmed(self.values(home, home)), gradient

    def values(self, corner, home):
        """The values in the cell of a corner at the place that the ray has in the cell of `home`."""
        if self.labels:
            return [self.voxel(corner)]
        weights = []
        for axis in range(3):
            far = [self.origin[axis] - home[axis], self.direction[axis]]
            weights.append((p_add([Fraction(1)], p_scale(far, -1)), far))
        total = [Fraction(0)]
        for dz in (0, 1):
            for dy in (0, 1):
                yz = p_mul(weights[1][dy], weights[2][dz])
                for dx in (0, 1):
                    voxel = self.voxel([corner[0] + dx, corner[1] + dy, corner[2] + dz])
                    if voxel:
                        total = p_add(total, p_scale(p_mul(yz, weights[0][dx]), voxel))
        return total


def unit(vector):
    length = mp.sqrt(mp.fsum(x * x for x in vector))
    return [x / length for x in vector]


class Caster:
    """The ray of one case."""

    def __init__(self, case, volume):
        self.case = case
        self.scene = scene = case["scene"]
        self.field = Field(case, volume)
        self.transfer = Transfer(scene)
        self.sums = scene["mode"] == "weighted-sum"
        self.material = scene["material"]
        self.lit = self.material["shaded"] and not self.sums
        self.eye = unit([-mpf(x) for x in case["world_direction"]])
        self.lights = [self.light(light) for light in scene["light"]]
        self.tau, self.colour, self.alpha, self.error = mpf(0), [mpf(0)] * 3, mpf(0), mpf(0)
        self.hidden = False
        self.nodes = 0

    def light(self, light):
        direction = light.get("direction")
        colour = [mpf(x) for x in light["colour"]]
        if direction is None:
            return self.eye, self.eye, colour
        toward = unit([mpf(x) for x in direction])
        both = [a + b for a, b in zip(toward, self.eye)]
        opposite = mp.sqrt(mp.fsum(x * x for x in both)) < mpf(10) ** -12
        return toward, ([mpf(0)] * 3 if opposite else unit(both)), colour

    def span(self):
        """From where to where the ray is in what is drawn, in fractions."""
        scene, field = self.scene, self.field
        margin = Fraction(1, 2) if field.labels else 0
        low, high = [Fraction(-margin)] * 3, [n - 1 + Fraction(margin) for n in field.dims]
        crop = scene.get("crop")
        if crop:
            low = [max(x, Fraction(y)) for x, y in zip(low, crop["min_voxel"])]
            high = [min(x, Fraction(y)) for x, y in zip(high, crop["max_voxel"])]
        half_spaces = []
        for i in range(3):
            if low[i] > high[i]:
                return None
            half_spaces.append((field.direction[i], field.origin[i] - high[i]))
            half_spaces.append((-field.direction[i], low[i] - field.origin[i]))
        for cut in scene.get("cut", []):
            normal = [Fraction(x) for x in cut["normal"]]
            away = [o - Fraction(x) for o, x in zip(field.origin, cut["through_voxel"])]
            rate = sum(n * d for n, d in zip(normal, field.direction))
            half_spaces.append((rate, sum(n * a for n, a in zip(normal, away))))
        enter, leave = None, None
        for rate, outside in half_spaces:
            # outside + rate*t <= 0
            if rate == 0:
                if outside > 0:
                    return None
            elif abs(rate) < Fraction(1, 10**12):
                raise ValueError("a ray that is parallel to a face but for rounding")
            elif rate > 0:
                leave = -outside / rate if leave is None else min(leave, -outside / rate)
            else:
                enter = -outside / rate if enter is None else max(enter, -outside / rate)
        if self.case["eye"] is not None:
            enter = max(enter, Fraction(self.case["eye"]))
        return (enter, leave) if enter < leave else None

    def weight(self):
        """What a unit length of a weighted sum weighs: the part of the extent along the axis nearest to the view."""
        field = self.field
        steps = [abs(Fraction(d) / s) for d, s in zip(self.case["view_direction"], field.spacing)]
        axis = max((2, 1, 0), key=lambda i: steps[i])
        extent = field.dims[axis] - (0 if field.labels else 1)
        weight = real(abs(field.direction[axis]) / extent)
        assert abs(weight - mpf(self.case["weight"])) <= weight * mpf(10) ** -15
        return weight

    def depth(self):
        """Depth as a polynomial of the ray's parameter, 0 at the nearest corner and 1 at the farthest."""
        field = self.field
        view = [Fraction(x) * s for x, s in zip(self.case["view_direction"], field.spacing)]
        reach = [v * (n - 1) for v, n in zip(view, field.dims)]
        near, far = sum(min(r, 0) for r in reach), sum(max(r, 0) for r in reach)
        along = [sum(v * x for v, x in zip(view, part)) for part in (field.origin, field.direction)]
        return [(along[0] - near) / (far - near), along[1] / (far - near)]

    def pixel(self):
        span = self.span()
        if span:
            enter, leave = span
            inside = sorted(set(t for t in self.field.faces() if enter < t < leave))
            ends = [enter] + inside + [leave]
            for a, b in zip(ends, ends[1:]):
                self.cast_cell(a, b)
                if self.hidden:
                    break
        if self.sums:
            weight = self.weight()
            colour = [min(c * weight, 1) for c in self.colour]
            alpha = min(self.alpha * weight, 1)
            self.error *= weight
        else:
            colour, alpha = self.colour, (mpf(1) if self.hidden else -mp.expm1(-self.tau))
        background = self.scene["background"]
        return [min(max(c + (1 - alpha) * mpf(b), mpf(0)), mpf(1)) for c, b in zip(colour, background)]

    def cast_cell(self, a, b):
        value, gradient = self.field.cell((a + b) / 2)
        cell = Cell(self, value, gradient)
        low, high = real(a), real(b)
        smallest = (high - low) * mpf(10) ** -48
        ends = [low] + [t for t in cell.bends(low, high)] + [high]
        for left, right in zip(ends, ends[1:]):
            if right - left <= smallest:
                continue
            piece = Piece(cell, left, right)
            if piece.clear:
                continue
            if piece.hides:
                t = mp.exp(-self.tau)
                piece.held = [self.lit and c > 1 for c in piece.lit(left)]
                c = piece.cued_colour(left)
                self.colour = [x + t * y for x, y in zip(self.colour, c)]
                self.hidden = True
                return
            bends = piece.clamps()
            for p, q in zip([left] + bends, bends + [right]):
                if q - p > smallest:
                    Piece(cell, p, q).integrate()
                    if mp.exp(-self.tau) < DARK:
                        self.error += DARK
                        self.hidden = True
                        return


class Cell:
    """Polynomials of the ray in one cell."""

    def __init__(self, caster, value, gradient):
        self.caster = caster
        self.value = p_real(value)
        self.constant = len(value) == 1
        self.gradient = [p_real(g) for g in gradient]
        square = [Fraction(0)]
        for g in gradient:
            square = p_add(square, p_mul(g, g))
        square = trimmed(square)
        self.flat = square == [0]
        self.steady = len(square) == 1
        self.square = p_real(square)
        size = sum(abs(x) for g in self.gradient for x in g)
        self.lights = []
        for toward, halfway, colour in caster.lights:
            self.lights.append((self.along(toward, size), self.along(halfway, size), colour))
        self.cue = caster.scene.get("depth_cue")
        self.depth = p_real(caster.depth()) if self.cue else None

    def along(self, direction, size):
        """The gradient's component, and nothing where that is rounding."""
        total = [mpf(0)]
        for g, x in zip(self.gradient, direction):
            total = p_add(total, p_scale(g, x))
        return trimmed([x if abs(x) > size * mpf(10) ** -45 else mpf(0) for x in total])

    def bends(self, low, high):
        """Where something bends or steps between two parameters."""
        caster = self.caster
        found = []
        for value in caster.transfer.values:
            found += roots(p_add(self.value, [-mpf(value)]), low, high)
        for g in caster.transfer.gradients:
            found += roots(p_add(self.square, [-g * g]), low, high)
        if (caster.lit or caster.transfer.two) and not self.steady:
            slope = [x * i for i, x in enumerate(self.square)][1:]
            largest = max(p_at(self.square, low + (high - low) * k / 8) for k in range(9))
            found += [t for t in roots(slope, low, high) if p_at(self.square, t) < largest / 20]
        if caster.lit:
            for facing, mirroring, _ in self.lights:
                found += roots(facing, low, high) + roots(mirroring, low, high)
        if self.cue:
            found += roots(self.depth, low, high) + roots(p_add(self.depth, [mpf(-1)]), low, high)
        return sorted(found)


class Piece:
    """A stretch on which all is analytic, but for its ends."""

    def __init__(self, cell, left, right):
        self.cell, self.caster, self.left, self.right = cell, cell.caster, left, right
        transfer = self.caster.transfer
        middle = (left + right) / 2
        value = p_at(cell.value, middle)
        square = p_at(cell.square, middle)
        magnitude = mp.sqrt(square) if transfer.two else mpf(0)
        self.opacity, same = transfer.alpha(value, magnitude)
        if cell.constant:
            ends = [self.opacity(value, g) for g in (magnitude, magnitude + 1)]
            if ends[0] == ends[1] or cell.steady or not transfer.two:
                same = ends[0]
        self.clear = transfer.removed(value) or same == 0
        self.hides = same == 1 and not self.caster.sums and not self.clear
        self.rgb = transfer.rgb(value)
        self.depth = p_at(cell.depth, middle) if cell.cue else None
        material = self.caster.material
        self.lights = []
        if self.caster.lit and not cell.flat:
            for facing, mirroring, colour in cell.lights:
                f, m = -p_at(facing, middle), -p_at(mirroring, middle)
                if not material["two_sided"] and f <= 0:
                    continue
                f_sign = -1 if f > 0 else 1
                m_sign = 0 if m == 0 or (m < 0 and not material["two_sided"]) else (-1 if m > 0 else 1)
                self.lights.append((p_scale(facing, f_sign), p_scale(mirroring, m_sign), m_sign != 0, colour))
        self.held = [False] * 3
        if self.caster.lit:
            self.held = [c > 1 for c in self.lit(middle)]

    def plain(self, t):
        v = p_at(self.cell.value, t)
        return [a + b * (v - at) for a, b, at in self.rgb]

    def lit(self, t):
        """The lit colour before it is held to 1."""
        material = self.caster.material
        rgb = self.plain(t)
        out = [mpf(material["ambient"]) * c for c in rgb]
        if not self.lights:
            return out
        square = p_at(self.cell.square, t)
        if square <= 0:
            return out
        inverse = 1 / mp.sqrt(square)
        shininess = material["shininess"]
        diffuse, specular = mpf(material["diffuse"]), mpf(material["specular"])
        for facing, mirroring, mirrors, colour in self.lights:
            scattered = diffuse * p_at(facing, t) * inverse
            mirrored = mpf(0)
            if mirrors and specular:
                m = p_at(mirroring, t) * inverse
                if m > 0:
                    mirrored = specular * (m ** int(shininess) if shininess == int(shininess) else m ** mpf(shininess))
            out = [o + k * (scattered * c + mirrored) for o, k, c in zip(out, colour, rgb)]
        return out

    def cued_colour(self, t):
        colour = self.plain(t)
        if self.caster.lit:
            colour = [mpf(1) if held else c for c, held in zip(self.lit(t), self.held)]
        if self.cell.cue:
            front, back = mpf(self.cell.cue["front"]), mpf(self.cell.cue["back"])
            depth = 0 if self.depth <= 0 else 1 if self.depth >= 1 else p_at(self.cell.depth, t)
            factor = front * (1 - depth) + back * depth
            colour = [c * factor for c in colour]
        return colour

    def alpha(self, t):
        magnitude = mp.sqrt(max(p_at(self.cell.square, t), mpf(0))) if self.caster.transfer.two else mpf(0)
        return self.opacity(p_at(self.cell.value, t), magnitude)

    def clamps(self):
        """Where a channel begins or ends to be held to 1."""
        if not self.lights:
            return []
        material = self.caster.material
        scattered, mirrored = material["diffuse"], material["specular"]
        most = max(material["ambient"] + sum(light[3][k] for light in self.lights) * (scattered + mirrored) for k in range(3))
        if most <= 1:
            return []
        length = self.right - self.left
        parts = [mpf(k) / 40 for k in range(1, 40)] + [mpf(2) ** -k for k in range(6, 40)]
        parts = [mpf(10) ** -40] + sorted(parts + [1 - x for x in parts if x < mpf(1) / 40]) + [1 - mpf(10) ** -40]
        places = [self.left + length * x for x in parts]
        colours = [self.lit(t) for t in places]
        found = []
        for k in range(3):
            over = lambda t: self.lit(t)[k] - 1
            values = [c[k] - 1 for c in colours]
            # A peak between two places may reach over 1, and a valley under it.
            more = []
            for i in range(1, len(values) - 1):
                for sign in (1, -1):
                    y = [sign * v for v in values[i - 1 : i + 2]]
                    if y[1] >= y[0] and y[1] >= y[2] and -mpf(1) / 5 < y[1] < 0:
                        peak = self.peak(lambda t: sign * over(t), places[i - 1], places[i + 1])
                        more.append((peak, over(peak)))
            pairs = sorted(list(zip(places, values)) + more)
            for (p, f), (q, g) in zip(pairs, pairs[1:]):
                if (f < 0) != (g < 0) and p < q:
                    found.append(crossing(over, p, q, f))
        return sorted(found)

    @staticmethod
    def peak(function, left, right):
        for _ in range(60):
            third = (right - left) / 3
            if function(left + third) < function(right - third):
                left += third
            else:
                right -= third
            if function((left + right) / 2) > 0:
                break
        return (left + right) / 2

    def sample(self, t):
        """What the integrals are of: absorption, then colours times absorption; of a sum opacity, then colours times opacity."""
        self.caster.nodes += 1
        alpha = self.alpha(t)
        if not self.caster.sums:
            clear = 1 - alpha
            alpha = -mp.log(clear if clear > 0 else mpf(10) ** -mp.dps)
        return alpha, self.cued_colour(t)

    def rule(self, number, at, low, high, transmittance):
        """The integrals over a stretch of the variable x, where at(x) is parameter and derivative: absorption and colours."""
        xs, ws, matrix = RULES[number]
        half, middle = (high - low) / 2, (high + low) / 2
        places = [at(middle + half * x) for x in xs]
        samples = [self.sample(t) for t, _ in places]
        density = [mu * rate * half for (mu, _), (_, rate) in zip(samples, places)]
        whole = mp.fdot(zip(ws, density))
        if self.caster.sums:
            seen = [w * d for w, d in zip(ws, density)]
        else:
            seen = [w * d * transmittance * mp.exp(-mp.fdot(zip(row, density))) for w, d, row in zip(ws, density, matrix)]
        return whole, [mp.fdot([(s, c[k]) for s, (_, c) in zip(seen, samples)]) for k in range(3)]

    def stretch(self, at, low, high, depth=0):
        """Adds a stretch to the ray, halved until both rules agree."""
        caster = self.caster
        if caster.hidden:
            return
        transmittance = mp.exp(-caster.tau)
        if not caster.sums and transmittance < DARK:
            return
        coarse = self.rule(0, at, low, high, transmittance)
        fine = self.rule(1, at, low, high, transmittance)
        behind = 1 if caster.sums else transmittance * mp.exp(-fine[0])
        apart = max([abs(a - b) for a, b in zip(coarse[1], fine[1])] + [behind * abs(coarse[0] - fine[0])])
        if apart > AGREE and depth < 200:
            return False if depth == 0 else self.halves(at, low, high, depth)
        if apart > AGREE:
            raise ValueError("two hundred halvings are not enough")
        caster.error += apart
        if caster.sums:
            caster.alpha += fine[0]
        caster.tau += fine[0]
        caster.colour = [a + b for a, b in zip(caster.colour, fine[1])]
        return True

    def halves(self, at, low, high, depth):
        middle = (low + high) / 2
        self.stretch(at, low, middle, depth + 1)
        self.stretch(at, middle, high, depth + 1)
        return True

    def sharp(self, end):
        """Whether the integrand has, or all but has, a logarithm, a root or a turning normal at an end."""
        middle = (self.left + self.right) / 2
        if not self.caster.sums and 1 - self.alpha(end) < (1 - self.alpha(middle)) / 50:
            return True
        if not (self.caster.lit or self.caster.transfer.two):
            return False
        square = p_at(self.cell.square, middle)
        if p_at(self.cell.square, end) < square / 1000:
            return True
        return any(m and p_at(h, end) < p_at(h, middle) / 50 for _, h, m, _ in self.lights)

    def integrate(self, depth=0):
        straight = lambda t: (t, mpf(1))
        if self.stretch(straight, self.left, self.right):
            return
        if self.caster.hidden or (not self.caster.sums and mp.exp(-self.caster.tau) < DARK):
            return
        if depth > 190:
            raise ValueError("too many halvings")
        left, right = self.left, self.right
        middle = (left + right) / 2
        sharp = self.sharp(left), self.sharp(right)
        steps = [mpf(x) for x in (0, 2, 5, 9, 15, 25, 40, 60, TAIL)]
        length = (right - left) / 2
        for first in (True, False):
            piece = Piece(self.cell, left, middle) if first else Piece(self.cell, middle, right)
            if not sharp[0 if first else 1]:
                piece.integrate(depth + 1)
            elif first:
                graded = lambda x: (left + length * mp.exp(x), length * mp.exp(x))
                for a, b in zip(steps[::-1], steps[-2::-1]):
                    piece.stretch(graded, -a, -b, 1)
            else:
                graded = lambda x: (right - length * mp.exp(-x), length * mp.exp(-x))
                for a, b in zip(steps, steps[1:]):
                    piece.stretch(graded, a, b, 1)


def cast(case, volumes):
    caster = Caster(case, volumes[case["volume"]])
    pixel = caster.pixel()
    return pixel, caster.error + mpf(10) ** -35, caster.nodes


def main():
    global RULES
    RULES = [gauss(n) for n in NODES]
    given = json.loads((HERE / "fifty_digits_cases.json").read_text())
    wanted = sys.argv[1:]
    lines = []
    begun = time.time()
    for number, case in enumerate(given["cases"]):
        if wanted and not any(w == str(number) or (not w.isdigit() and w in case["name"]) for w in wanted):
            continue
        case["scene"] = {**given["default"], **case["scene"]}
        started = time.time()
        try:
            pixel, error, nodes = cast(case, given["volumes"])
        except ValueError as reason:
            print(number, case["name"], "IS NO CASE:", reason, flush=True)
            continue
        digits = [mp.nstr(mp.nint(x * 10**25) / 10**25, 26, strip_zeros=False, min_fixed=-99) for x in pixel]
        line = {"name": case["name"], "pixel": digits, "error": mp.nstr(error, 3)}
        lines.append(json.dumps(line))
        print(number, line, nodes, f"{time.time() - started:.1f} s", flush=True)
    if not wanted:
        (HERE / "fifty_digits.json").write_text("[\n" + ",\n".join(lines) + "\n]\n")
    print(f"{time.time() - begun:.0f} s")


if __name__ == "__main__":
    main()
