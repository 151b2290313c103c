#!/usr/bin/env python3
"""The translator of PTX: unknown instructions are errors with file and line, and known ones become the right C++."""

import pathlib
import subprocess
import sys
import tempfile
import unittest

FOLDER = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(FOLDER / "translator"))

from emitter import external_functions, opcode_counts, translate, translate_parts
from errors import PtxError
from forms import FORMS
from names import cpp_name, fits
from parser import parse
from tokens import tokens

HEAD = ".version 6.3\n.target sm_75\n.address_size 64\n"
DECLARATIONS = """.reg .pred %p<2>;
.reg .b16 %h<2>;
.reg .b32 %r<3>;
.reg .f32 %f<3>;
.reg .f64 %d<2>;
.reg .b64 %q<2>;
.reg .u32 %u;
"""
FIRST_LINE = HEAD.count("\n") + 2 + DECLARATIONS.count("\n") + 1  # of a body


def kernel(body):
    return f"{HEAD}.visible .entry k(.param .u64 a)\n{{\n{DECLARATIONS}{body}\n}}\n"


def translated(text):
    return translate(parse(text, "k.ptx"), "module")


class Rejections(unittest.TestCase):
    def check(self, text, line, message):
        with self.assertRaises(PtxError) as raised:
            translated(text)
        self.assertEqual(str(raised.exception), f"k.ptx:{line}: {message}")

    def check_body(self, body, message):
        self.check(kernel(body), FIRST_LINE, message)

    def test_instructions_modifiers_and_types(self):
        for body, opcode in (
            ("mystery.b32 %r0, %r1;", "mystery.b32"),
            ("add %r0, %r1, %r2;", "add"),
            ("add.u8 %r0, %r1, %r2;", "add.u8"),
            ("add.sat.s32 %r0, %r1, %r2;", "add.sat.s32"),
            ("add.cc.u32 %r0, %r1, %r2;", "add.cc.u32"),
            ("add.rz.f32 %f0, %f1, %f2;", "add.rz.f32"),
            ("add.rn.f16 %h0, %h1, %h1;", "add.rn.f16"),
            ("cvt.sat.u8.s32 %r0, %r1;", "cvt.sat.u8.s32"),
            ("ld.global.cg.u32 %r0, [%q0];", "ld.global.cg.u32"),
            ("ld.v4.u64 {%q0, %q1, %q0, %q1}, [%q0];", "ld.v4.u64"),
            ("ld.tex.u32 %r0, [%q0];", "ld.tex.u32"),
            ("atom.add.f32 %f0, [%q0], %f1;", "atom.add.f32"),
            ("shfl.idx.b32 %r0, %r1, 0, 31;", "shfl.idx.b32"),
            ("activemask.b32 %r0;", "activemask.b32"),
            ("setp.lt.and.s32 %p0, %r1, %r2, %p1;", "setp.lt.and.s32"),
        ):
            self.check_body(body, f"instruction '{opcode}' is unknown")

    def test_floating_point_whose_result_the_driver_chooses(self):
        fused = "without .rn, the driver may fuse it with others"
        self.check_body("add.f32 %f0, %f1, %f2;", f"instruction 'add.f32' is unknown: {fused}")
        self.check_body("mul.f64 %d0, %d1, %d1;", f"instruction 'mul.f64' is unknown: {fused}")
        flushed = "denormal numbers are not flushed"
        self.check_body("add.rn.ftz.f32 %f0, %f1, %f2;", f"instruction 'add.rn.ftz.f32' is unknown: {flushed}")
        self.check_body("abs.ftz.f32 %f0, %f1;", f"instruction 'abs.ftz.f32' is unknown: {flushed}")
        approximate = "approximations differ between devices"
        for opcode in ("sqrt.approx.f32", "div.full.f32", "sin.approx.f32", "ex2.approx.f32"):
            self.check_body(f"{opcode} %f0, %f1;", f"instruction '{opcode}' is unknown: {approximate}")

    def test_operands(self):
        for body, message in (
            ("add.s32 %r0, %r1;", "2 operands; expected 3"),
            ("add.s32 %r0, %r1, %r7;", "'%r7' is unknown"),
            ("add.s32 %r7, %r1, %r1;", "'%r7' is not a register"),
            ("add.s32 5, %r1, %r1;", "an integer is not a register"),
            ("add.s32 %r0, %r1, %q0;", "the register %q0 has the type .b64; expected .s32"),
            ("add.s32 %u, %r1, %f0;", "the register %f0 has the type .f32; expected .s32"),
            ("add.rn.f32 %f0, %f1, %u;", "the register %u has the type .u32; expected .f32"),
            ("add.rn.f32 %f0, %f1, 1;", "the integer 1 is not a value of type .f32"),
            ("add.rn.f32 %f0, %f1, 0d3FF0000000000000;", "a constant of 64 bits is not a value of type .f32"),
            ("selp.b32 %r0, %r1, %r2, %r1;", "the register %r1 has the type .b32; expected .pred"),
            ("mov.u32 %r0, %clock;", "'%clock' is unknown"),
            ("mov.u64 %q0, %tid.x;", "%tid.x has the type .u32; expected .u64"),
            ("mov.u32 %r0, a;", "the address of 'a' is not a value of type .u32"),
            ("mov.b64 {%r0, %r1, %r2}, %q0;", "a vector of 3 elements is not packed into .b64"),
            ("ld.global.u32 %r0, %q0;", "'%q0' is not an address"),
            ("ld.global.u32 %r0, [4];", "an address is not an address"),
            ("ld.global.v2.u32 %r0, [%q0];", "1 elements; expected 2"),
            ("ld.global.f32 %d0, [%q0];", "the register %d0 has the type .f64; expected .f32"),
            ("st.global.u64 [%q0], %r0;", "the register %r0 has the type .b32; expected .u64"),
            ("call nothing;", "only functions are called, by their names"),
            ("call (%r0), k, (%q0);", "'k' has 0 results and 1 parameters"),
            ("call k, (%q0);", "arguments and results are variables in the space .param"),
        ):
            opcode = body.split()[0]
            self.check_body(body, f"'{opcode}': {message}")

    def test_names(self):
        self.check_body("bra nowhere;", "the label 'nowhere' is unknown")
        self.check_body(".reg .b32 %r0;", "'%r0' is declared twice")
        self.check(HEAD + ".func f(.param .b32 a) { ret; }\n.func f(.param .b32 a) { ret; }\n", 5, "'f' is defined twice")
        self.check(HEAD + ".func f(.param .b32 a);\n.func f() { ret; }\n", 5, "'f' is declared with other parameters in line 4")
        self.check(HEAD + ".extern .const .b32 c;\n", 4, "external variable 'c' has no definition")
        self.check(HEAD + ".local .b32 c;\n", 4, "variables of modules are not in the space .local")

    def test_syntax(self):
        self.check(HEAD + "?", 4, "unexpected character '?'")
        self.check(HEAD + ".texture t;", 4, "directive '.texture' is unknown")
        self.check(HEAD + ".func f() {\nret;\n", 6, "the body of 'f' does not end")
        self.check(".address_size 32\n", 1, "only 64-bit addresses are known")
        self.check(HEAD + ".global .b128 x;\n", 4, "type '.b128' is unknown")
        self.check(HEAD + ".global .u64 x = y;\n", 4, "addresses in initial values are unknown")
        self.check_body(".reg .f16 %z;", "type '.f16' is unknown")
        self.check_body("$l: .branchtargets $a;", "expected an instruction, not '.branchtargets'")

    def test_the_program_prints_the_error_and_writes_nothing(self):
        with tempfile.TemporaryDirectory() as work:
            source, target = pathlib.Path(work) / "k.ptx", pathlib.Path(work) / "k.cpp"
            source.write_text(kernel("\nmystery.b32 %r0;"), encoding="utf-8")
            run = subprocess.run([sys.executable, FOLDER / "translator/translate.py", source, target], capture_output=True, text=True)
            self.assertEqual(run.returncode, 1)
            self.assertEqual(run.stderr, f"{source}:{FIRST_LINE + 1}: instruction 'mystery.b32' is unknown\n")
            self.assertFalse(target.exists())


