#!/usr/bin/env python3
"""Sources: files have at most 400 lines and functions at most 60; no marks of unfinished work; target conditionals only in
TARGET_FOLDERS; no function of std::filesystem that throws its own exception; every paper that a comment cites is in
docs/bibliography.md."""

import re

import house

SCRIPT_SUFFIXES = {".py", ".js"}
MAX_FILE_LINES = 400
MAX_FUNCTION_LINES = 60

# Tables, which may be longer. Path from the root -> why.
LONG_FILES = {}
# (path from the root, name) -> why.
LONG_FUNCTIONS = {}

# Where code may ask which processor it is compiled for.
TARGET_FOLDERS = ("src/core/", "src/accel/", "src/frame/")
TARGET_CONDITIONAL = re.compile(r"__CUDACC__|__CUDA_ARCH__|RELUME_DEVICE_CODE")

# Functions of std::filesystem that use the disk: without a std::error_code they throw, with a text for programmers.
DISK_CALL = re.compile(
    r"\b(?:std::filesystem|fs)::(absolute|(?:weakly_)?canonical|copy(?:_file|_symlink)?|create_\w+|current_path|equivalent|exists|file_size|hard_link_count"
    r"|is_(?:block_file|character_file|directory|empty|fifo|other|regular_file|socket|symlink)|last_write_time|permissions|proximate|read_symlink|relative"
    r"|remove(?:_all)?|rename|resize_file|space|(?:symlink_)?status|temp_directory_path|(?:recursive_)?directory_iterator)(?:\s+\w+)?\s*[({]")
ERROR_CODE = re.compile(r"\bstd::error_code\s*&?\s*(\w+)")
FILE_STATUS = re.compile(r"\b(?:file_status|auto)\s+(\w+)\s*=\s*[\w:]*status\(")

# Split into halves so that this file does not match itself.
UNDONE = re.compile(r"\b(?:TO" r"DO|FIX" r"ME|XX" r"X|not imple" r"mented yet)\b")
UNDONE_SUFFIXES = house.CODE_SUFFIXES + (".cmake", ".txt", ".py", ".js", ".md", ".json", ".in")

CITATION = re.compile(r"\[((?:[A-Z][A-Za-z]+\d\d|KHR-\w+))[^\]\w][^\]]*\]|\[((?:[A-Z][A-Za-z]+\d\d|KHR-\w+))\]")

# What ends a statement or a scope, and the text between.
TOKEN = re.compile(r"[{};:]|[^{};:]+")
CONTAINER = re.compile(r"\b(?:namespace|class|struct|union|enum|extern)\b(?!.*\)\s*(?:const|noexcept|override|final|\s)*$)", re.DOTALL)


def without_template(head):
    """`head` without the parameter lists of templates, whose `class` and `=` do not belong to the declaration."""
    while True:
        match = re.search(r"\btemplate\s*<", head)
        if not match:
            return head
        depth, end = 1, match.end()
        while depth and end < len(head):
            depth += {"<": 1, ">": -1}.get(head[end], 0)
            end += 1
        head = head[: match.start()] + head[end:]


def scope_kind(head, stack):
    """Kind of scope that a brace opens after `head`: "container", "function", "inside" one, a "part" of the head, or "other"."""
    if any(kind in ("function", "other") for kind, _, _ in stack):
        return "inside"
    if head.count("(") > head.count(")"):
        return "part"  # a default argument
    head = without_template(head).strip().replace("::", "")
    if CONTAINER.search(head) or not head:
        return "container"
    if "(" not in head or head.endswith("="):
        return "other"
    return "part" if re.search(r"\)[^()]*:.*\w$", head, re.DOTALL) else "function"  # part: Type() : member{


