"""Trials of moves, loads, stores, addresses and atomic operations."""

from itertools import product

from trial import Trial, WIDTH, extend, mask, merged, number, register_of, rows_of

TYPES = ("b8", "b16", "b32", "b64", "u8", "s8", "u16", "s16", "u32", "s32", "u64", "s64", "f32", "f64")


# ---- Moves


def moves():
    trials = []
    for kind in ("b16", "b32", "b64", "u16", "s16", "u32", "s32", "u64", "s64", "f32", "f64", "pred"):
        rows = [(row, row) for row in rows_of((kind,), kind)]
        body = f"mov.{kind} %d0, %a0;"
        if kind in ("b32", "b64"):
            half = f"b{WIDTH[kind] // 2}"
            # Splits into elements and joins them the other way round.
            body = f".reg .{half} %x, %y;\nmov.{kind} {{%x, %y}}, %a0;\nmov.{kind} %d0, {{%y, %x}};"
            width = WIDTH[half]
            rows = [((a,), (a >> width | mask(a, half) << width,)) for ((a,), _) in rows]
        trials.append(Trial(f"mov.{kind}", body, (kind,), (kind,), rows))
    return trials


# ---- Loads and stores. The address of each state space is in %m.


def place_of(space):
    """(declarations in the function, instructions that leave the address in %q) for a state space."""
    if space == "local":
        return ".local .align 16 .b8 place[64];\n.reg .b64 %q;", "mov.u64 %q, place;"
    if space == "shared":
        return ".shared .align 16 .b8 place[64];\n.reg .b64 %q;", "mov.u64 %q, place;"
    return ".reg .b64 %q;", "mov.u64 %q, %m;"


def element_register(kind):
    return register_of(kind, wide=True)


def vector_of(names):
    return names[0] if len(names) == 1 else "{" + ", ".join(names) + "}"


def suffix_of(kind, count):
    return f".{kind}" if count == 1 else f".v{count}.{kind}"


def transfer_rows(kind, count):
    """Elements as registers hold them before a store and after a load."""
    register = element_register(kind)
    rows = []
    for row in rows_of((register,) * count, f"{kind}{count}", most=16, randoms=6):
        rows.append((row, tuple(extend(mask(a, kind), kind, register) for a in row)))
    return rows


def load_trial(name, kind, count):
    """Bytes are stored one by one, then loaded."""
    size = WIDTH[kind] // 8
    register = element_register(kind)
    opcode = name + suffix_of(kind, count)
    space = next((s for s in ("local", "shared") if f".{s}" in name), "global")
    declarations, address = place_of(space)
    plain = {"f32": "b32", "f64": "b64"}.get(kind, kind)
    body = [declarations, address]
    body += [f"st.{plain} [%q+{16 + i * size}], %a{i};" for i in range(count)]
    targets = [f"%d{i}" for i in range(count)]
    body.append(f"{opcode} {vector_of(targets)}, [%q+16];")
    return Trial(opcode, "\n".join(body), (register,) * count, (register,) * count, transfer_rows(kind, count))


def const_trial(kind, count):
    """Loads from a constant: its bytes are 0, 1, 2, … and 0xf0 + their position."""
    opcode = "ld.const" + suffix_of(kind, count)
    size = WIDTH[kind] // 8
    stored = bytes(range(16)) + bytes(range(0xF0, 0x100))
    register = element_register(kind)
    name = "constant_" + opcode.replace(".", "_")
    rows = []
    for begin in (0, 16):
        values = [int.from_bytes(stored[begin + i * size : begin + (i + 1) * size], "little") for i in range(count)]
        rows.append(((begin,), tuple(extend(v, kind, register) for v in values)))
    targets = vector_of([f"%d{i}" for i in range(count)])
    body = f".reg .b64 %q;\nmov.u64 %q, {name};\nadd.u64 %q, %q, %a0;\n{opcode} {targets}, [%q];"
    declaration = f".const .align 16 .b8 {name}[32] = {{{', '.join(map(str, stored))}}};"
    return Trial(opcode, body, ("b64",), (register,) * count, rows, declarations=declaration)


def param_trials(kind, count):
    """A function returns its parameter: st.param and ld.param on both sides of the call."""
    suffix = suffix_of(kind, count)
    register = element_register(kind)
    bytes_ = count * WIDTH[kind] // 8
    size = f".align {bytes_} .b8"
    name = "returns" + suffix.replace(".", "_")
    names = [f"%x{i}" for i in range(count)]
    function = f""".func (.param {size} result[{bytes_}]) {name}(.param {size} given[{bytes_}]) {{
.reg .{register} {', '.join(names)};
ld.param{suffix} {vector_of(names)}, [given];
st.param{suffix} [result], {vector_of(names)};
ret;
}}"""
    body = f"""{{
.param {size} given[{bytes_}];
.param {size} result[{bytes_}];
st.param{suffix} [given+0], {vector_of([f'%a{i}' for i in range(count)])};
call.uni (result), {name}, (given);
ld.param{suffix} {vector_of([f'%d{i}' for i in range(count)])}, [result+0];
}}"""
    rows = transfer_rows(kind, count)
    registers = (register,) * count
    return [Trial(f"ld.param{suffix}", body, registers, registers, rows, declarations=function),
            Trial(f"st.param{suffix}", body, registers, registers, rows)]


