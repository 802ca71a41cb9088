#!/usr/bin/env python3
# SPDX-FileCopyrightText: The calibrd authors
# SPDX-License-Identifier: Apache-2.0
"""Fails when a source file lacks its licence header, outgrows 300 lines, holds a function of more than 40
lines, or a note to do something later.

usage: sources.py REPOSITORY
"""

import re
import sys
from pathlib import Path
from typing import Iterator, NamedTuple

FOLDERS = ("core", "drivers", "api", "server", "web", "config", "tests", "cmake", "scripts", "docker", "packaging", "fleet", ".ci")
CPP = {".cpp", ".hpp", ".h"}
SOURCES = CPP | {".py", ".sh", ".ts", ".mjs", ".css"}
MAX_FILE_LINES = 300
MAX_FUNCTION_LINES = 40
HEADER = ("SPDX-FileCopyrightText: The calibrd authors", "SPDX-License-Identifier: Apache-2.0")
LATER = re.compile(r"\b(TO" r"DO|FIX" r"ME|XX" r"X)\b")

# What is no code for counting braces: comments, raw strings, strings, characters.
NOISE = re.compile(r'//[^\n]*|/\*.*?\*/|R"(\w*)\(.*?\)\1"|"(?:\\.|[^"\\\n])*"|(?<!\w)\'(?:\\.|[^\'\\\n])+\'', re.S)
CONTROL = re.compile(r"(?:^|[\s})])(?:if|else|for|while|switch|catch|do|try|return)\b")
SCOPE = re.compile(r"\b(?:namespace|class|struct|union|enum|extern)\b[^()=]*$")


# `case Error::x: return "what is wrong";` is an entry of a message table, not a step of a function.
TABLE_ENTRY = re.compile(r"[ \t]*(?:case [\w:]+:)?\s*(?:return\b)?\s*;?[ \t]*$")


class Function(NamedTuple):
    line: int
    lines: int
    head: str


def blank(match: re.Match) -> str:
    """Keeps the lines and drops what stands in them."""
    return re.sub(r"[^\n]", " ", match[0])


def is_function(head: str) -> bool:
    return ")" in head and not CONTROL.match(head) and not re.search(r"=\s*$|,\s*$", head)


def count_lines(code: str, text: str) -> int:
    """The lines of a function; `code` is `text` with its strings and comments blanked."""
    pairs = zip(code.splitlines(), text.splitlines())
    return sum(1 for blanked, line in pairs
               if not (TABLE_ENTRY.match(blanked) and re.match(r'\s*(case\b|return\s*"|")', line)))


def functions(text: str) -> Iterator[Function]:
    """The functions of a C++ file; a function's lines are those from its first to its closing brace."""
    code = re.sub(r"^[ \t]*#(?:[^\n]*\\\n)*[^\n]*", blank, NOISE.sub(blank, text), flags=re.M)
    open_braces: list[tuple[str, int, str]] = []  # kind, where its head starts, the head
    head_start = 0
    for match in re.finditer(r"[{};]", code):
        brace, at = match[0], match.start()
        head = code[head_start:at].strip()
        if brace == "{":
            inside = any(kind == "function" for kind, _, _ in open_braces)
            kind = "scope" if SCOPE.search(head) else "function" if is_function(head) and not inside else "block"
            start = head_start + len(code[head_start:at]) - len(code[head_start:at].lstrip())
            open_braces.append((kind, start, head))
        elif brace == "}" and open_braces:
            kind, start, opened = open_braces.pop()
            if kind == "function" and re.match(r"\s*[{,]", code[match.end():]):
                head_start = start  # it was an initialiser, a_{b}: the head of the function goes on
                continue
            if kind == "function":
                lines = count_lines(code[start:at + 1], text[start:at + 1])
                yield Function(code.count("\n", 0, start) + 1, lines, " ".join(opened.split())[:70])
        head_start = match.end()


def complaints_about(name: str, text: str) -> Iterator[str]:
    lines = text.splitlines()
    top = lines[1:3] if lines and lines[0].startswith("#!") else lines[:2]
    if len(top) < 2 or not all(part in line for part, line in zip(HEADER, top)):
        yield f"{name}:1: the two SPDX lines are missing"
    if len(lines) > MAX_FILE_LINES:
        yield f"{name}: {len(lines)} lines; a file has at most {MAX_FILE_LINES}: split it by what it does"
    for number, line in enumerate(lines, start=1):
        if LATER.search(line):
            yield f"{name}:{number}: a note to do something later; do it or write it into the documentation as a limit"
    if Path(name).suffix in CPP:
        for function in functions(text):
            if function.lines > MAX_FUNCTION_LINES:
                yield (f"{name}:{function.line}: {function.lines} lines in one function; at most "
                       f"{MAX_FUNCTION_LINES}: {function.head}")


def source_files(root: Path) -> Iterator[Path]:
    for folder in FOLDERS:
        for path in sorted((root / folder).rglob("*")):
            if path.is_file() and "node_modules" not in path.parts and (
                    path.suffix in SOURCES or folder == ".ci" or path.name.startswith("Dockerfile")):
                yield path


def main() -> int:
    if len(sys.argv) != 2:
        print(__doc__, file=sys.stderr)
        return 2
    root = Path(sys.argv[1])
    found, count = [], 0
    for path in source_files(root):
        count += 1
        found += complaints_about(path.relative_to(root).as_posix(), path.read_text(encoding="utf-8"))
    print("\n".join(found) if found else f"{count} source files hold")
    return 1 if found or count == 0 else 0


if __name__ == "__main__":
    sys.exit(main())
