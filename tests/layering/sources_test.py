#!/usr/bin/env python3
# SPDX-FileCopyrightText: The calibrd authors
# SPDX-License-Identifier: Apache-2.0
"""Shows that sources.py finds what it is there to find."""

import unittest

from sources import HEADER, complaints_about, functions

TOP = f"// {HEADER[0]}\n// {HEADER[1]}\n"


def long_body(lines: int) -> str:
    return "  work();\n" * lines


class Sources(unittest.TestCase):
    def complaints(self, text: str, name: str = "core/a.cpp") -> str:
        return "\n".join(complaints_about(name, text))

    def test_accepts_a_small_file_with_its_header(self):
        self.assertEqual(self.complaints(TOP + "void f() {\n" + long_body(38) + "}\n"), "")

    def test_the_header_may_follow_the_interpreter_line(self):
        script = f"#!/bin/sh\n# {HEADER[0]}\n# {HEADER[1]}\n"
        self.assertEqual(self.complaints(script, "scripts/a.sh"), "")

    def test_finds_a_missing_header(self):
        self.assertIn("SPDX", self.complaints("int a;\n"))
        self.assertIn("SPDX", self.complaints(""))

    def test_finds_a_file_of_more_than_300_lines(self):
        self.assertIn("301 lines", self.complaints(TOP + "\n" * 299))

    def test_finds_a_note_to_do_something_later(self):
        self.assertIn("a.cpp:3", self.complaints(TOP + "// TO" + "DO: later\n"))

    def test_finds_a_function_of_more_than_40_lines(self):
        self.assertIn("41 lines in one function", self.complaints(TOP + "void f() {\n" + long_body(39) + "}\n"))

    def test_does_not_count_the_entries_of_a_message_table(self):
        entry = '    case E::a:\n      return "wrong: "\n             "do this";\n'
        text = "const char* text(E e) {\n  switch (e) {\n" + entry * 30 + '  }\n  return "unknown";\n}\n'
        self.assertEqual([f.lines for f in functions(text)], [4])
        self.assertEqual([f.lines for f in functions(text.replace("return", "f();  return"))], [5 + 30])

    def test_counts_methods_in_classes_in_namespaces(self):
        text = "namespace a {\nclass B : public C {\n  int f() const override {\n" + long_body(50) + "  }\n};\n}\n"
        self.assertEqual([(f.line, f.lines) for f in functions(text)], [(3, 52)])

    def test_does_not_take_classes_and_tables_for_functions(self):
        text = "struct S {\n" + "  int a;\n" * 60 + "};\nconst int t[] = {\n" + "  f(1),\n" * 60 + "};\n"
        self.assertEqual(list(functions(text)), [])

    def test_counts_a_lambda_to_the_function_around_it(self):
        text = "void f() {\n  g([&](int a) {\n    if (a) { h(); }\n  });\n}\n"
        self.assertEqual([f.lines for f in functions(text)], [5])

    def test_ignores_braces_in_strings_comments_and_macros(self):
        text = '#define M(x) \\\n  { x\nvoid f() {\n  // {\n  g("{", \'{\', 1\'000);\n  /* { */\n}\nvoid h() {\n}\n'
        self.assertEqual([(f.line, f.lines) for f in functions(text)], [(3, 5), (8, 2)])

    def test_sees_constructors_with_initialisers_and_tests(self):
        text = "A::A(int b)\n    : b_(b),\n      c_{b} {\n  g();\n}\nTEST(A, B) {\n  g();\n}\n"
        self.assertEqual([(f.line, f.lines) for f in functions(text)], [(1, 5), (6, 3)])


if __name__ == "__main__":
    unittest.main()