def store_trial(name, kind, count):
    """Stored together, then loaded one by one."""
    size = WIDTH[kind] // 8
    register = element_register(kind)
    opcode = name + suffix_of(kind, count)
    space = next((s for s in ("local", "shared") if f".{s}" in name), "global")
    declarations, address = place_of(space)
    sources = vector_of([f"%a{i}" for i in range(count)])
    body = [declarations, address, f"{opcode} [%q+16], {sources};"]
    body += [f"ld.{kind} %d{i}, [%q+{16 + i * size}];" for i in range(count)]
    return Trial(opcode, "\n".join(body), (register,) * count, (register,) * count, transfer_rows(kind, count))


def transfers():
    loads = ["ld" + s for s in ("", ".global", ".local", ".shared", ".global.nc")]
    loads += ["ld.volatile" + s for s in ("", ".global", ".shared")] + ["ldu", "ldu.global"]
    stores = ["st" + s for s in ("", ".global", ".local", ".shared")]
    stores += ["st.volatile" + s for s in ("", ".global", ".shared")]
    trials = []
    for kind, count in product(TYPES, (1, 2, 4)):
        if count * WIDTH[kind] > 128:
            continue
        group = [load_trial(name, kind, count) for name in loads]
        group += [store_trial(name, kind, count) for name in stores]
        trials += [merged(group + param_trials(kind, count)), const_trial(kind, count)]
    return trials


def addresses():
    """An address converted to generic and back loads what was stored."""
    trials = []
    rows = [((a,), (a,)) for a in (0, 1, 0xDEADBEEF)]
    for space in ("global", "local", "shared", "const"):
        declarations, address = place_of(space)
        for direction in ("", "to."):
            opcode = f"cvta.{direction}{space}.u64"
            body = f"{declarations}\n{address}\nst.u32 [%q], %a0;\n{opcode} %q, %q;\nld.u32 %d0, [%q];"
            trials.append(Trial(opcode, body, ("b32",), ("b32",), rows))
    return trials


# ---- Atomic operations: the new value and the old one


def changes(kind):
    signed = lambda f: lambda old, a: mask(f(number(old, kind), number(a, kind)), kind)
    return {
        "add": signed(lambda old, a: old + a),
        "min": signed(min),
        "max": signed(max),
        "inc": lambda old, a: 0 if old >= a else old + 1,
        "dec": lambda old, a: a if old == 0 or old > a else old - 1,
        "and": lambda old, a: old & a,
        "or": lambda old, a: old | a,
        "xor": lambda old, a: old ^ a,
        "exch": lambda old, a: a,
    }


ATOMIC_TYPES = {name: ("u32", "s32", "u64", "s64") for name in ("min", "max")} | {"add": ("u32", "s32", "u64")}
ATOMIC_TYPES |= {"inc": ("u32",), "dec": ("u32",)} | {name: ("b32", "b64") for name in ("and", "or", "xor", "exch")}


def atomic_trial(opcode, space, kind, sources, function):
    """`function`(old, sources…) → new value."""
    declarations, address = place_of(space.strip("."))
    register = register_of(kind)
    returns = opcode.startswith("atom")
    operands = ", ".join((["%d1"] if returns else []) + ["[%q]", *(f"%a{i + 1}" for i in range(sources))])
    body = f"{declarations}\n{address}\nst.{register} [%q], %a0;\n{opcode} {operands};\nld.{register} %d0, [%q];"
    rows = []
    for row in rows_of((kind,) * (1 + sources), opcode, most=128):
        rows.append((row, (function(*row), row[0]) if returns else (function(*row),)))
    return Trial(opcode, body, (register,) * (1 + sources), (register,) * (1 + returns), rows)


def atomics():
    trials = []
    for space, (name, kinds) in product(("", ".global", ".shared"), ATOMIC_TYPES.items()):
        for kind in kinds:
            function = changes(kind)[name]
            trials.append(atomic_trial(f"atom{space}.{name}.{kind}", space, kind, 1, function))
            if name != "exch":
                trials.append(atomic_trial(f"red{space}.{name}.{kind}", space, kind, 1, function))
    for space, kind in product(("", ".global", ".shared"), ("b32", "b64")):
        function = lambda old, expected, new: new if old == expected else old
        trials.append(atomic_trial(f"atom{space}.cas.{kind}", space, kind, 2, function))
    return trials


def trials():
    return moves() + transfers() + addresses() + atomics()