class Translation(unittest.TestCase):
    def test_directives_without_effect(self):
        text = kernel('.loc 1 2 3\n.pragma "nounroll";\nret;').replace("{\n", '.maxntid 256, 1, 1\n{\n', 1)
        text = text.replace(HEAD, HEAD + '.file 1 "a.cu"\n') + ".section .debug_info\n{\n.b32 1\n}\n"
        self.assertIn("return;", translated(text))

    def test_comments_and_line_numbers(self):
        found = tokens("// one\n/* two\nlines */ ret;\n", "k.ptx")
        self.assertEqual([(t.text, t.line) for t in found[:-1]], [("ret", 3), (";", 3)])

    def test_numbers(self):
        body = "mov.u32 %r0, 0x10;\nmov.u32 %r0, 010;\nmov.u32 %r0, -1;\nmov.u32 %r0, 4294967295U;\nmov.f32 %f0, 0f3F800000;"
        text = translated(kernel(body))
        for value in ("0x10u", "0x8u", "0xffffffffu", "from_bits<float>(0x3f800000u)"):
            self.assertIn(value, text)

    def test_initial_values(self):
        text = translated(HEAD + ".global .align 4 .b8 t[4] = {1, 2, 255};\n.const .f32 c = 0f3F800000;\n.global .u16 w[2] = {-1};\n")
        self.assertIn("[4] = {1, 2, 255};", text)
        self.assertIn("[4] = {0, 0, 128, 63};", text)
        self.assertIn("[4] = {255, 255};", text)

    def test_guards(self):
        text = translated(kernel("@%p0 add.s32 %r0, %r1, %r2;\n@!%p1 ret;"))
        self.assertIn("if (r_pp0) { set(r_pr0, add<int32_t>(", text)
        self.assertIn("if (!r_pp1) { return; }", text)

    def test_different_names_stay_different(self):
        names = ["$a", "%a", "_a", ".a", "a", "_pa", "__a", "_da", "_sa", "a_", "a$"]
        self.assertEqual(len({cpp_name("r", n) for n in names}), len(names))

    def test_registers_that_fit(self):
        self.assertTrue(fits("b32", "s32", wide=False) and fits("u32", "s32", wide=False) and fits("f32", "b32", wide=False))
        self.assertFalse(fits("f32", "s32", wide=False) or fits("b64", "b32", wide=False) or fits("b32", "pred", wide=False))
        self.assertTrue(fits("b64", "u8", wide=True) and fits("b32", "b16", wide=True))
        self.assertFalse(fits("f64", "b32", wide=True) or fits("b16", "u32", wide=True) or fits("b64", "f32", wide=True))

    def test_entries_that_wait_for_other_threads(self):
        text = HEAD + """.func inner() { bar.sync 0; ret; }
.func outer() { call inner; ret; }
.visible .entry waits() { call outer; ret; }
.visible .entry runs() { ret; }
"""
        result = translated(text)
        self.assertRegex(result, r'\{"waits", .*, true, false\}')
        self.assertRegex(result, r'\{"runs", .*, false, false\}')

    def test_entries_that_use_shared_memory(self):
        text = HEAD + """.shared .align 4 .b8 s[8];
.func inner() { .reg .b32 %r; ld.shared.u32 %r, [s+4]; ret; }
.visible .entry shares() { call inner; ret; }
.visible .entry runs() { ret; }
"""
        result = translated(text)
        self.assertRegex(result, r'\{"shares", .*, false, true\}')
        self.assertRegex(result, r'\{"runs", .*, false, false\}')

    def test_counts_and_externals(self):
        text = HEAD + ".extern .func (.param .b32 r) query(.param .b64 a);\n" + kernel("{ fma.rn.f32 %f0, %f1, %f2, %f0; }\nret;")[len(HEAD):]
        module = parse(text, "k.ptx")
        self.assertEqual(external_functions(module), ["query"])
        self.assertEqual(opcode_counts(module), {"fma.rn.f32": 1, "ret": 1})
        self.assertIn('extern "C" void ptx_query(unsigned char* vr, unsigned char* va);', translate(module, "module"))

    def test_parts_have_each_function_once(self):
        bodies = "".join(f".func f{i}() {{ .reg .b32 %r; {'mov.u32 %r, 1; ' * i}ret; }}\n" for i in range(9))
        text = HEAD + ".const .align 8 .b8 c[16];\n" + bodies + ".visible .entry k() { call f8; ret; }\n"
        files = translate_parts(parse(text, "k.ptx"), "module", 3)
        parts = [f"module_{i}.cpp" for i in range(3)]
        self.assertEqual(sorted(files), ["module.cpp", "module.h", *parts])
        for name in ("ff8", "fk"):
            self.assertEqual(sum(f"void {name}() {{" in files[part] for part in parts), 1, name)
            self.assertIn(f"void {name}();", files["module.h"])
        self.assertIn("alignas(8) extern unsigned char vc[16];", files["module.h"])
        self.assertIn("alignas(8) unsigned char vc[16] = {};", files["module.cpp"])
        self.assertRegex(files["module.cpp"], r'\{"k", .*, false, false\}')
        sizes = [files[part].count("\n") for part in parts]
        self.assertLess(max(sizes), 1.5 * min(sizes))

    def test_what_the_driver_could_change_is_unknown(self):
        self.assertEqual([o for o in FORMS if any(m in o for m in (".ftz", ".approx", ".full", ".sat"))], [])


if __name__ == "__main__":
    unittest.main()
