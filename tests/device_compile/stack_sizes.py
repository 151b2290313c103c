"""Stack that a thread of each entry of a PTX module needs: the .local variables of its functions, along the deepest
chain of calls. Registers that the driver's compiler spills come on top."""

from dataclasses import dataclass

from emitter import instructions_in
from module import Block, Name, Variable


def local_bytes(block):
    """Bytes of the .local variables of a function."""
    size = 0
    for statement in block.statements:
        if isinstance(statement, Block):
            size += local_bytes(statement)
        elif isinstance(statement, Variable) and statement.space == "local":
            size = -(-size // statement.alignment) * statement.alignment + statement.size
    return size


@dataclass(frozen=True)
class Chain:
    """Functions from a caller to the last one called, each with its bytes."""

    frames: tuple = ()

    @property
    def size(self):
        return sum(size for _, size in self.frames)


def target_of(call):
    """The function that a call names."""
    target = next(operand.text for operand in call.operands if isinstance(operand, Name))
    if target.startswith("%"):
        raise ValueError(f"line {call.line} calls a function by its address, so that the stack has no bound")
    return target


class Stacks:
    def __init__(self, module):
        self.functions = {f.name: f for f in module.functions if f.body}
        self.known = {}

    def deepest(self, name, callers=()):
        """The chain from the function `name` that needs most."""
        if name in callers:
            raise ValueError(f"'{name}' calls itself, so that its stack has no bound")
        if name not in self.functions:
            return Chain()
        if name not in self.known:
            calls = [i for i in instructions_in(self.functions[name].body) if i.opcode.split(".")[0] == "call"]
            called = sorted(set(map(target_of, calls)))
            chains = [self.deepest(c, (*callers, name)) for c in called]
            below = max(chains, key=lambda chain: chain.size, default=Chain())
            self.known[name] = Chain(((name, local_bytes(self.functions[name].body)), *below.frames))
        return self.known[name]


def stack_sizes(module):
    """The deepest chain of every entry, by its name."""
    stacks = Stacks(module)
    return {f.name: stacks.deepest(f.name) for f in module.functions if f.entry and f.body}
