"""Trials of control flow and of instructions that need several threads."""

from itertools import product

from trial import Trial

WARP = 32
ALL = 0xFFFFFFFF


# ---- Control flow


def control():
    """One result for even inputs, another for odd ones."""
    rows = [((a,), (a * 3 if a % 2 == 0 else a + 1,)) for a in range(8)]
    head = ".reg .pred %odd;\n.reg .b32 %x;\nand.b32 %x, %a0, 1;\nsetp.ne.u32 %odd, %x, 0;\n"
    trials = []
    for suffix in ("", ".uni"):
        body = f"""{head}@%odd bra{suffix} $odd;
mul.lo.u32 %d0, %a0, 3;
bra{suffix} $end;
$odd:
add.u32 %d0, %a0, 1;
$end:"""
        trials.append(Trial(f"bra{suffix}", body, ("b32",), ("b32",), rows))
        trials += calls(suffix, rows)
    ends = [((a,), (0 if a % 2 else a * 3,)) for a in range(8)]
    # Threads that have ended leave their outputs as they were: 0.
    trials.append(Trial("exit", f"{head}@%odd exit;\nmul.lo.u32 %d0, %a0, 3;", ("b32",), ("b32",), ends))
    return trials


def calls(suffix, rows):
    name = "by_parity" + suffix.replace(".", "_")
    function = f""".func (.param .b32 result) {name}(.param .b32 given) {{
.reg .pred %even;
.reg .b32 %a, %x;
ld.param.b32 %a, [given];
and.b32 %x, %a, 1;
setp.eq.u32 %even, %x, 0;
add.u32 %x, %a, 1;
st.param.b32 [result], %x;
@!%even ret{suffix};
mul.lo.u32 %x, %a, 3;
st.param.b32 [result], %x;
ret{suffix};
}}"""
    body = f"""{{
.param .b32 given;
.param .b32 result;
st.param.b32 [given], %a0;
call{suffix} (result), {name}, (given);
ld.param.b32 %d0, [result];
}}"""
    return [Trial(f"call{suffix}", body, ("b32",), ("b32",), rows, declarations=function),
            Trial(f"ret{suffix}", body, ("b32",), ("b32",), rows)]


# ---- Warps: 64 threads, row n belongs to thread n


def warp_rows(threads, given, expected):
    """`given`(n) → inputs; `expected`(n, inputs of all) → outputs."""
    inputs = [given(n) for n in range(threads)]
    return [(inputs[n], expected(n, inputs)) for n in range(threads)]


def shuffle_source(mode, lane, b, c):
    """The pseudo-code of shfl: (lane that is read, predicate)."""
    mask = c >> 8 & 31
    last = (lane & mask) | (c & 31 & ~mask)
    first = lane & mask
    source = {"up": lane - b, "down": lane + b, "bfly": lane ^ b, "idx": first | (b & ~mask & 31)}[mode]
    valid = source >= last if mode == "up" else source <= last
    return (source, 1) if valid else (lane, 0)


def shuffles():
    trials = []
    for mode in ("up", "down", "bfly", "idx"):
        # (distance, clamp): whole warps, segments of 8 and 16, a clamp below the last lane.
        cases = list(product((0, 1, 5, 16, 31), (0 if mode == "up" else 31, 0x1800 | (0 if mode == "up" else 31), 0x1007, 10)))
        body, outputs = "", ()
        for i, (b, c) in enumerate(cases):
            body += f".reg .pred %p{i};\nshfl.sync.{mode}.b32 %d{2 * i}|%p{i}, %a0, {b}, {c:#x}, 0xffffffff;\nselp.b32 %d{2 * i + 1}, 1, 0, %p{i};\n"
            outputs += ("b32", "b32")

        def expected(n, inputs, mode=mode, cases=cases):
            results = ()
            for b, c in cases:
                source, valid = shuffle_source(mode, n % WARP, b, c)
                results += (inputs[n // WARP * WARP + source][0], valid)
            return results

        rows = warp_rows(2 * WARP, lambda n: (n * 2654435761 & ALL,), expected)
        trials.append(Trial(f"shfl.sync.{mode}.b32", body, ("b32",), outputs, rows, threads=2 * WARP))
    return trials


def votes():
    """Of all threads of a warp, and of its upper half among itself. The predicates of three warps: some, all and none."""
    given = lambda n: (int(n % 3 == 0) if n < WARP else int(n < 2 * WARP),)
    results = {
        "all.pred": lambda values: int(all(values)),
        "any.pred": lambda values: int(any(values)),
        "uni.pred": lambda values: int(len(set(values)) == 1),
        "ballot.b32": None,
    }
    trials = []
    for name, function in results.items():
        kind = name.split(".")[1]
        body = f""".reg .pred %upper;
.reg .b32 %x;
mov.u32 %x, %laneid;
setp.ge.u32 %upper, %x, 16;
vote.sync.{name} %d0, %a0, 0xffffffff;
@%upper vote.sync.{name} %d1, %a0, 0xffff0000;
@!%upper vote.sync.{name} %d1, %a0, 0x0000ffff;"""

        def expected(n, inputs, function=function):
            outputs = ()
            warp = n // WARP * WARP
            for first, last in ((0, WARP), (0, 16) if n % WARP < 16 else (16, WARP)):
                values = [inputs[warp + i][0] for i in range(first, last)]
                outputs += (function(values) if function else sum(v << (first + i) for i, v in enumerate(values)),)
            return outputs

        rows = warp_rows(3 * WARP, given, expected)
        trials.append(Trial(f"vote.sync.{name}", body, ("pred",), (kind, kind), rows, threads=3 * WARP))
    return trials


# ---- Barriers: each thread reads what its neighbour wrote


def barriers():
    trials = []
    for name, threads in (("bar.sync", 96), ("barrier.sync", 96), ("bar.warp.sync", WARP)):
        operand = "0xffffffff" if "warp" in name else "0"
        body = f""".shared .align 4 .b8 place[{4 * threads}];
.reg .b64 %q;
.reg .b32 %x;
mov.u64 %q, place;
mad.wide.u32 %q, %n, 4, %q;
st.shared.b32 [%q], %a0;
{name} {operand};
add.u32 %x, %n, 1;
rem.u32 %x, %x, {threads};
mov.u64 %q, place;
mad.wide.u32 %q, %x, 4, %q;
ld.shared.b32 %d0, [%q];"""
        rows = warp_rows(threads, lambda n: (n * 40503,), lambda n, inputs, t=threads: inputs[(n + 1) % t])
        trials.append(Trial(name, body, ("b32",), ("b32",), rows, threads=threads))
    return trials


def fences():
    """Only whether they run: threads of a block run one after the other."""
    names = [f"membar.{s}" for s in ("cta", "gl", "sys")] + [f"fence.{o}.{s}" for o, s in product(("sc", "acq_rel"), ("cta", "gpu", "sys"))]
    return [Trial(name, f"{name};\nmov.b32 %d0, %a0;", ("b32",), ("b32",), [((7,), (7,))]) for name in names]


def trials():
    return control() + shuffles() + votes() + barriers() + fences()
