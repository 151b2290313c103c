"""Expected results of integer and logic instructions, from the definitions of the PTX ISA in Python's integers."""

from trial import Trial, WIDTH, mask, number, operation, register_of, rows_of

INTEGERS = ("u16", "s16", "u32", "s32", "u64", "s64")
WIDER = {"u16": "u32", "s16": "s32", "u32": "u64", "s32": "s64"}


def quotient(a, b):
    """Rounded towards zero."""
    return abs(a) // abs(b) * (1 if (a < 0) == (b < 0) else -1)


def two_operands(kind):
    """Name -> function of two integers."""
    width = WIDTH[kind]
    return {
        "add": lambda a, b: a + b,
        "sub": lambda a, b: a - b,
        "mul.lo": lambda a, b: a * b,
        "mul.hi": lambda a, b: a * b >> width,
        "div": lambda a, b: quotient(a, b) if b else -1,
        "rem": lambda a, b: a - b * quotient(a, b) if b else a,
        "min": min,
        "max": max,
    }


def three_operands(kind):
    width = WIDTH[kind]
    return {
        "mad.lo": lambda a, b, c: a * b + c,
        "mad.hi": lambda a, b, c: (a * b >> width) + c,
        "sad": lambda a, b, c: c + abs(a - b),
    }


def on_numbers(function, kind, result=None):
    """A function of bits from one of integers."""
    return lambda *row: mask(function(*(number(x, kind) for x in row)), result or kind)


def arithmetic():
    trials = []
    for kind in INTEGERS:
        for count, table in ((2, two_operands(kind)), (3, three_operands(kind))):
            for name, function in table.items():
                trials.append(operation(f"{name}.{kind}", (kind,) * count, kind, on_numbers(function, kind)))
        if kind in WIDER:
            wide = WIDER[kind]
            trials.append(operation(f"mul.wide.{kind}", (kind, kind), wide, on_numbers(lambda a, b: a * b, kind, wide)))
            trials.append(operation(f"mad.wide.{kind}", (kind, kind, wide), wide, mad_wide(kind, wide)))
        if kind[0] == "s":
            trials.append(operation(f"abs.{kind}", (kind,), kind, on_numbers(abs, kind)))
            trials.append(operation(f"neg.{kind}", (kind,), kind, on_numbers(lambda a: -a, kind)))
    return trials


def mad_wide(kind, wide):
    return lambda a, b, c: mask(number(a, kind) * number(b, kind) + c, wide)


# ---- Bits


def bits_of(value, width):
    return [value >> i & 1 for i in range(width)]


def from_bits(bits):
    return sum(bit << i for i, bit in enumerate(bits))


def find_highest(kind, shift):
    def find(a):
        value = number(a, kind)
        value = ~value if value < 0 else value
        if value == 0:
            return 0xFFFFFFFF
        position = value.bit_length() - 1
        return WIDTH[kind] - 1 - position if shift else position

    return find


def extract(kind):
    """The pseudo-code of bfe."""
    width = WIDTH[kind]

    def bfe(a, b, c):
        position, length = b & 0xFF, c & 0xFF
        source = bits_of(a, width)
        sign = 0 if kind[0] == "u" or length == 0 else source[min(position + length - 1, width - 1)]
        return from_bits(source[position + i] if i < length and position + i < width else sign for i in range(width))

    return bfe


def insert(kind):
    """The pseudo-code of bfi."""
    width = WIDTH[kind]

    def bfi(a, b, c, d):
        position, length = c & 0xFF, d & 0xFF
        source, target = bits_of(a, width), bits_of(b, width)
        for i in range(length):
            if position + i < width and i < width:
                target[position + i] = source[i]
        return from_bits(target)

    return bfi


def bit_fields():
    trials = []
    for kind in ("b32", "b64"):
        width = WIDTH[kind]
        trials.append(operation(f"popc.{kind}", (kind,), "u32", lambda a: a.bit_count()))
        trials.append(operation(f"clz.{kind}", (kind,), "u32", lambda a, w=width: w - a.bit_length()))
        trials.append(operation(f"brev.{kind}", (kind,), kind, lambda a, w=width: from_bits(reversed(bits_of(a, w)))))
        trials.append(operation(f"bfi.{kind}", (kind, kind, "u32", "u32"), kind, insert(kind), most=512))
    for kind in ("u32", "s32", "u64", "s64"):
        trials.append(operation(f"bfind.{kind}", (kind,), "u32", find_highest(kind, shift=False)))
        trials.append(operation(f"bfind.shiftamt.{kind}", (kind,), "u32", find_highest(kind, shift=True)))
        trials.append(operation(f"bfe.{kind}", (kind, "u32", "u32"), kind, extract(kind), most=512))
    return trials


# ---- Logic and shifts


def funnel(side, mode):
    def shift(a, b, c):
        n = c & 31 if mode == "wrap" else min(c, 32)
        pair = b << 32 | a
        return (pair << n) >> 32 & 0xFFFFFFFF if side == "l" else pair >> n & 0xFFFFFFFF

    return shift


def permute(a, b, c):
    """The default mode of prmt."""
    stored = (b << 32 | a).to_bytes(8, "little")
    result = b""
    for i in range(4):
        selection = c >> (4 * i) & 0xF
        byte = stored[selection & 7]
        result += bytes([(0xFF if byte & 0x80 else 0) if selection & 8 else byte])
    return int.from_bytes(result, "little")


def lookup(table):
    def lop3(a, b, c):
        return from_bits(table >> (x << 2 | y << 1 | z) & 1 for x, y, z in zip(bits_of(a, 32), bits_of(b, 32), bits_of(c, 32)))

    return lop3


def lop3_trial():
    """The table is an immediate operand: one instruction for each."""
    tables = (0x00, 0x80, 0x96, 0xCA, 0xE8, 0xFE, 0xFF)
    body = "".join(f"lop3.b32 %d{i}, %a0, %a1, %a2, {table};\n" for i, table in enumerate(tables))
    rows = [(row, tuple(lookup(t)(*row) for t in tables)) for row in rows_of(("b32",) * 3, "lop3", 128)]
    return Trial("lop3.b32", body, ("b32",) * 3, ("b32",) * len(tables), rows)


def logic():
    trials = [lop3_trial(), operation("prmt.b32", ("b32",) * 3, "b32", permute, most=512)]
    for kind in ("pred", "b16", "b32", "b64"):
        trials.append(operation(f"and.{kind}", (kind, kind), kind, lambda a, b: a & b))
        trials.append(operation(f"or.{kind}", (kind, kind), kind, lambda a, b: a | b))
        trials.append(operation(f"xor.{kind}", (kind, kind), kind, lambda a, b: a ^ b))
        trials.append(operation(f"not.{kind}", (kind,), kind, lambda a, k=kind: mask(~a, k)))
        if kind == "pred":
            continue
        trials.append(operation(f"cnot.{kind}", (kind,), kind, lambda a: int(a == 0)))
        trials.append(operation(f"shl.{kind}", (kind, "u32"), kind, lambda a, n, k=kind: mask(a << min(n, 64), k)))
    for kind in ("b16", "b32", "b64", *INTEGERS):
        shift = lambda a, n, k=kind: mask(number(a, k) >> min(n, 64), k)
        trials.append(operation(f"shr.{kind}", (kind, "u32"), kind, shift))
    for side in "lr":
        for mode in ("wrap", "clamp"):
            trials.append(operation(f"shf.{side}.{mode}.b32", ("b32", "b32", "u32"), "b32", funnel(side, mode), most=512))
    return trials


def trials():
    return arithmetic() + bit_fields() + logic()
