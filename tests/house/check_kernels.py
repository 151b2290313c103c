#!/usr/bin/env python3
"""Kernels: no pointer except those of views (docs/architecture.md).

The check begins with the kernels that kernels.inc files list, and with the types of src/scene, src/accel and src/materials whose
names end in View. It follows the types of their members. None may have a pointer or a reference as a member, except View itself
and the handle of the host's acceleration structure. Elements of views hold no views either, so that an array can be copied to
a device as it is. Types are found by their names, without namespaces.
"""

import re

import house

# Types that may have pointers -> why.
POINTER_HOLDERS = {
    "View": "gives access to arrays",
    "HostAccel": "refers to data of the host; device code never reads it",
}

VIEW_FOLDERS = ("src/scene/", "src/accel/", "src/materials/")
LISTED = re.compile(r"\bRELUME_(?:GROUP_)?KERNEL\(([^;]*)\);")
TYPE = re.compile(r"\b(?:struct|class|union)\b(?:\s+alignas\s*\([^)]*\))?\s+(\w+)(?:<[^{;]*>)?\s*(?:final\s*)?(?::(?!:)([^{;]*))?$")
ALIAS = re.compile(r"\busing\s+(\w+)\s*=\s*([^;]+);")
WORD = re.compile(r"[A-Za-z_]\w*")
NOT_MEMBERS = re.compile(r"^(?:using|friend|static|typedef|template|enum|constexpr static|inline static)\b")
POINTER = re.compile(r"[*&]|\bstd::(?:span|vector|string|unique_ptr|shared_ptr|function)\b")
FUNCTION_POINTER = re.compile(r"\(\s*(?:\w+::)?\*")
ALIGNMENT = re.compile(r"\balignas\s*\([^)]*\)")
INITIALIZER = re.compile(r"^[^()]*[\w>\]]\s*=?\s*$")  # after the name of a member
VIEW_OF = re.compile(r"\bView<\s*(.+)>")


class Type:
    """All types of one name."""

    def __init__(self):
        self.members = []  # (file, line, text)
        self.words = set()  # names in its bases, or in what it is an alias of


def declarations(text):
    """(name, bases, [(line, member)]) of every struct, class and union in C++ text. Those without a name belong to the one around them."""
    text = re.sub(r"^[ \t]*#(?:\\\n|[^\n])*", lambda m: "\n" * m[0].count("\n"), house.without_comments(text), flags=re.MULTILINE)
    found, stack, head, line, head_line = [], [], "", 1, 1
    for c in text:
        if c == "{":
            is_nameless = stack and head.strip() in ("struct", "union")
            stack.append(stack[-1] if is_nameless else (TYPE.search(head.strip()), head, head_line, []))
            head = ""
        elif c == "}":
            if not stack:
                return found
            match, opened, opened_line, members = stack.pop()
            if match:
                if not any(entry[3] is members for entry in stack):
                    found.append((match[1], match[2] or "", members))
                head = ""
            elif INITIALIZER.search(opened):
                head, head_line = opened + "{}", opened_line
            else:
                head = ""  # a function or namespace
        elif c == ";":
            if stack and stack[-1][0] and head.strip():
                stack[-1][3].append((head_line, head.strip()))
            head = ""
        elif c == ":" and head in ("public", "protected", "private"):
            head = ""
        elif head or not c.isspace():
            head_line = line if not head else head_line
            head += c
        line += c == "\n"
    return found


def declared_type(member):
    """The type and name in a member's declaration; None if it declares a function or no member."""
    if NOT_MEMBERS.match(member):
        return None
    declaration = ALIGNMENT.sub("", re.split(r"[={]", member, maxsplit=1)[0])
    depth = 0
    for c in declaration:
        depth += {"<": 1, ">": -1}.get(c, 0)
        if c == "(" and depth == 0 and not FUNCTION_POINTER.search(declaration):
            return None
    return declaration


def read_types(root):
    """Types of headers below src/ by name, and the names of the roots."""
    types, roots = {}, set()
    for path in sorted((root / "src").rglob("*")):
        name = path.relative_to(root).as_posix()
        if "/testing/" in name or path.suffix not in (".h", ".inc"):
            continue
        text = path.read_text(encoding="utf-8")
        if path.name == "kernels.inc":
            for match in LISTED.finditer(house.without_comments(text)):
                roots.update(WORD.findall(match[1]))
            continue
        for type_name, bases, members in declarations(text):
            known = types.setdefault(type_name, Type())
            known.words.update(WORD.findall(bases))
            known.members += [(name, line, member) for line, member in members]
            if type_name.endswith("View") and name.startswith(VIEW_FOLDERS):
                roots.add(type_name)
        for match in ALIAS.finditer(house.without_comments(text)):
            # Many structs have aliases of these names. Types are matched by name, so these would connect unrelated types.
            if not match[1].startswith(("Policy", "Policies", "Value")):
                types.setdefault(match[1], Type()).words.update(WORD.findall(match[2]))
    return types, roots


def check(root):
    types, roots = read_types(root)
    problems = []
    seen = set()
    todo = [(name, name, False) for name in sorted(roots)]
    while todo:
        name, origin, is_element = todo.pop()
        if (name, is_element) in seen or name in POINTER_HOLDERS or name not in types:
            continue
        seen.add((name, is_element))
        todo += [(word, origin, is_element) for word in sorted(types[name].words)]
        for file, line, member in types[name].members:
            declaration = declared_type(member)
            if declaration is None:
                continue
            if POINTER.search(declaration):
                problems.append(f"{file}:{line}: {name}, which kernel or view {origin} reaches, holds a pointer: {' '.join(declaration.split())}; use a View or an index")
            view = VIEW_OF.search(declaration)
            if view and is_element:
                problems.append(f"{file}:{line}: {name}, an element of an array that {origin} reaches, holds a view: {' '.join(declaration.split())}; use an index")
            for word in WORD.findall(declaration):
                todo.append((word, origin, is_element or bool(view and word in WORD.findall(view[1]))))
    return sorted(set(problems))


if __name__ == "__main__":
    house.report(check(house.ROOT))
