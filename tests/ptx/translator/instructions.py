"""Instructions of PTX as statements of C++."""

from errors import PtxError
from forms import CPP, FORMS
from module import Address, Arguments, Name, Pair, Vector
from names import cpp_name, function_name
from operands import Operands
from parser import SIZES

FUSES = tuple(f"{name}.{t}" for name in ("add", "sub", "mul", "mad", "fma") for t in ("f32", "f64"))


def form_of(instruction, file):
    """The form of an instruction. Raises PtxError if the translator does not know it."""
    opcode = instruction.opcode
    if opcode in FORMS:
        return FORMS[opcode]
    why = "is unknown"
    if opcode in FUSES:
        why += ": without .rn, the driver may fuse it with others"
    elif ".ftz" in opcode:
        why += ": denormal numbers are not flushed"
    elif ".approx" in opcode or ".full" in opcode:
        why += ": approximations differ between devices"
    raise PtxError(file, instruction.line, f"instruction '{opcode}' {why}")


class Statement:
    """Translates one instruction. `functions`: name -> module.Function."""

    def __init__(self, file, scope, functions, instruction):
        self.form = form_of(instruction, file)
        self.instruction = instruction
        self.functions = functions
        self.operands = Operands(file, scope, instruction)

    def text(self):
        statement = getattr(self, self.form.kind)(*self.checked_operands())
        guard = self.instruction.guard
        return statement if guard is None else f"if ({self.operands.predicate(guard)}) {{ {statement} }}"

    def checked_operands(self):
        """The operands, as many as a method of that kind takes."""
        counts = {"mov": 2, "load": 2, "store": 2, "branch": 1, "end": 0, "shuffle": 5}
        form = self.form
        if form.kind == "plain":
            self.operands.check_count((form.result is not None) + len(form.sources))
        elif form.kind == "atom":
            self.operands.check_count((form.result is not None) + 1 + len(form.sources))
        elif form.kind == "barrier":
            self.operands.check_count(1, 2)
        elif form.kind in counts:
            self.operands.check_count(counts[form.kind])
        return self.instruction.operands

    def assign(self, destination, expression):
        name = self.operands.register(destination, self.form.result, self.form.wide)
        return f"{name} = {expression};" if self.operands.holds(destination, self.form.result) else f"set({name}, {expression});"

    def sources(self, operands):
        pairs = zip(operands, self.form.sources)
        return ", ".join(self.operands.source(operand, kind, self.form.wide) for operand, kind in pairs)

    # ---- Kinds of forms

    def plain(self, *operands):
        if self.form.result is None:
            return f"{self.form.function}({self.sources(operands)});"
        return self.assign(operands[0], f"{self.form.function}({self.sources(operands[1:])})")

    def mov(self, destination, source):
        kind = self.form.result
        if isinstance(destination, Vector):
            return self.unpack(destination.elements, source, kind)
        if isinstance(source, Vector):
            part = self.part_of(kind, source.elements)
            values = ", ".join(self.operands.source(e, part) for e in source.elements)
            return self.assign(destination, f"pack<{CPP[kind]}>({values})")
        return self.assign(destination, self.operands.source(source, kind))

    def part_of(self, kind, elements):
        """The type of the elements of a packed value."""
        size = SIZES[kind] // len(elements) if len(elements) in (2, 4) and kind[0] == "b" else 0
        if size not in (2, 4):
            self.operands.fail(f"a vector of {len(elements)} elements is not packed into .{kind}")
        return f"b{8 * size}"

    def unpack(self, elements, source, kind):
        part = self.part_of(kind, elements)
        value = self.operands.source(source, kind)
        names = [None if e == Name("_") else self.operands.register(e, part) for e in elements]
        parts = [f"set({n}, part<{CPP[part]}, {i}>(packed));" for i, n in enumerate(names) if n]
        return f"{{ const {CPP[kind]} packed = {value}; {' '.join(parts)} }}"

    def elements(self, operand):
        elements = operand.elements if isinstance(operand, Vector) else (operand,)
        if len(elements) != self.form.vector:
            self.operands.fail(f"{len(elements)} elements; expected {self.form.vector}")
        return elements

    def aligned(self, address, kind):
        return f"aligned<{self.form.vector * SIZES[kind]}>({self.operands.address(address)})"

    def access(self, address, kind, statement):
        """statement(at, i) for each element i, with the C++ expression `at` of the address."""
        at = self.aligned(address, kind)
        if self.form.vector == 1:
            return statement(at, 0)
        return f"{{ unsigned char* const at = {at}; {' '.join(statement('at', i) for i in range(self.form.vector))} }}"

    def load(self, destination, address):
        elements = self.elements(destination)

        def one(at, i):
            return "" if elements[i] == Name("_") else self.assign(elements[i], f"{self.form.function}({at}, {i})")

        return self.access(address, self.form.result, one)

    def store(self, address, source):
        kind = self.form.sources[0]
        elements = self.elements(source)

        def one(at, i):
            return f"{self.form.function}({at}, {i}, {self.operands.source(elements[i], kind, wide=True)});"

        return self.access(address, kind, one)

    def atom(self, *operands):
        address, *values = operands if self.form.result is None else operands[1:]
        call = f"{self.form.function}({self.aligned(address, self.form.sources[0])}, {self.sources(values)})"
        if self.form.result is None or operands[0] == Name("_"):
            return f"{call};"
        return self.assign(operands[0], call)

    def barrier(self, *operands):
        return f"bar_sync({', '.join(self.operands.source(o, 'u32') for o in operands)});"

    def shuffle(self, destination, *sources):
        arguments = self.sources(sources)
        if not isinstance(destination, Pair):
            return self.assign(destination, f"{self.form.function}({arguments}).value")
        valid = self.operands.register(destination.second, "pred")
        value = self.assign(destination.first, "shuffled.value")
        return f"{{ const Shuffled shuffled = {self.form.function}({arguments}); {value} {valid} = shuffled.valid; }}"

    def branch(self, label):
        if not isinstance(label, Name):
            self.operands.fail("the target is not a label")
        return f"goto {cpp_name('l', label.text)};"

    def end(self):
        return f"{self.form.function};"

    def call(self, *operands):
        results = operands[0].names if operands and isinstance(operands[0], Arguments) else ()
        rest = operands[1:] if operands and isinstance(operands[0], Arguments) else operands
        arguments = rest[1].names if len(rest) == 2 and isinstance(rest[1], Arguments) else ()
        function = self.functions.get(rest[0].text) if rest and isinstance(rest[0], Name) else None
        if function is None or len(rest) != 1 + bool(len(rest) > 1 and isinstance(rest[1], Arguments)):
            self.operands.fail("only functions are called, by their names")
        if (len(results), len(arguments)) != (len(function.results), len(function.parameters)):
            self.operands.fail(f"'{function.name}' has {len(function.results)} results and {len(function.parameters)} parameters")
        passed = []
        for name in (*results, *arguments):
            if not isinstance(name, Name) or (self.operands.scope.variable(name.text) or ("",))[0] != "param":
                self.operands.fail("arguments and results are variables in the space .param")
            passed.append(self.operands.address(Address(name, 0)))
        return f"{function_name(function)}({', '.join(passed)});"
