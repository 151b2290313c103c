"""Operands of PTX as C++ expressions, with the checks of their types."""

from errors import PtxError
from forms import CPP, SPECIAL
from module import Address, Integer, Name, Negated, Real
from names import cpp_name, fits, register_type
from parser import SIZES


class Operands:
    """Expressions for the operands of one instruction."""

    def __init__(self, file, scope, instruction):
        self.file = file
        self.scope = scope
        self.instruction = instruction

    def fail(self, message):
        raise PtxError(self.file, self.instruction.line, f"'{self.instruction.opcode}': {message}")

    def check_count(self, *counts):
        found = len(self.instruction.operands)
        if found not in counts:
            self.fail(f"{found} operands; expected {' or '.join(map(str, counts))}")

    def register(self, operand, kind, wide=False):
        """The C++ name of a register for values of type `kind`."""
        declared = self.scope.register(operand.text) if isinstance(operand, Name) else None
        if declared is None:
            self.fail(f"{describe(operand)} is not a register")
        if not fits(declared, kind, wide):
            self.fail(f"the register {operand.text} has the type .{declared}; expected .{kind}")
        return cpp_name("r", operand.text)

    def holds(self, operand, kind):
        """Whether the C++ type of a register is that of `kind`."""
        return register_type(self.scope.register(operand.text)) == CPP[kind]

    def predicate(self, operand):
        if isinstance(operand, Negated):
            return f"!{self.register(operand.name, 'pred')}"
        return self.register(operand, "pred")

    def source(self, operand, kind, wide=False):
        """The value of an operand as the C++ type of `kind`."""
        if isinstance(operand, Integer):
            return self.integer(operand.value, kind)
        if isinstance(operand, Real):
            return self.real(operand, kind)
        if isinstance(operand, Negated) and kind == "pred":
            return f"!{self.register(operand.name, 'pred')}"
        if isinstance(operand, Name) and self.scope.register(operand.text) is None:
            return self.symbol(operand.text, kind)
        if isinstance(operand, Address) and kind[1:] == "64":
            return f"get<{CPP[kind]}>({self.address(operand)})"
        name = self.register(operand, kind, wide)
        return name if self.holds(operand, kind) else f"get<{CPP[kind]}>({name})"

    def integer(self, value, kind):
        if kind == "pred":
            return "true" if value else "false"
        if kind[0] == "f":
            self.fail(f"the integer {value} is not a value of type .{kind}")
        return f"{CPP[kind]}({value & ((1 << 8 * SIZES[kind]) - 1):#x}u)"

    def real(self, operand, kind):
        if kind not in ("f32", "b32", "f64", "b64") or 8 * SIZES[kind] != operand.width:
            self.fail(f"a constant of {operand.width} bits is not a value of type .{kind}")
        return f"from_bits<{CPP[kind]}>({operand.bits:#x}u)"

    def symbol(self, name, kind):
        if name in SPECIAL:
            declared, expression = SPECIAL[name]
            if not fits(declared, kind, wide=False):
                self.fail(f"{name} has the type .{declared}; expected .{kind}")
            return f"{CPP[kind]}({expression})"
        if self.scope.variable(name) is None:
            self.fail(f"'{name}' is unknown")
        if kind not in ("u64", "b64", "s64"):
            self.fail(f"the address of '{name}' is not a value of type .{kind}")
        return f"get<{CPP[kind]}>({self.scope.variable(name)[1]})"

    def address(self, operand):
        """The address in memory, as a pointer to bytes."""
        if not isinstance(operand, Address) or not isinstance(operand.base, Name):
            self.fail(f"{describe(operand)} is not an address")
        variable = self.scope.variable(operand.base.text)
        if variable is not None:
            return f"{variable[1]} + {operand.offset}"
        return f"pointer({self.register(operand.base, 'u64')}, {operand.offset})"


def describe(operand):
    if isinstance(operand, Name):
        return f"'{operand.text}'"
    kind = type(operand).__name__.lower()
    return f"{'an' if kind[0] in 'aei' else 'a'} {kind}"
