#!/usr/bin/env python3
# SPDX-FileCopyrightText: The calibrd authors
# SPDX-License-Identifier: Apache-2.0
"""Rules and dashboard in deploy/ ask for metrics and labels that the daemon has, and docs/operations.md shows the rules that
are there. Where promtool is installed (Debian: prometheus) it checks the files as Prometheus reads them.
usage: observing.py SOURCE"""
import json
import re
import shutil
import subprocess
import sys
from pathlib import Path

FAMILY = re.compile(r'MetricFamily\{"(\w+)", (\w+), "([^"]*)"')
ASKED = re.compile(r"\b((?:calibrd|process)_\w+)(?:\{([^}]*)\})?")
PARTS = {"histogram": ("_bucket", "_sum", "_count"), "counter": ("",), "gauge": ("",)}
OF_PROMETHEUS = {"instance", "job", "cell", "le"}  # given while scraping


def metrics(source: Path) -> dict[str, set[str]]:
    """The labels of each metric that the daemon has."""
    text = (source / "api/metrics/metric_table.cpp").read_text(encoding="utf-8")
    return {name + part: {label.strip() for label in labels.split(",") if label.strip()}
            for name, kind, labels in FAMILY.findall(text) for part in PARTS[kind]}


def expressions(source: Path) -> list[tuple[str, str]]:
    rules = (source / "deploy/prometheus/calibrd.rules.yml").read_text(encoding="utf-8")
    found = [("calibrd.rules.yml", line) for line in re.findall(r"^ *expr: (.*)$", rules, re.MULTILINE)]
    dashboard = json.loads((source / "deploy/grafana/calibrd.json").read_text(encoding="utf-8"))
    return found + [(panel["title"], target["expr"]) for panel in dashboard["panels"] for target in panel.get("targets", [])]


def faults_of(expression: str, known: dict[str, set[str]]) -> list[str]:
    faults = []
    for name, labels in ASKED.findall(expression):
        if name not in known:
            faults.append(f"there is no metric {name}")
            continue
        for label in re.findall(r"(\w+)\s*=~?\s*\"", labels):
            if label not in known[name] | OF_PROMETHEUS:
                faults.append(f"{name} has no label {label}")
    return faults


def unknown_jobs(expression: str, jobs: list[str]) -> list[str]:
    return [f"nothing scrapes a job {job}" for job in re.findall(r'\bjob="(\w+)"', expression) if job not in jobs]


def alerts(text: str) -> list[tuple[str, str]]:
    return re.findall(r"- alert: (\w+)[^\n]*\n\s+expr: ([^\n]*)", text)


def check(source: Path) -> list[str]:
    known, asked = metrics(source), expressions(source)
    faults = [f"{where}: {fault}" for where, expression in asked for fault in faults_of(expression, known)]
    jobs = re.findall(r"job_name: (\w+)", (source / "deploy/prometheus/prometheus.yml").read_text(encoding="utf-8"))
    faults += [f"{where}: {fault}" for where, expression in asked for fault in unknown_jobs(expression, jobs)]
    if len(asked) < 10 or not known:
        faults.append(f"only {len(asked)} expressions and {len(known)} metrics were found: this test reads them wrongly")
    shown = alerts((source / "docs/operations.md").read_text(encoding="utf-8"))
    there = alerts((source / "deploy/prometheus/calibrd.rules.yml").read_text(encoding="utf-8"))
    faults += [f"docs/operations.md shows a rule that is not in deploy/prometheus: {rule}" for rule in shown if rule not in there]
    faults += [f"docs/operations.md does not show the rule {rule}" for rule in there if rule not in shown]
    return faults + prometheus_says(source)


def prometheus_says(source: Path) -> list[str]:
    promtool = shutil.which("promtool")
    if not promtool:
        return []
    folder, faults = source / "deploy/prometheus", []
    for what in (("check", "rules", "calibrd.rules.yml"), ("check", "config", "--syntax-only", "prometheus.yml"),
                 ("test", "rules", source.resolve() / "tests/deploy/rules_test.yml")):
        done = subprocess.run([promtool, *what], cwd=folder, capture_output=True, text=True, check=False)
        if done.returncode != 0:
            faults.append(done.stdout + done.stderr)
    return faults


if __name__ == "__main__":
    problems = check(Path(sys.argv[1]))
    print("\n".join(problems))
    sys.exit(1 if problems else 0)
