"""Names of PTX as names of C++, and the scopes that declare them."""

import re

from errors import PtxError
from parser import SIZES


def cpp_name(prefix, name):
    """Different names stay different: every character that C++ lacks has its own escape."""
    return prefix + re.sub(r"[^A-Za-z0-9]", lambda m: {"_": "__", "%": "_p", "$": "_s", ".": "_d"}[m[0]], name)


def function_name(function):
    """External functions are ptx_NAME, so that others can define them in C++."""
    return cpp_name("f", function.name) if function.body else f"ptx_{function.name}"


def register_type(kind):
    """The C++ type of a register. Registers hold bits: integers are unsigned."""
    integers = {1: "uint8_t", 2: "uint16_t", 4: "uint32_t", 8: "uint64_t"}
    return {"pred": "bool", "f32": "float", "f64": "double"}.get(kind) or integers[SIZES[kind]]


class Scope:
    """Registers and variables of a block; `outer`: those of the blocks around it."""

    def __init__(self, file, outer=None):
        self.file = file
        self.outer = outer
        self.registers = {}  # name -> type
        self.variables = {}  # name -> (space, C++ expression of its address)

    def declare_register(self, line, name, kind):
        self.check_new(line, name)
        self.registers[name] = kind

    def declare_variable(self, variable, expression):
        self.check_new(variable.line, variable.name)
        self.variables[variable.name] = (variable.space, expression)

    def check_new(self, line, name):
        if name in self.registers or name in self.variables:
            raise PtxError(self.file, line, f"'{name}' is declared twice")

    def find(self, table, name):
        scope = self
        while scope is not None:
            if name in getattr(scope, table):
                return getattr(scope, table)[name]
            scope = scope.outer
        return None

    def register(self, name):
        """The type of a register, or None."""
        return self.find("registers", name)

    def variable(self, name):
        """(state space, C++ expression of the address), or None."""
        return self.find("variables", name)


def fits(register, kind, wide):
    """Whether an operand of an instruction's type may be a register of a declared type (ISA 9.4). `wide`: the register
    may be wider, as for cvt, ld and st."""
    if "pred" in (register, kind):
        return register == kind
    if SIZES[register] == SIZES[kind]:
        return register[0] == kind[0] or "b" in (register[0], kind[0]) or "f" not in (register[0], kind[0])
    return wide and SIZES[register] > SIZES[kind] and register[0] != "f" and kind[0] != "f"
