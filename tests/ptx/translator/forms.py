"""The instructions that the translator knows: every opcode with its modifiers and types, and the C++ function that computes it
(tests/ptx/instructions). What is not in FORMS is an error. The sections are those of the PTX ISA, chapter 9.7."""

from dataclasses import dataclass
from itertools import product

from parser import SIZES

# PTX type -> C++ type. Bits without a type are unsigned.
CPP = {f"{kind}{bits}": f"{'' if kind == 's' else 'u'}int{bits}_t" for kind in "bus" for bits in (8, 16, 32, 64)}
CPP |= {"f32": "float", "f64": "double", "pred": "bool"}

INTEGERS = ("u16", "s16", "u32", "s32", "u64", "s64")
ALL_INTEGERS = ("u8", "s8", *INTEGERS)
BITS = ("b16", "b32", "b64")
REALS = ("f32", "f64")
WIDER = {"u16": "u32", "s16": "s32", "u32": "u64", "s32": "s64"}


@dataclass(frozen=True)
class Form:
    """An instruction that computes `function(sources…)`, or one that emitter.py treats by its `kind`."""

    function: str = ""
    result: str | None = None
    sources: tuple = ()
    wide: bool = False  # registers may be wider than the types
    kind: str = "plain"
    vector: int = 1  # elements that a load or store moves
    cooperative: bool = False  # needs the other threads of the block


def arithmetic():
    """9.7.1 integer and 9.7.2 extended integer instructions."""
    forms = {}
    for t, c in ((t, CPP[t]) for t in INTEGERS):
        for name in ("add", "sub", "mul.lo", "mul.hi", "div", "rem", "min", "max"):
            forms[f"{name}.{t}"] = Form(f"{name.replace('.', '_')}<{c}>", t, (t, t))
        for name in ("mad.lo", "mad.hi"):
            forms[f"{name}.{t}"] = Form(f"{name.replace('.', '_')}<{c}>", t, (t, t, t))
        forms[f"sad.{t}"] = Form(f"sad<{c}>", t, (t, t, t))
        if t in WIDER:
            forms[f"mul.wide.{t}"] = Form(f"mul_wide<{c}>", WIDER[t], (t, t))
            forms[f"mad.wide.{t}"] = Form(f"mad_wide<{c}>", WIDER[t], (t, t, WIDER[t]))
        if t[0] == "s":
            forms[f"abs.{t}"] = Form(f"abs<{c}>", t, (t,))
            forms[f"neg.{t}"] = Form(f"neg<{c}>", t, (t,))
    for t in ("b32", "b64"):
        for name in ("popc", "clz"):
            forms[f"{name}.{t}"] = Form(f"{name}<{CPP[t]}>", "u32", (t,))
        forms[f"brev.{t}"] = Form(f"brev<{CPP[t]}>", t, (t,))
        forms[f"bfi.{t}"] = Form(f"bfi<{CPP[t]}>", t, (t, t, "u32", "u32"))
    for t in INTEGERS[2:]:
        forms[f"bfind.{t}"] = Form(f"bfind<{CPP[t]}>", "u32", (t,))
        forms[f"bfind.shiftamt.{t}"] = Form(f"bfind_shiftamt<{CPP[t]}>", "u32", (t,))
        forms[f"bfe.{t}"] = Form(f"bfe<{CPP[t]}>", t, (t, "u32", "u32"))
    return forms


def logic():
    """9.7.8 logic and shift instructions, and prmt of 9.7.9."""
    forms = {}
    for t in ("pred", *BITS):
        for name in ("and", "or", "xor"):
            forms[f"{name}.{t}"] = Form(f"{name}_<{CPP[t]}>", t, (t, t))
        forms[f"not.{t}"] = Form(f"not_<{CPP[t]}>", t, (t,))
    for t in BITS:
        forms[f"cnot.{t}"] = Form(f"cnot<{CPP[t]}>", t, (t,))
        forms[f"shl.{t}"] = Form(f"shl<{CPP[t]}>", t, (t, "u32"))
    for t in (*BITS, *INTEGERS):
        forms[f"shr.{t}"] = Form(f"shr<{CPP[t]}>", t, (t, "u32"))
    for side, mode in product("lr", ("wrap", "clamp")):
        forms[f"shf.{side}.{mode}.b32"] = Form(f"shf_{side}_{mode}", "b32", ("b32", "b32", "u32"))
    forms["lop3.b32"] = Form("lop3", "b32", ("b32", "b32", "b32", "u32"))
    forms["prmt.b32"] = Form("prmt", "b32", ("b32", "b32", "b32"))
    return forms


