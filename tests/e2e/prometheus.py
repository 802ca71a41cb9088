# SPDX-FileCopyrightText: The calibrd authors
# SPDX-License-Identifier: Apache-2.0
"""Reads Prometheus's text format 0.0.4, strictly: what a scraper would refuse or misread is an error here."""

import re

NAME = r"[a-zA-Z_:][a-zA-Z0-9_:]*"
LABEL = re.compile(r'([a-zA-Z_][a-zA-Z0-9_]*)="((?:[^"\\\n]|\\["\\n])*)"(,|$)')
SAMPLE = re.compile(rf"({NAME})(?:\{{(.*)\}})? (\S+)")
ENDINGS = {"histogram": ("_bucket", "_sum", "_count")}


class Metrics:
    """The samples of a page: value by name and labels."""

    def __init__(self, text: str):
        self.types: dict[str, str] = {}
        self.samples: dict[tuple[str, frozenset], float] = {}
        helped, family = set(), ""
        if not text.endswith("\n"):
            raise AssertionError("the last line has no end")
        for line in text.splitlines():
            if match := re.fullmatch(rf"# HELP ({NAME}) (.+)", line):
                family = match[1]
                if family in helped:
                    raise AssertionError(f"{family} is there twice")
                helped.add(family)
            elif match := re.fullmatch(rf"# TYPE ({NAME}) (counter|gauge|histogram)", line):
                if match[1] != family:
                    raise AssertionError(f"{line}: does not follow its HELP")
                self.types[family] = match[2]
            else:
                self.add(line, family)

    def add(self, line: str, family: str) -> None:
        match = SAMPLE.fullmatch(line)
        names = [family + ending for ending in ENDINGS.get(self.types.get(family, ""), ("",))]
        if not match or match[1] not in names:
            raise AssertionError(f"{line!r}: no sample of {family!r}")
        labels, rest = {}, match[2] or ""
        while rest:
            label = LABEL.match(rest)
            if not label or label[1] in labels:
                raise AssertionError(f"{line!r}: labels cannot be read")
            labels[label[1]], rest = label[2], rest[label.end():]
        key = (match[1], frozenset(labels.items()))
        if key in self.samples:
            raise AssertionError(f"{line!r}: is there twice")
        self.samples[key] = float(match[3].replace("Inf", "inf"))

    def value(self, name: str, **labels: str) -> float | None:
        return self.samples.get((name, frozenset(labels.items())))

    def label_values(self, label: str) -> set[str]:
        return {value for _, labels in self.samples for name, value in labels if name == label}
