"""Expected results of floating-point arithmetic, comparison, selection and conversion."""

from fractions import Fraction

from exact_real import FORMATS, round_to_integer
from trial import WIDTH, mask, merged, number, operation

INTEGERS = ("u16", "s16", "u32", "s32", "u64", "s64")
ALL_INTEGERS = ("u8", "s8", *INTEGERS)
REAL_MODES = ("rn", "rz", "rm", "rp")
INTEGER_MODES = ("rni", "rzi", "rmi", "rpi")


def arithmetic():
    trials = []
    for kind, f in FORMATS.items():
        rounded = {"add": (f.add, 2), "sub": (f.sub, 2), "mul": (f.mul, 2), "div": (f.div, 2), "fma": (f.fma, 3)}
        rounded |= {"sqrt": (f.sqrt, 1), "rcp": (f.rcp, 1)}
        exact = {"abs": (f.abs, 1), "neg": (f.neg, 1), "min": (f.min, 2), "max": (f.max, 2), "copysign": (f.copysign, 2)}
        for name, (function, count) in rounded.items():
            trials.append(operation(f"{name}.rn.{kind}", (kind,) * count, kind, function, most=512))
        for name, (function, count) in exact.items():
            trials.append(operation(f"{name}.{kind}", (kind,) * count, kind, function, most=512))
        for name, function in tests_of(f).items():
            trials.append(operation(f"testp.{name}.{kind}", (kind,), "pred", function))
    return trials


def tests_of(f):
    finite = lambda a: not f.is_nan(a) and not f.is_infinite(a)
    return {
        "finite": lambda a: int(finite(a)),
        "infinite": lambda a: int(f.is_infinite(a)),
        "number": lambda a: int(not f.is_nan(a)),
        "notanumber": lambda a: int(f.is_nan(a)),
        "normal": lambda a: int(finite(a) and not f.is_subnormal(a)),
        "subnormal": lambda a: int(f.is_subnormal(a)),
    }


# ---- Comparison

ORDERS = {"eq": (0,), "ne": (-1, 1), "lt": (-1,), "le": (-1, 0), "gt": (1,), "ge": (0, 1)}
UNSIGNED = {"lo": ORDERS["lt"], "ls": ORDERS["le"], "hi": ORDERS["gt"], "hs": ORDERS["ge"]}


def comparisons(kind):
    """Name -> function of two values."""
    if kind not in FORMATS:
        names = {n: ORDERS[n] for n in ("eq", "ne")} if kind[0] == "b" else ORDERS | (UNSIGNED if kind[0] == "u" else {})
        return {n: integer_comparison(kind, orders) for n, orders in names.items()}
    compare = FORMATS[kind].compare
    found = {n: lambda a, b, o=orders: compare(a, b) in o for n, orders in ORDERS.items()}
    found |= {n + "u": lambda a, b, o=orders: compare(a, b) in (*o, None) for n, orders in ORDERS.items()}
    return found | {"num": lambda a, b: compare(a, b) is not None, "nan": lambda a, b: compare(a, b) is None}


def integer_comparison(kind, orders):
    def compare(a, b):
        a, b = number(a, kind), number(b, kind)
        return (a > b) - (a < b) in orders

    return compare


def comparison():
    trials = []
    true = {"u32": 0xFFFFFFFF, "s32": 0xFFFFFFFF, "f32": FORMATS["f32"].round(Fraction(1))}
    for kind in ("b16", "b32", "b64", *INTEGERS, "f32", "f64"):
        for name, function in comparisons(kind).items():
            compare = lambda a, b, f=function: int(f(a, b))
            group = [operation(f"setp.{name}.{kind}", (kind, kind), "pred", compare, most=512, seed=name)]
            for result, value in true.items():
                choose = lambda a, b, f=function, v=value: v if f(a, b) else 0
                group.append(operation(f"set.{name}.{result}.{kind}", (kind, kind), result, choose, most=512, seed=name))
            trials.append(merged(group))
        trials.append(operation(f"selp.{kind}", (kind, kind, "pred"), kind, lambda a, b, c: a if c else b))
    return trials


# ---- Conversion


def to_integer(kind, source, mode):
    """Rounds, then saturates. NaN as the ISA's table says."""
    f = FORMATS[source]
    width = WIDTH[kind]
    low, high = (-(1 << (width - 1)), (1 << (width - 1)) - 1) if kind[0] == "s" else (0, (1 << width) - 1)

    def convert(a):
        if f.is_nan(a):
            return 1 << (width - 1) if source == "f64" or width == 64 else 0
        if f.is_infinite(a):
            return mask(low if f.is_negative(a) else high, kind)
        return mask(min(max(round_to_integer(f.value(a), mode), low), high), kind)

    return convert


def conversion(modes, targets, sources, function_of):
    trials = []
    for mode in modes:
        for target in targets:
            for source in sources:
                opcode = ".".join(filter(None, ("cvt", mode, target, source)))
                trials.append(operation(opcode, (source,), target, function_of(mode, target, source), wide=True))
    return trials


def conversions():
    integer = lambda mode, t, s: lambda a: mask(number(a, s), t)
    from_integer = lambda mode, t, s: lambda a: FORMATS[t].round(Fraction(number(a, s)), mode)
    from_real = lambda mode, t, s: lambda a: FORMATS[s].to_format(a, FORMATS[t], mode or "rn")
    trials = conversion(("",), ALL_INTEGERS, ALL_INTEGERS, integer)
    trials += conversion(REAL_MODES, FORMATS, ALL_INTEGERS, from_integer)
    trials += conversion(INTEGER_MODES, ALL_INTEGERS, FORMATS, lambda mode, t, s: to_integer(t, s, mode))
    trials += conversion(("",), ("f64",), ("f32",), from_real)
    trials += conversion(REAL_MODES, ("f32",), ("f64",), from_real)
    for kind, f in FORMATS.items():
        trials += conversion(INTEGER_MODES, (kind,), (kind,), lambda mode, t, s, f=f: lambda a: f.to_integral(a, mode))
    return trials


def trials():
    return arithmetic() + comparison() + conversions()