def real_arithmetic():
    """9.7.3 floating point. Operations that round must say .rn: without it, the driver may fuse them."""
    forms = {}
    for t, c in ((t, CPP[t]) for t in REALS):
        for name, count in {"add": 2, "sub": 2, "mul": 2, "div": 2, "fma": 3, "sqrt": 1, "rcp": 1}.items():
            forms[f"{name}.rn.{t}"] = Form(f"{name}_rn<{c}>", t, (t,) * count)
        for name, count in {"abs": 1, "neg": 1, "min": 2, "max": 2, "copysign": 2}.items():
            forms[f"{name}.{t}"] = Form(f"{name}<{c}>", t, (t,) * count)
        for name in ("finite", "infinite", "number", "notanumber", "normal", "subnormal"):
            forms[f"testp.{name}.{t}"] = Form(f"testp_{name}<{c}>", "pred", (t,))
    return forms


def comparisons_of(t):
    if t[0] == "b":
        return ("eq", "ne")
    ordered = ("eq", "ne", "lt", "le", "gt", "ge")
    if t[0] == "f":
        return (*ordered, "equ", "neu", "ltu", "leu", "gtu", "geu", "num", "nan")
    return (*ordered, "lo", "ls", "hi", "hs") if t[0] == "u" else ordered


def comparison():
    """9.7.6 comparison and selection."""
    forms = {}
    for t in (*BITS, *INTEGERS, *REALS):
        for name in comparisons_of(t):
            forms[f"setp.{name}.{t}"] = Form(f"setp_{name}<{CPP[t]}>", "pred", (t, t))
            for d in ("u32", "s32", "f32"):
                forms[f"set.{name}.{d}.{t}"] = Form(f"set_<{CPP[d]}, setp_{name}<{CPP[t]}>>", d, (t, t))
        forms[f"selp.{t}"] = Form(f"selp<{CPP[t]}>", t, (t, t, "pred"))
    return forms


def conversion():
    """cvt and cvta of 9.7.9."""
    forms = {}

    def cvt(modes, to, source):
        for mode, d, s in product(modes, to, source):
            name = f"cvt.{mode}.{d}.{s}".replace("..", ".")
            forms[name] = Form(f"{'_'.join(filter(None, ('cvt', mode)))}<{CPP[d]}, {CPP[s]}>", d, (s,), wide=True)

    real_modes = ("rn", "rz", "rm", "rp")
    integer_modes = ("rni", "rzi", "rmi", "rpi")
    cvt(("",), ALL_INTEGERS, ALL_INTEGERS)
    cvt(real_modes, REALS, ALL_INTEGERS)
    cvt(integer_modes, ALL_INTEGERS, REALS)
    cvt(("",), ("f64",), ("f32",))
    cvt(real_modes, ("f32",), ("f64",))
    for t in REALS:
        cvt(integer_modes, (t,), (t,))
    for space, to in product(("global", "local", "shared", "const"), ("", "to.")):
        forms[f"cvta.{to}{space}.u64"] = Form("cvta", "u64", ("u64",))
    return forms


