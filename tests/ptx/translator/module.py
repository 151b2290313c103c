"""A PTX module as data. parser.py makes it from text."""

from dataclasses import dataclass, field

# ---- Operands


@dataclass(frozen=True)
class Name:
    """A register, a variable, a function, a label or a special register."""

    text: str


@dataclass(frozen=True)
class Integer:
    value: int


@dataclass(frozen=True)
class Real:
    """A floating-point constant of `width` bits."""

    bits: int
    width: int


@dataclass(frozen=True)
class Negated:
    """A predicate, negated."""

    name: Name


@dataclass(frozen=True)
class Address:
    base: object  # Name or Integer
    offset: int


@dataclass(frozen=True)
class Vector:
    elements: tuple


@dataclass(frozen=True)
class Pair:
    """Two destinations: `value|predicate`."""

    first: Name
    second: Name


@dataclass(frozen=True)
class Arguments:
    """A list in parentheses, of a call."""

    names: tuple


# ---- Statements of a function


@dataclass(frozen=True)
class Instruction:
    line: int
    opcode: str
    operands: tuple
    guard: object = None  # Name or Negated: runs only where this predicate is true


@dataclass(frozen=True)
class Label:
    line: int
    name: str


@dataclass(frozen=True)
class Registers:
    line: int
    type: str
    names: tuple


@dataclass
class Block:
    line: int
    statements: list = field(default_factory=list)


# ---- The module


@dataclass
class Variable:
    """A variable or parameter in a state space. `initial`: its bytes, or None."""

    line: int
    space: str
    type: str
    name: str
    size: int  # bytes
    alignment: int
    initial: bytes | None = None
    external: bool = False


@dataclass
class Function:
    line: int
    name: str
    entry: bool
    results: list
    parameters: list
    body: Block | None = None


@dataclass
class Module:
    file: str
    version: str = ""
    target: str = ""
    variables: list = field(default_factory=list)
    functions: list = field(default_factory=list)