def functions(text):
    """(name, first line, number of lines) of every function in C++ text. Raises ValueError if braces do not match."""
    text = re.sub(r"^[ \t]*#(?:\\\n|[^\n])*", lambda m: "\n" * m[0].count("\n"), house.without_comments(text), flags=re.MULTILINE)
    found, stack, head, line, head_line = [], [], "", 1, 1
    for token in TOKEN.findall(text):
        if token == "{":
            kind = scope_kind(head, stack)
            stack.append((kind, head, head_line))
            head = "" if kind != "part" else head + "{"
        elif token == "}":
            if not stack:
                raise ValueError(f"line {line}: closing brace without an opening one")
            kind, opened_head, opened_line = stack.pop()
            head = opened_head + "{}" if kind == "part" else ""
            if kind == "function":
                name = re.search(r"([\w~]+|operator\W+)\s*\(", without_template(opened_head))
                found.append((name[1] if name else "?", opened_line, line - opened_line + 1))
        elif (token == ";" and head.count("(") <= head.count(")")) or (token == ":" and head in ("public", "private", "protected")):
            head = ""
        elif head:
            head += token
        else:
            head = token.lstrip()
            head_line = line + token.count("\n", 0, len(token) - len(head))
        line += token.count("\n")
    if stack:
        raise ValueError(f"line {stack[-1][2]}: opening brace without a closing one")
    return found


def check_length(name, text):
    count = text.count("\n")
    if count <= MAX_FILE_LINES or name in LONG_FILES:
        return []
    return [f"{name}:{MAX_FILE_LINES}: {count} lines; at most {MAX_FILE_LINES}; split the file"]


def check_functions(name, text):
    problems = []
    try:
        for function, line, length in functions(text):
            if length > MAX_FUNCTION_LINES and (name, function) not in LONG_FUNCTIONS:
                problems.append(f"{name}:{line}: {function} has {length} lines; at most {MAX_FUNCTION_LINES}")
    except ValueError as error:
        problems.append(f"{name}: cannot measure the functions: {error}")
    return problems


def argument_list(code, begin):
    """The text from `begin`, which follows an opening parenthesis, to the one that closes it."""
    depth = 1
    for end in range(begin, len(code)):
        depth += {"(": 1, "{": 1, ")": -1, "}": -1}.get(code[end], 0)
        if depth == 0:
            return code[begin:end].strip()
    return code[begin:]


def check_disk_calls(name, code):
    """Calls without an error code; a known status and the end of a folder need none."""
    problems = []
    codes, statuses = set(ERROR_CODE.findall(code)), set(FILE_STATUS.findall(code))
    for match in DISK_CALL.finditer(code):
        arguments = argument_list(code, match.end())
        harmless = arguments in statuses or (not arguments and match[1].endswith("iterator"))
        if not harmless and arguments.split(",")[-1].strip() not in codes:
            line = code.count("\n", 0, match.start()) + 1
            problems.append(f"{name}:{line}: std::filesystem::{match[1]} throws; pass a std::error_code and report what failed")
    return problems


def check_code(name, text, bibliography):
    problems = check_functions(name, text)
    if name.startswith(("include/", "src/", "lab/", "apps/")) and "/testing/" not in name and not name.endswith(("_test.cpp", "_bench.cpp")):
        problems += check_disk_calls(name, house.without_comments(text))
    if name.startswith(("src/", "lab/")) and not name.startswith(TARGET_FOLDERS):
        code = house.without_comments(text)
        for match in TARGET_CONDITIONAL.finditer(code):
            line = code.count("\n", 0, match.start()) + 1
            problems.append(f"{name}:{line}: {match[0]} may be used only in {', '.join(TARGET_FOLDERS)}")
    for line, comment in house.comments(text):
        for match in CITATION.finditer(comment):
            key = match[1] or match[2]
            if f"[{key}]" not in bibliography:
                problems.append(f"{name}:{line}: [{key}] is not in docs/bibliography.md")
    return problems


def check(root):
    bibliography_file = root / "docs" / "bibliography.md"
    bibliography = bibliography_file.read_text(encoding="utf-8") if bibliography_file.exists() else ""
    code = set(house.code_files(root))
    problems = []
    for path in house.files(root):
        if path.suffix not in UNDONE_SUFFIXES and path.parent.name not in ("scripts", "tools"):
            continue
        name = path.relative_to(root).as_posix()
        text = path.read_text(encoding="utf-8")
        problems += check_length(name, text) if path in code or path.suffix in SCRIPT_SUFFIXES else []
        if path in code:
            problems += check_code(name, text, bibliography)
        for number, content in enumerate(text.splitlines(), 1):
            if UNDONE.search(content):
                problems.append(f"{name}:{number}: unfinished work: {content.strip()}")
    return problems


if __name__ == "__main__":
    house.report(check(house.ROOT))
