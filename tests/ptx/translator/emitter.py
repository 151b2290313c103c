"""A PTX module as C++ (tests/ptx/README.md describes the result)."""

from collections import Counter

from errors import PtxError
from instructions import Statement, form_of
from module import Address, Block, Instruction, Label, Name, Registers
from names import Scope, cpp_name, function_name, register_type

NAMES_PER_LINE = 12
EXTERNAL = 'extern "C" '
INCLUDES = ('#include "instructions/instructions.h"', '#include "runtime/module.h"', "")


def instructions_in(block):
    for statement in block.statements:
        if isinstance(statement, Block):
            yield from instructions_in(statement)
        elif isinstance(statement, Instruction):
            yield statement


def names_in(instruction):
    """Names among the operands, also in addresses."""
    bases = (o.base if isinstance(o, Address) else o for o in instruction.operands)
    return {o.text for o in bases if isinstance(o, Name)}


def opcode_counts(module):
    """How often each opcode occurs in the module."""
    return Counter(i.opcode for f in module.functions if f.body for i in instructions_in(f.body))


def external_functions(module):
    """Names of the functions that the module declares and does not define."""
    defined = {f.name for f in module.functions if f.body}
    return sorted({f.name for f in module.functions} - defined)


class Emitter:
    def __init__(self, module, linkage="static "):
        """`linkage`: of the functions and variables in C++."""
        self.module = module
        self.linkage = linkage
        self.lines = []
        self.functions = {}
        self.scope = Scope(module.file)
        self.shared_bytes = 0
        self.shared_names = set()
        self.labels = set()
        self.collect_functions()

    def fail(self, line, message):
        raise PtxError(self.module.file, line, message)

    def taken_lines(self):
        lines, self.lines = self.lines, []
        return lines

    def collect_functions(self):
        for function in self.module.functions:
            known = self.functions.get(function.name)
            if known and known.body and function.body:
                self.fail(function.line, f"'{function.name}' is defined twice")
            if known and (len(known.results), len(known.parameters)) != (len(function.results), len(function.parameters)):
                self.fail(function.line, f"'{function.name}' is declared with other parameters in line {known.line}")
            if not known or function.body:
                self.functions[function.name] = function

    # ---- Variables

    def global_variables(self):
        """Lines that define the variables of the module."""
        for variable in self.module.variables:
            if variable.space == "shared":
                self.shared_variable(variable, self.scope)
            else:
                self.global_variable(variable)
        return self.taken_lines()

    def global_variable(self, variable):
        if variable.external:
            self.fail(variable.line, f"external variable '{variable.name}' has no definition")
        if variable.space not in ("global", "const"):
            self.fail(variable.line, f"variables of modules are not in the space .{variable.space}")
        name = cpp_name("v", variable.name)
        self.scope.declare_variable(variable, name)
        values = ", ".join(map(str, variable.initial.rstrip(b"\0"))) if variable.initial else ""
        self.lines.append(f"alignas({variable.alignment}) {self.linkage}unsigned char {name}[{variable.size}] = {{{values}}};")

    def extern_variables(self):
        """Lines that declare the variables for other files."""
        known = [(v, cpp_name("v", v.name)) for v in self.module.variables if v.space != "shared"]
        return [f"alignas({v.alignment}) extern unsigned char {name}[{v.size}];" for v, name in known]

    def shared_variable(self, variable, scope):
        """Variables with a size are placed one after the other; the one without begins after all of them."""
        self.shared_names.add(variable.name)
        if variable.external:
            return scope.declare_variable(variable, "dynamic_shared()")
        begin = -(-self.shared_bytes // variable.alignment) * variable.alignment
        self.shared_bytes = begin + variable.size
        return scope.declare_variable(variable, f"shared({begin})")

    def local_variable(self, variable, scope):
        if variable.space == "shared":
            return self.shared_variable(variable, scope)
        if variable.space in ("global", "const"):
            self.fail(variable.line, f"variables of functions are not in the space .{variable.space}")
        name = cpp_name("v", variable.name)
        scope.declare_variable(variable, name)
        self.lines.append(f"alignas({variable.alignment}) unsigned char {name}[{variable.size}];")
        return None

    # ---- Functions

    def signature(self, function):
        names = ", ".join(f"unsigned char* {cpp_name('v', p.name)}" for p in (*function.results, *function.parameters))
        return f"{self.linkage if function.body else EXTERNAL}void {function_name(function)}({names})"

    def signatures(self):
        return [f"{self.signature(function)};" for function in self.functions.values()]

    def defined_functions(self):
        return [f for f in self.functions.values() if f.body]

    def function(self, function):
        """Lines that define a function."""
        scope = Scope(self.module.file, self.scope)
        for parameter in (*function.results, *function.parameters):
            scope.declare_variable(parameter, cpp_name("v", parameter.name))
        self.labels = {s.name for s in all_statements(function.body) if isinstance(s, Label)}
        self.lines.append(f"{self.signature(function)} {{")
        self.block(function.body, scope)
        self.lines += ["}", ""]
        return self.taken_lines()

    def block(self, block, scope):
        for statement in block.statements:
            if isinstance(statement, Block):
                self.lines.append("{")
                self.block(statement, Scope(self.module.file, scope))
                self.lines.append("}")
            elif isinstance(statement, Registers):
                self.registers(statement, scope)
            elif isinstance(statement, Label):
                self.lines.append(f"{cpp_name('l', statement.name)}:;")
            elif isinstance(statement, Instruction):
                self.check_target(statement)
                self.lines.append(Statement(self.module.file, scope, self.functions, statement).text())
            else:
                self.local_variable(statement, scope)

    def registers(self, statement, scope):
        for name in statement.names:
            scope.declare_register(statement.line, name, statement.type)
        names = [cpp_name("r", n) for n in statement.names]
        for i in range(0, len(names), NAMES_PER_LINE):
            self.lines.append(f"{register_type(statement.type)} {', '.join(names[i : i + NAMES_PER_LINE])};")

    def check_target(self, instruction):
        if form_of(instruction, self.module.file).kind == "branch" and instruction.operands:
            target = instruction.operands[0]
            if isinstance(target, Name) and target.text not in self.labels:
                self.fail(instruction.line, f"the label '{target.text}' is unknown")

    # ---- Tables

    def functions_with(self, chosen):
        """Functions that have an instruction for which `chosen` is true, or that call one."""
        found, calls = set(), {}
        for function in self.defined_functions():
            instructions = list(instructions_in(function.body))
            if any(map(chosen, instructions)):
                found.add(function.name)
            called = [i for i in instructions if form_of(i, self.module.file).kind == "call"]
            calls[function.name] = set().union(*map(names_in, called))
        while True:
            more = {name for name, called in calls.items() if name not in found and called & found}
            if not more:
                return found
            found |= more

    def tables(self, name):
        """Lines that describe the module."""
        cooperative = self.functions_with(lambda i: form_of(i, self.module.file).cooperative)
        sharing = self.functions_with(lambda i: names_in(i) & self.shared_names)
        entries, symbols = [], []
        for f in self.functions.values():
            if f.entry and f.body:
                arguments = ", ".join(f"p[{i}]" for i in range(len(f.parameters)))
                sizes = ", ".join(str(p.size) for p in f.parameters)
                run = f"[](unsigned char* const*{' p' if f.parameters else ''}) {{ {function_name(f)}({arguments}); }}"
                properties = ", ".join(str(f.name in functions).lower() for functions in (cooperative, sharing))
                entries.append(f'{{"{f.name}", {run}, {{{sizes}}}, {properties}}},')
        for v in self.module.variables:
            if v.space != "shared":
                symbols.append(f'{{"{v.name}", {cpp_name("v", v.name)}, {v.size}}},')
        head = [f"extern const Module {name};", f"const Module {name}{{"]
        return [*head, "{", *entries, "},", "{", *symbols, "},", f"{self.shared_bytes}}};", ""]


def all_statements(block):
    for statement in block.statements:
        yield statement
        if isinstance(statement, Block):
            yield from all_statements(statement)


def text_of(*groups):
    return "\n".join(line for group in groups for line in group) + "\n"


def translate(module, name):
    """`module` as C++ with a variable `name` that describes it. Raises PtxError."""
    emitter = Emitter(module)
    variables = emitter.global_variables()
    functions = [line for f in emitter.defined_functions() for line in emitter.function(f)]
    head, end = (*INCLUDES, "namespace ptx {", ""), ("}  // namespace ptx",)
    return text_of(head, variables, emitter.signatures(), [""], functions, emitter.tables(name), end)


def translate_parts(module, name, count):
    """The same in `count` parts of similar size, which can be compiled at the same time: {file: text}. NAME.cpp describes the
    module, NAME_0.cpp and so on hold the functions, NAME.h declares them."""
    emitter = Emitter(module, linkage="")
    head = (f'#include "{name}.h"', "", f"namespace ptx::{name}_code {{", "")
    end = (f"}}  // namespace ptx::{name}_code",)
    variables = emitter.global_variables()
    parts = [[] for _ in range(count)]
    sizes = [0] * count
    for function in sorted(emitter.defined_functions(), key=lambda f: -sum(1 for _ in instructions_in(f.body))):
        smallest = sizes.index(min(sizes))
        lines = emitter.function(function)
        sizes[smallest] += len(lines)
        parts[smallest] += lines
    files = {f"{name}_{i}.cpp": text_of(head, part, end) for i, part in enumerate(parts)}
    files[f"{name}.h"] = text_of(INCLUDES, head[2:], emitter.extern_variables(), emitter.signatures(), end)
    tables = ("", "namespace ptx {", f"using namespace {name}_code;", "", *emitter.tables(name), "}  // namespace ptx")
    files[f"{name}.cpp"] = text_of(head, variables, end, tables)
    return files
