"""Trials of instructions: PTX that executes one, and rows of inputs with the outputs that the ISA demands."""

import random
import re
from dataclasses import dataclass
from itertools import product

from exact_real import FORMATS

WIDTH = {"pred": 1, "f32": 32, "f64": 64} | {f"{k}{w}": w for k in "bus" for w in (8, 16, 32, 64)}
MAX_ROWS = 512


@dataclass
class Trial:
    """`body` reads the registers %a0, %a1, … and writes %d0, %d1, …, whose types `inputs` and `outputs` give. It has 64 bytes
    of memory at %m, all zero, and the number of its thread in %n. `rows`: (inputs, outputs), as bits."""

    opcode: str
    body: str
    inputs: tuple
    outputs: tuple
    rows: list
    threads: int = 0  # of a block, one for each row; 0: rows are launched one by one
    declarations: str = ""  # before the entry
    fault: str = ""  # message of the error that the launch ends with
    others: tuple = ()  # instructions that the body executes, too


def merged(trials):
    """One trial that executes those of several, which have the same inputs. An entry for each would take long to compile."""
    bodies, outputs = [], ()
    for t in trials:
        if t.inputs != trials[0].inputs or [r[0] for r in t.rows] != [r[0] for r in trials[0].rows]:
            raise ValueError(f"{t.opcode} and {trials[0].opcode} have different inputs")
        first = len(outputs)
        bodies.append("{\n" + re.sub(r"%d(\d+)", lambda m, n=first: f"%d{int(m[1]) + n}", t.body) + "\n}")
        outputs += t.outputs
    rows = [(group[0][0], sum((r[1] for r in group), ())) for group in zip(*(t.rows for t in trials))]
    declarations = "\n".join(t.declarations for t in trials if t.declarations)
    others = tuple(t.opcode for t in trials[1:])
    return Trial(trials[0].opcode, "\n".join(bodies), trials[0].inputs, outputs, rows, declarations=declarations, others=others)


def register_of(kind, wide=False):
    """Type of a register for values of a type; `wide`: as wide as the instruction permits."""
    if kind == "pred" or kind[0] == "f":
        return kind
    return f"b{max(WIDTH[kind], 32) if wide else WIDTH[kind]}"


def mask(value, kind):
    return value & ((1 << WIDTH[kind]) - 1)


def to_signed(value, width):
    value &= (1 << width) - 1
    return value - (1 << width) if value >> (width - 1) else value


def number(bits, kind):
    """The integer that the bits are."""
    return to_signed(bits, WIDTH[kind]) if kind[0] == "s" else mask(bits, kind)


def extend(bits, kind, register):
    """The bits of a wider register that holds a value."""
    return mask(number(bits, kind), register)


def special_integers(kind):
    width = WIDTH[kind]
    top = 1 << (width - 1)
    numbers = [0, 1, 2, 7, width - 1, width, width + 1, 63, 64, top - 1, top, top + 1, -2, -1]
    patterns = [0x0123456789ABCDEF, 0xA5A5A5A5A5A5A5A5]
    return [mask(n, kind) for n in numbers] + [mask(p >> (64 - width), kind) for p in patterns]


def special_reals(kind):
    f = FORMATS[kind]
    one = f.round(FORMATS["f64"].value(0x3FF0000000000000))
    sizes = [0, 1, (1 << f.mantissa) - 1, 1 << f.mantissa, one - 1, one, one + 1, one + (1 << (f.mantissa - 1)), f.infinity - 1, f.infinity]
    quiet = f.infinity | 1 << (f.mantissa - 1)
    nans = [f.nan, quiet, quiet | f.sign_bit | 5, f.infinity | 1]
    return [s | sign for s in sizes for sign in (0, f.sign_bit)] + nans


def special_values(kind):
    if kind == "pred":
        return [0, 1]
    return special_reals(kind) if kind in FORMATS else special_integers(kind)


def random_value(kind, generator):
    """Uniform bits, or for floats sometimes a number near 1, so that sums round."""
    bits = generator.getrandbits(WIDTH[kind])
    if kind in FORMATS and generator.random() < 0.7:
        f = FORMATS[kind]
        exponent = (1 << (f.width - 2 - f.mantissa)) - 1 + generator.randint(-3, 3)
        bits = (bits & f.sign_bit) | exponent << f.mantissa | (bits & ((1 << f.mantissa) - 1))
    return bits


def rows_of(kinds, seed, most=MAX_ROWS, randoms=24):
    """Inputs of some types: combinations of special values, all of them if they are few, and random ones."""
    generator = random.Random(seed)
    lists = [special_values(k) for k in kinds]
    total = 1
    for values in lists:
        total *= len(values)
    if total + randoms <= most:
        rows = list(product(*lists))
    else:
        rows = [tuple(generator.choice(values) for values in lists) for _ in range(most - randoms)]
    return rows + [tuple(random_value(k, generator) for k in kinds) for _ in range(randoms)]


def operation(opcode, sources, result, function, wide=False, most=256, seed=None):
    """A trial of `opcode result, sources`; function(inputs) → bits. Trials with one `seed` have the same inputs."""
    registers = tuple(register_of(s, wide) for s in sources)
    target = register_of(result, wide)
    rows = []
    for row in rows_of(registers if wide else sources, seed or opcode, most):
        rows.append((row, (extend(function(*row), result, target) if wide else function(*row),)))
    operands = ", ".join(["%d0", *(f"%a{i}" for i in range(len(sources)))])
    return Trial(opcode, f"{opcode} {operands};", registers, (target,), rows)
