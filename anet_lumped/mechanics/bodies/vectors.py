"""Vectors and 3x3 matrices as tuples of numbers, of rotations above all; matrices by rows."""

from anet_lumped.compiled.jit import inlined


@inlined
def row(array, i):
    """Row i of an (n, 3) array."""
    return array[i, 0], array[i, 1], array[i, 2]


@inlined
def three(numbers, i):
    """Three numbers of a flat array from the i-th on."""
    return numbers[i], numbers[i + 1], numbers[i + 2]


@inlined
def nine(numbers, i):
    """Nine numbers of a flat array from the i-th on: a matrix by rows."""
    return (
        numbers[i], numbers[i + 1], numbers[i + 2], numbers[i + 3], numbers[i + 4], numbers[i + 5], numbers[i + 6], numbers[i + 7],
        numbers[i + 8],
    )  # fmt: skip


@inlined
def put_three(numbers, i, x):
    """Write three numbers of a flat array from the i-th on."""
    numbers[i], numbers[i + 1], numbers[i + 2] = x[0], x[1], x[2]


@inlined
def put(array, i, x):
    """Write row i of an (n, 3) array."""
    array[i, 0], array[i, 1], array[i, 2] = x[0], x[1], x[2]


@inlined
def plus(a, b):
    """a + b."""
    return a[0] + b[0], a[1] + b[1], a[2] + b[2]


@inlined
def minus(a, b):
    """a - b."""
    return a[0] - b[0], a[1] - b[1], a[2] - b[2]


@inlined
def scaled(s, a):
    """s a."""
    return s * a[0], s * a[1], s * a[2]


@inlined
def dot(a, b):
    """a . b."""
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


@inlined
def cross(a, b):
    """a x b."""
    return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]


@inlined
def largest(a):
    """Largest size of a component."""
    return max(abs(a[0]), abs(a[1]), abs(a[2]))


@inlined
def inertia_of(m, a):
    """Inertia of a mass at a place, m (|a|^2 I - a a^T)."""
    xx, yy, zz = m * a[0] * a[0], m * a[1] * a[1], m * a[2] * a[2]
    xy, xz, yz = -m * a[0] * a[1], -m * a[0] * a[2], -m * a[1] * a[2]
    return yy + zz, xy, xz, xy, xx + zz, yz, xz, yz, xx + yy


@inlined
def added(A, B):
    """Sum of two matrices."""
    return A[0] + B[0], A[1] + B[1], A[2] + B[2], A[3] + B[3], A[4] + B[4], A[5] + B[5], A[6] + B[6], A[7] + B[7], A[8] + B[8]


@inlined
def times_scalar(s, A):
    """s A."""
    return s * A[0], s * A[1], s * A[2], s * A[3], s * A[4], s * A[5], s * A[6], s * A[7], s * A[8]


@inlined
def applied(A, x):
    """A x."""
    return (
        A[0] * x[0] + A[1] * x[1] + A[2] * x[2],
        A[3] * x[0] + A[4] * x[1] + A[5] * x[2],
        A[6] * x[0] + A[7] * x[1] + A[8] * x[2],
    )


@inlined
def transposed_applied(A, x):
    """A^T x."""
    return (
        A[0] * x[0] + A[3] * x[1] + A[6] * x[2],
        A[1] * x[0] + A[4] * x[1] + A[7] * x[2],
        A[2] * x[0] + A[5] * x[1] + A[8] * x[2],
    )


@inlined
def cross_matrix(a):
    """The matrix [a] with [a] x = a x x."""
    zero = 0.0 * a[0]
    return zero, -a[2], a[1], a[2], zero, -a[0], -a[1], a[0], zero


@inlined
def cross_twice(a, b):
    """[a] [b], which is b a^T - (a . b) I."""
    xx, yy, zz = a[0] * b[0], a[1] * b[1], a[2] * b[2]
    return -yy - zz, b[0] * a[1], b[0] * a[2], b[1] * a[0], -xx - zz, b[1] * a[2], b[2] * a[0], b[2] * a[1], -xx - yy


@inlined
def matrix_product(A, B):
    """A B."""
    return (
        A[0] * B[0] + A[1] * B[3] + A[2] * B[6], A[0] * B[1] + A[1] * B[4] + A[2] * B[7], A[0] * B[2] + A[1] * B[5] + A[2] * B[8],
        A[3] * B[0] + A[4] * B[3] + A[5] * B[6], A[3] * B[1] + A[4] * B[4] + A[5] * B[7], A[3] * B[2] + A[4] * B[5] + A[5] * B[8],
        A[6] * B[0] + A[7] * B[3] + A[8] * B[6], A[6] * B[1] + A[7] * B[4] + A[8] * B[7], A[6] * B[2] + A[7] * B[5] + A[8] * B[8],
    )  # fmt: skip


@inlined
def solved(A, x):
    """A^-1 x of a symmetric positive matrix, by its L D L^T."""
    l10, l20 = A[3] / A[0], A[6] / A[0]
    d1 = A[4] - l10 * A[3]
    l21 = (A[7] - l20 * A[3]) / d1
    d2 = A[8] - l20 * A[6] - l21 * l21 * d1
    y1 = x[1] - l10 * x[0]
    z2 = (x[2] - l20 * x[0] - l21 * y1) / d2
    z1 = y1 / d1 - l21 * z2
    return x[0] / A[0] - l10 * z1 - l20 * z2, z1, z2


@inlined
def turned(theta, a):
    """The vector a after the rotation of the Cayley vector theta: a + (theta x a + theta x (theta x a)/2)/(1 + |theta|^2/4).

    theta = 2 tan(angle/2) along the axis, and then turned - a = theta x (turned + a)/2.
    """
    return plus(a, turned_by(theta, a))


@inlined
def turned_by(theta, a):
    """`turned` less a, to all digits, however small the rotation is."""
    once = cross(theta, a)
    twice = cross(theta, once)
    return scaled(1.0 / (1.0 + 0.25 * dot(theta, theta)), plus(once, scaled(0.5, twice)))