def movement():
    """mov, ld, ldu and st of 9.7.9."""
    forms = {}
    for t in (*BITS, *INTEGERS, *REALS, "pred"):
        forms[f"mov.{t}"] = Form(result=t, sources=(t,), kind="mov")
    loads = ["ld" + s for s in ("", ".global", ".local", ".shared", ".const", ".param", ".global.nc")]
    loads += ["ld.volatile" + s for s in ("", ".global", ".shared")] + ["ldu", "ldu.global"]
    stores = ["st" + s for s in ("", ".global", ".local", ".shared", ".param")]
    stores += ["st.volatile" + s for s in ("", ".global", ".shared")]
    types = ("b8", *BITS, *ALL_INTEGERS, *REALS)
    for t, vector in product(types, (1, 2, 4)):
        if vector * SIZES[t] > 16:
            continue
        suffix = f".v{vector}.{t}" if vector > 1 else f".{t}"
        for name in loads:
            function = "load_volatile" if "volatile" in name else "load"
            forms[name + suffix] = Form(f"{function}<{CPP[t]}>", t, wide=True, kind="load", vector=vector)
        for name in stores:
            function = "store_volatile" if "volatile" in name else "store"
            forms[name + suffix] = Form(f"{function}<{CPP[t]}>", None, (t,), wide=True, kind="store", vector=vector)
    return forms


def atomics():
    """atom and red of 9.7.13."""
    forms = {}
    types = {"add": ("u32", "s32", "u64"), "min": INTEGERS[2:], "max": INTEGERS[2:], "inc": ("u32",), "dec": ("u32",)}
    types |= {name: ("b32", "b64") for name in ("and", "or", "xor", "exch", "cas")}
    for space, (name, names) in product(("", ".global", ".shared"), types.items()):
        for t in names:
            sources = (t, t) if name == "cas" else (t,)
            function = f"atom_{name}<{CPP[t]}>"
            forms[f"atom{space}.{name}.{t}"] = Form(function, t, sources, kind="atom")
            if name not in ("exch", "cas"):
                forms[f"red{space}.{name}.{t}"] = Form(function, None, sources, kind="atom")
    return forms


def control():
    """9.7.12 control flow, 9.7.13 synchronisation and 9.7.19 miscellaneous instructions."""
    forms = {}
    for suffix in ("", ".uni"):
        forms["bra" + suffix] = Form(kind="branch")
        forms["call" + suffix] = Form(kind="call")
        forms["ret" + suffix] = Form("return", kind="end")
    for name in ("exit", "trap", "brkpt"):
        forms[name] = Form(f"{name}_thread()", kind="end")
    for name in ("bar.sync", "barrier.sync"):
        forms[name] = Form("bar_sync", kind="barrier", cooperative=True)
    forms["bar.warp.sync"] = Form("bar_warp_sync", None, ("b32",), cooperative=True)
    for scope in ("cta", "gl", "sys"):
        forms[f"membar.{scope}"] = Form("fence")
    for order, scope in product(("sc", "acq_rel"), ("cta", "gpu", "sys")):
        forms[f"fence.{order}.{scope}"] = Form("fence")
    for mode in ("up", "down", "bfly", "idx"):
        forms[f"shfl.sync.{mode}.b32"] = Form(f"shfl_sync_{mode}", "b32", ("b32",) * 4, kind="shuffle", cooperative=True)
    for mode in ("all", "any", "uni"):
        forms[f"vote.sync.{mode}.pred"] = Form(f"vote_sync_{mode}", "pred", ("pred", "b32"), cooperative=True)
    forms["vote.sync.ballot.b32"] = Form("vote_sync_ballot", "b32", ("pred", "b32"), cooperative=True)
    return forms


FORMS = arithmetic() | logic() | real_arithmetic() | comparison() | conversion() | movement() | atomics() | control()

# Special register -> (type, C++ expression).
SPECIAL = {f"%{name}.{axis}": ("u32", f"special().{name}.{axis}") for name, axis in product(("tid", "ntid", "ctaid", "nctaid"), "xyz")}
SPECIAL |= {f"%{name}": ("u32", f"{name}()") for name in ("laneid", "warpid")}
SPECIAL |= {f"%lanemask_{name}": ("u32", f"lanemask_{name}()") for name in ("eq", "lt", "le", "gt", "ge")}
SPECIAL["WARP_SZ"] = ("u32", "kWarpSize")
