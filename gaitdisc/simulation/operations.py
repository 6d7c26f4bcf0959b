"""What the machine's operations compute, over the rows of a block; compiled once, as vector code.

The library's sine, exponential and hyperbolic tangent would be called row by row and take most of a run. The ones here
agree with them to 4e-16, absolutely or relatively.
"""

import math

import numpy as np

from gaitdisc.compiled import compiled

# Without numpy's division there would be a branch in every loop.
fast = compiled(error_model="numpy", fastmath=False, nogil=True)

BLOCK = 64  # rows at once
_ROUND = 6755399441055744.0  # 1.5 * 2**52: adding it leaves the nearest whole number in the low bits
_LOG2_E = 1.4426950408889634
_LN2_HIGH, _LN2_LOW = 6.93145751953125e-1, 1.42860682030941723212e-6
_HALF_PI = (1.57079632673412561417, 6.07710050630396597660e-11, 2.02226624871116645580e-21)
_FAR = 1e5  # beyond, the library reduces the angle


@fast
def exponential(x):
    """e^x, with x held at 700 at most.

    Source: Moshier, Cephes Mathematical Library, `exp`: Cody-Waite reduction and a rational function.

    >>> round(exponential(1.0), 12), exponential(-1e9)
    (2.718281828459, 0.0)
    """
    y = 700.0 if x > 700.0 else x
    y = -708.0 if y < -708.0 else y
    shifted = y * _LOG2_E + _ROUND
    k = shifted - _ROUND
    r = y - k * _LN2_HIGH - k * _LN2_LOW
    z = r * r
    p = r * ((1.26177193074810590878e-4 * z + 3.02994407707441961300e-2) * z + 9.99999999999999999910e-1)
    q = 3.00198505138664455042e-6 * z + 2.52448340349684104192e-3
    q = (q * z + 2.27265548208155028766e-1) * z + 2.00000000000000000005
    bits = np.float64(shifted).view(np.int64)
    scale = np.int64((bits + 1023) << 52).view(np.float64)
    value = (1.0 + 2.0 * p / (q - p)) * scale
    return 0.0 if x < -708.0 else value


@fast
def hyperbolic_tangent(x):
    """Tanh x.

    Source: Moshier, Cephes Mathematical Library, `tanh`.

    >>> round(hyperbolic_tangent(0.5), 12)
    0.46211715726
    """
    z = x * x
    p = (-9.64399179425052238628e-1 * z - 9.92877231001918586564e1) * z - 1.61468768441708447952e3
    q = ((z + 1.12811678491632931402e2) * z + 2.23548839060100448583e3) * z + 4.84406305325125486048e3
    near = x + x * z * p / q
    far = 1.0 - 2.0 / (exponential(2.0 * abs(x)) + 1.0)
    far = -far if x < 0.0 else far
    return near if abs(x) < 0.625 else far


@fast
def sine(x, quarter):
    """Sine of x + quarter quarter turns, for |x| up to 1e5.

    x: angle [rad]
    Source: Cody and Waite 1980 for the reduction; Sun Microsystems 1993, fdlibm, for the two polynomials.

    >>> round(sine(1.0, 0), 12), round(sine(1.0, 1), 12)
    (0.841470984808, 0.540302305868)
    """
    shifted = x * 0.6366197723675814 + _ROUND
    k = shifted - _ROUND
    turn = np.float64(shifted).view(np.int64) + quarter
    r = ((x - k * _HALF_PI[0]) - k * _HALF_PI[1]) - k * _HALF_PI[2]
    z = r * r
    s = (1.58969099521155010221e-10 * z - 2.50507602534068634195e-8) * z + 2.75573137070700676789e-6
    s = ((s * z - 1.98412698298579493134e-4) * z + 8.33333333332248946124e-3) * z - 1.66666666666666324348e-1
    s = r + r * z * s
    c = (-1.13596475577881948265e-11 * z + 2.08757232129817482790e-9) * z - 2.75573143513906633035e-7
    c = ((c * z + 2.48015872894767294178e-5) * z - 1.38888888888741095749e-3) * z + 4.16666666666666019037e-2
    half = 0.5 * z
    leading = 1.0 - half
    c = leading + (((1.0 - leading) - half) + z * z * c)
    value = c if turn & 1 else s
    return -value if turn & 2 else value


