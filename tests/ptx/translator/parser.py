"""Parses the subset of PTX that clang writes: PTX ISA, chapters 4 (syntax), 5 (state spaces), 7 (functions) and 11
(directives)."""

import gc
import re

from errors import PtxError
from module import (Address, Arguments, Block, Function, Instruction, Integer, Label, Module, Name, Negated, Pair, Real, Registers,
                    Variable, Vector)
from tokens import tokens

# Type -> bytes. Predicates have no size in memory.
SIZES = {f"{kind}{bits}": bits // 8 for kind in "bus" for bits in (8, 16, 32, 64)} | {"f32": 4, "f64": 8, "pred": 0}

SPACES = ("global", "const", "shared", "local", "param")
LINKAGE = (".visible", ".extern", ".weak", ".common")
# Directives of a function that limit what the driver's compiler chooses. They do not change results.
TUNING = (".maxntid", ".reqntid", ".minnctapersm", ".maxnreg", ".noreturn")


class Parser:
    def __init__(self, text, file):
        self.file = file
        self.tokens = tokens(text, file)
        self.position = 0

    # ---- Tokens

    def peek(self, ahead=0):
        return self.tokens[min(self.position + ahead, len(self.tokens) - 1)]

    def next(self):
        token = self.peek()
        self.position += 1
        return token

    def fail(self, message, token=None):
        raise PtxError(self.file, (token or self.peek()).line, message)

    def accept(self, text):
        if self.peek().text != text:
            return False
        self.position += 1
        return True

    def expect(self, text):
        if not self.accept(text):
            self.fail(f"expected '{text}', not '{self.peek().text}'")

    def word(self, what):
        token = self.next()
        if token.kind != "word":
            self.fail(f"expected {what}, not '{token.text}'", token)
        return token.text

    def integer(self):
        negative = self.accept("-")
        token = self.next()
        if token.kind != "number":
            self.fail(f"expected an integer, not '{token.text}'", token)
        text = token.text.rstrip("U")
        # A leading zero makes a number octal.
        value = int(text, 16 if text[:2] in ("0x", "0X") else 8 if len(text) > 1 and text[0] == "0" else 10)
        return -value if negative else value

    # ---- Module

    def module(self):
        module = Module(self.file)
        while self.peek().kind != "end":
            token = self.peek()
            if self.accept(".version"):
                module.version = self.until_line_ends(token.line)
            elif self.accept(".target"):
                module.target = self.until_line_ends(token.line)
            elif self.accept(".address_size"):
                if self.integer() != 64:
                    self.fail("only 64-bit addresses are known", token)
            elif self.accept(".file"):
                self.until_line_ends(token.line)
            elif self.accept(".section"):
                self.skip_section()
            else:
                self.declaration(module)
        return module

    def until_line_ends(self, line):
        text = []
        while self.peek().kind != "end" and self.peek().line == line:
            text.append(self.next().text)
        return "".join(text)

    def skip_section(self):
        """Debug information."""
        self.word("a section")
        while not self.accept("{"):
            self.next()
        while not self.accept("}"):
            if self.next().kind == "end":
                self.fail("a section does not end")

    def declaration(self, module):
        token = self.peek()
        linkage = set()
        while self.peek().text in LINKAGE:
            linkage.add(self.next().text)
        if self.peek().text in (".func", ".entry"):
            module.functions.append(self.function(".extern" in linkage))
        elif self.peek().text[1:] in SPACES:
            module.variables.append(self.variable(".extern" in linkage))
            self.expect(";")
        else:
            self.fail(f"directive '{self.peek().text}' is unknown", token)

    # ---- Variables

    def variable(self, external=False):
        line = self.peek().line
        space = self.word("a state space")[1:]
        alignment = self.integer() if self.accept(".align") else None
        kind = self.word("a type")[1:]
        if SIZES.get(kind, 0) == 0:
            self.fail(f"type '.{kind}' is unknown")
        if self.accept(".ptr"):
            self.fail("attributes of pointers are unknown")
        name = self.word("a name")
        count = 1
        while self.accept("["):
            count *= 0 if self.peek().text == "]" else self.integer()
            self.expect("]")
        result = Variable(line, space, kind, name, count * SIZES[kind], alignment or SIZES[kind], external=external)
        if self.accept("="):
            result.initial = self.initializer(kind, result.size)
        return result

    def initializer(self, kind, size):
        values = []
        if self.accept("{"):
            while not self.accept("}"):
                values.append(self.initial_value(kind))
                if self.peek().text != "}":
                    self.expect(",")
        else:
            values.append(self.initial_value(kind))
        return b"".join(values).ljust(size, b"\0")

    def initial_value(self, kind):
        width = SIZES[kind]
        if self.peek().kind == "float":
            value = self.real().bits
        elif self.peek().kind == "word":
            return self.fail("addresses in initial values are unknown")
        else:
            value = self.integer()
        return (value & ((1 << 8 * width) - 1)).to_bytes(width, "little")

    def real(self):
        text = self.next().text
        return Real(int(text[2:], 16), 4 * len(text[2:]))

    # ---- Functions

    def function(self, external):
        line = self.peek().line
        entry = self.word("a function") == ".entry"
        results = self.parameters() if self.peek().text == "(" else []
        name = self.word("a name")
        result = Function(line, name, entry, results, self.parameters() if self.peek().text == "(" else [])
        while self.peek().text in TUNING:
            self.next()
            while self.peek().kind == "number" or self.peek().text == ",":
                self.next()
        if not self.accept(";"):
            if external:
                self.fail("an external function has no body")
            result.body = self.block(result.name)
        return result

    def parameters(self):
        found = []
        self.expect("(")
        while not self.accept(")"):
            if self.peek().text != ".param":
                self.fail(f"expected a parameter in the space .param, not '{self.peek().text}'")
            found.append(self.variable())
            if self.peek().text != ")":
                self.expect(",")
        return found

    def block(self, function):
        result = Block(self.peek().line)
        self.expect("{")
        while not self.accept("}"):
            if self.peek().kind == "end":
                self.fail(f"the body of '{function}' does not end")
            result.statements += self.statement(function)
        return result

    def statement(self, function):
        """The statements up to the next semicolon, brace or colon; none for directives that have no effect."""
        token = self.peek()
        if token.text == "{":
            return [self.block(function)]
        if self.accept(".loc"):
            self.until_line_ends(token.line)
            return []
        if self.accept(".pragma"):
            while not self.accept(";"):
                self.next()
            return []
        if self.accept(";"):
            return []
        if token.text == ".reg":
            return [self.registers()]
        if token.text[1:] in SPACES and token.text[0] == ".":
            variable = self.variable()
            self.expect(";")
            return [variable]
        if token.kind == "word" and self.peek(1).text == ":":
            self.position += 2
            return [Label(token.line, token.text)]
        return [self.instruction()]

    def registers(self):
        line = self.next().line
        kind = self.word("a type")[1:]
        if kind not in SIZES:
            self.fail(f"type '.{kind}' is unknown")
        names = []
        while True:
            name = self.word("a register")
            if self.accept("<"):
                names += [f"{name}{i}" for i in range(self.integer())]
                self.expect(">")
            else:
                names.append(name)
            if self.accept(";"):
                return Registers(line, kind, tuple(names))
            self.expect(",")

    # ---- Instructions

    def instruction(self):
        line = self.peek().line
        guard = None
        if self.accept("@"):
            negated = self.accept("!")
            name = Name(self.word("a predicate"))
            guard = Negated(name) if negated else name
        token = self.peek()
        opcode = self.word("an instruction")
        if not re.fullmatch(r"[a-z][\w.:]*", opcode):
            self.fail(f"expected an instruction, not '{opcode}'", token)
        operands = []
        while not self.accept(";"):
            if operands:
                self.expect(",")
            operands.append(self.operand())
        return Instruction(line, opcode, tuple(operands), guard)

    def operand(self):
        token = self.peek()
        if token.text == "[":
            return self.address()
        if token.text == "{":
            return Vector(self.list_until("}"))
        if token.text == "(":
            return Arguments(self.list_until(")"))
        if token.text == "!":
            self.next()
            return Negated(Name(self.word("a predicate")))
        if token.kind == "float":
            return self.real()
        if token.kind == "number" or token.text == "-":
            return Integer(self.integer())
        name = Name(self.word("an operand"))
        if self.accept("|"):
            return Pair(name, Name(self.word("a predicate")))
        if self.peek().text in "+-":
            return Address(name, self.offset())
        return name

    def list_until(self, end):
        self.next()
        found = []
        while not self.accept(end):
            found.append(self.operand())
            if self.peek().text != end:
                self.expect(",")
        return tuple(found)

    def address(self):
        self.expect("[")
        token = self.peek()
        base = Name(self.word("an address")) if token.kind == "word" else Integer(self.integer())
        offset = self.offset() if self.peek().text in "+-" else 0
        self.expect("]")
        return Address(base, offset)

    def offset(self):
        self.accept("+")
        return self.integer()


def parse(text, file):
    """The module in `text`. Raises PtxError with `file` and the line."""
    collects = gc.isenabled()
    gc.disable()  # the tokens and the module have no cycles, but collections would visit their millions of objects
    try:
        return Parser(text, file).module()
    finally:
        if collects:
            gc.enable()