@fast
def execute(code, registers, outputs, width):  # noqa: PLR0912 a branch for each operation
    """Run register operations over the first rows of a block.

    Registers and outputs lie one after the other, `BLOCK` rows each, and the code holds where each begins: with
    unsigned places into flat memory the compiler makes the tightest loops.

    code of uint64 (operation, 4): operation, then the first place of what is written and of what is read
    registers, outputs (register * BLOCK,), (output * BLOCK,): changed in place
    """
    for i in range(code.shape[0]):
        op, z, a, b = code[i, 0], code[i, 1], code[i, 2], code[i, 3]
        if op == 0:
            for r in range(width):
                outputs[z + r] = registers[a + r]
        elif op == 1:
            for r in range(width):
                registers[z + r] = registers[a + r] + registers[b + r]
        elif op == 2:
            for r in range(width):
                registers[z + r] = registers[a + r] - registers[b + r]
        elif op == 3:
            for r in range(width):
                registers[z + r] = registers[a + r] * registers[b + r]
        elif op == 4:
            for r in range(width):
                registers[z + r] = registers[a + r] / registers[b + r]
        elif op < 11:
            _turning(op, registers, (z, a, b), width)
        elif op < 14:
            _growing(op, registers, (z, a), width)
        else:
            _chosen(op, registers, (z, a, b), width)


@fast
def _turning(op, registers, places, width):
    z, a, b = places
    if op == 5:
        for r in range(width):
            registers[z + r] = registers[a + r] ** registers[b + r]
    elif op == 6:
        for r in range(width):
            registers[z + r] = -registers[a + r]
    elif op == 9:
        for r in range(width):
            registers[z + r] = math.tan(registers[a + r])
    elif op == 10:
        for r in range(width):
            registers[z + r] = hyperbolic_tangent(registers[a + r])
    else:
        _waving(op, registers, (z, a), width)


@fast
def _waving(op, registers, places, width):
    z, a = places
    most = 0.0
    for r in range(width):
        most = max(most, abs(registers[a + r]))
    if most > _FAR:
        for r in range(width):
            registers[z + r] = math.sin(registers[a + r]) if op == 7 else math.cos(registers[a + r])
    else:
        quarter = np.int64(op) - 7
        for r in range(width):
            registers[z + r] = sine(registers[a + r], quarter)


@fast
def _growing(op, registers, places, width):
    z, a = places
    if op == 11:
        for r in range(width):
            registers[z + r] = exponential(registers[a + r])
    elif op == 12:
        for r in range(width):
            x = registers[a + r]
            registers[z + r] = np.log(x) if x > 0.0 else (-np.inf if x == 0.0 else np.nan)
    else:
        for r in range(width):
            registers[z + r] = np.sqrt(registers[a + r])


@fast
def _chosen(op, registers, places, width):
    z, a, b = places
    if op == 14:
        for r in range(width):
            registers[z + r] = abs(registers[a + r])
    elif op == 15:
        for r in range(width):
            x, y = registers[a + r], registers[b + r]
            registers[z + r] = x if x > y or np.isnan(x) else y
    elif op == 16:
        for r in range(width):
            x, y = registers[a + r], registers[b + r]
            registers[z + r] = x if x < y or np.isnan(x) else y
    elif op == 17:
        for r in range(width):
            x = registers[a + r]
            registers[z + r] = x if np.isnan(x) else (1.0 if x > 0.0 else 0.0)
    elif op == 18:
        for r in range(width):
            x, y = registers[a + r], registers[b + r]
            registers[z + r] = x if np.isnan(x) else (y if x > 0.0 else 0.0)
    else:
        for r in range(width):
            registers[z + r] = math.atan(registers[a + r])
