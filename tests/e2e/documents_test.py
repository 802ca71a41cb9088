#!/usr/bin/env python3
# SPDX-FileCopyrightText: The calibrd authors
# SPDX-License-Identifier: Apache-2.0
"""The documentation does as it says: every command and program in its fenced blocks runs against the simulated cell, or is named
below with what tests it, or why nothing here can."""

import os
import re
import shutil
import subprocess
import sys
import unittest
from pathlib import Path

from cell import BUILD, OF_THIS_BUILD, SENSOR, SOURCE, CellTest, call, wait_until

DOCUMENTS = [SOURCE / "README.md", SOURCE / "CONTRIBUTING.md", *sorted((SOURCE / "docs").glob("*.md"))]
OF_THE_SIMULATOR = SOURCE / "docs/simulator.md"
FIRST, SECOND = "20261122T014643-192c11", "20261122T020110-77ab03"  # the calibrations of the examples
ELSEWHERE = (
    (r"(sudo )?scripts/\S+", "minutes to hours each; that there is such a script is looked at here"),
    (r"docker build ", "takes an engine; scripts/test_image.sh builds each of these targets with buildah"),
    (r"docker compose ", "takes an engine; nothing here runs it: ctest -R manifests holds the files against their schema"),
    (r"sudo apt install \./build/release/package/calibrd_", "changes the machine; scripts/test_package.sh does it in a root of its own"),
    (r"sudo -u calibrd calibrd", "takes that user; scripts/test_package.sh runs it in a root of its own, as that user"),
    (r"sudo systemctl enable ", "changes the machine; scripts/test_package.sh enables the unit in a folder; nothing here starts it by systemd"),
    (r"sudo mkdir /etc/calibrd/robot|sudoedit /etc/calibrd/", "changes the machine; nothing here runs it"),
    (r"journalctl ", "takes the unit running under systemd; operations_test.py reads the same lines from stderr"),
    (r"calibrd healthcheck", "healthcheck_test.py"),
    (r"calibrd-collector ", "takes these servers; fleet_test.py runs it with TLS to the broker, and a database without TLS or password"),
    (r"xacro ", "is not ours"),
    (r"git clone https://github.com/OpenKinect|cmake .*OPENNI2_DRIVER|.*/opt/(freenect2|kinect2)|sudo (apt install build-e|cmake --ins)",
     "is not ours; needs the network, and changes the machine; nothing here runs it"),
    (r"build/release/bin/calibrd-sim run ", "every test of tests/e2e starts it"),
    (r"curl .*http://cell7:", "security_test.py"),
    (r"curl .*/robot/motions|jq .*next_posture_of", "motion_test.py"),
    (r"curl .*\"left\", \"right\"", "several_sensors_test.py"),
)
# Ends that are right here, other than with status 0: what the command ends with, and what it says.
ENDS = (
    (r"curl -X DELETE .*/calibrations/", 22, "status 409"),  # it has ended
    (r"curl .*Idempotency-Key", 22, "status 409"),           # the one asked for just before still runs
    (r"build/release/bin/calibrd serve --config my_cell.toml --check-config", 2, "/etc/calibrd/robot/robot.urdf"),  # not filled in
    (r"(build/release/bin/)?calibrd-sensor --list", 3, "no depth sensor matches"),
    (r"curl -N", 28, ""),                                    # has no end
)
SHORTENED = {"--scenes 100": "--scenes 1", "--scenes 60": "--scenes 1"}
LONGEST_S = 150


class Block:
    def __init__(self, language: str, text: str, where: str):
        self.language, self.text, self.where = language, text, where

    def commands(self) -> list[str]:
        """Of a shell: lines that go on are one; a command that needs the one before it is with it."""
        joined = re.sub(r"\s*\\\n\s*", " ", self.text)
        joined = re.sub(r"\|\n\s*", "| ", joined)
        return [re.sub(r"\s{2,}# .*$", "", line).strip() for line in joined.splitlines() if line.strip()]


def blocks_of(document: Path) -> list[Block]:
    text = document.read_text(encoding="utf-8")
    return [Block(found[1], found[2], f"{document.name}:{text.count(chr(10), 0, found.start()) + 2}")
            for found in re.finditer(r"^```(sh|python|cpp)\n(.*?)^```", text, re.DOTALL | re.MULTILINE)]


class Documents(CellTest):
    """`real`: what stands in the documents, and what it is in this cell."""

    def start_cell(self) -> None:
        simulator = self.simulate()
        simulator.hurry()
        self.daemon = self.serve(simulator, "drift.healing=off").wait_ready()
        ids = [self.daemon.calibrate(postures=postures)["id"] for postures in (3, 2)]
        self.real = {FIRST: ids[0], SECOND: ids[1], "127.0.0.1:8080": f"127.0.0.1:{self.daemon.port}",
                     "/etc/calibrd/calibrd.toml": str(SOURCE / "config/demo.toml"), **SHORTENED}

    def start_simulator(self) -> None:
        simulator = self.simulate()
        self.real = {"127.0.0.1:8078": f"127.0.0.1:{simulator.control_port}", "/tmp/calibrd.world": str(simulator.world_file),
                     "/tmp/scenes": str(self.folder / "scenes"), **SHORTENED}

    def place(self, document: Path) -> Path:
        """A folder that looks like the repository's root after a build."""
        root = self.folder / document.stem
        (root / "build").mkdir(parents=True)
        for name in ("config", "deploy", "scripts"):
            (root / name).symlink_to(SOURCE / name)
        (root / "build/release").symlink_to(BUILD)
        (root / ".curlrc").write_text(f'silent\nshow-error\nmax-time = {LONGEST_S}\nwrite-out = "%{{stderr}}status %{{http_code}}\\n"\n')
        if document.stem == "security":  # where the daemon of that cell would have them
            shutil.copy(SOURCE / "config/demo.toml", root / "my_cell.toml")
        return root

    def environment(self, root: Path) -> dict[str, str]:
        settings = {}
        if root.name in ("security", "operations"):
            settings = {"CALIBRD_SERVER__PORT": str(self.daemon.port), "CALIBRD_ROBOT__URDF": OF_THIS_BUILD[0].split("=", 1)[1],
                        "CALIBRD_SERVER__TOKENS_FILE": str(root / "tokens.json")}
        return {**os.environ, **settings, "HOME": str(root), "PATH": f"{BUILD / 'bin'}:{os.environ['PATH']}"}

    def put_real(self, text: str) -> str:
        for example, real in self.real.items():
            text = text.replace(example, real)
        text = text.replace("curl -N", "curl -N --max-time 2")
        return re.sub(r"\bcurl (?!-f)", "curl --fail-with-body ", text)

    def run_in(self, root: Path, words: list[str], text: str | None = None) -> subprocess.CompletedProcess:
        return subprocess.run(words, cwd=root, env=self.environment(root), input=text, capture_output=True, text=True,
                              timeout=LONGEST_S + 30, check=False)

    def check_shell(self, root: Path, block: Block) -> None:
        pending = []
        for command in block.commands():
            if any(re.match(pattern, command) for pattern, _ in ELSEWHERE):
                script = re.match(r"(?:sudo )?(scripts/\S+)", command)
                self.assertTrue(not script or os.access(SOURCE / script[1], os.X_OK), f"{block.where}: there is no {command}")
                continue
            pending.append(command)
        if not pending:
            return
        for command in self.grouped(pending):
            for old in root.glob("*.tar") if "-OJ" in command else ():
                old.unlink()  # it overwrites nothing
            done = self.run_in(root, ["bash", "-euo", "pipefail", "-c", self.put_real(command)])
            said = f"{block.where}: {command}\nstatus {done.returncode}\n{done.stdout[-500:]}\n{done.stderr[-500:]}"
            allowed = [(0, ""), *((status, words) for pattern, status, words in ENDS if re.match(pattern, command))]
            self.assertTrue(any(done.returncode == status and words in said for status, words in allowed), said)

    @staticmethod
    def grouped(commands: list[str]) -> list[str]:
        """A variable lives as long as its shell: commands from an assignment on are one."""
        for at, command in enumerate(commands):
            if re.match(r"\w+=", command):
                return [*commands[:at], "\n".join(commands[at:])]
        return commands

    def check_python(self, root: Path, block: Block) -> None:
        done = self.run_in(root, [sys.executable, "-"], self.put_real(block.text))
        self.assertEqual(done.returncode, 0, f"{block.where}: {done.stderr}")
        self.assertNotIn("not valid", done.stdout, block.where)

    def check_cpp(self, root: Path, block: Block) -> None:
        (root / "snippet.cpp").write_text(self.put_real(block.text).replace('"8080"', f'"{self.daemon.port}"'))
        private = SOURCE / ".deps/boost/usr/include"
        words = [os.environ.get("CXX", "c++"), "-std=c++20", "-Wall", "-O0", "-isystem", private, "snippet.cpp", "-o", "snippet", "-pthread"]
        done = self.run_in(root, [str(word) for word in words])
        self.assertEqual(done.returncode, 0, f"{block.where}: {done.stderr}")
        done = self.run_in(root, ["./snippet"])
        self.assertEqual(done.returncode, 0, f"{block.where}: {done.stderr}")

    def quiet(self) -> None:
        """Nothing that a document began goes on into the next one."""
        job = self.daemon.pose()["job"]
        if job:
            call(self.daemon.port, "DELETE", f"/api/v1/calibrations/{job}")
            wait_until("the calibration has ended", lambda: not self.daemon.pose()["job"])
        wait_until("the pose is valid", lambda: self.daemon.pose()["valid"], 60)

    def check(self, document: Path, before_each=lambda: None) -> None:
        kinds = {"sh": self.check_shell, "python": self.check_python, "cpp": self.check_cpp}
        blocks = blocks_of(document)
        if not blocks:
            return
        root = self.place(document)
        for block in blocks:
            with self.subTest(block.where):
                before_each()
                kinds[block.language](root, block)

    def test_every_command_of_the_documentation_works(self):
        self.start_cell()
        for document in DOCUMENTS:
            if document != OF_THE_SIMULATOR:
                self.check(document, self.quiet)

    def test_every_command_that_changes_the_simulated_cell_works(self):
        self.start_simulator()
        self.check(OF_THE_SIMULATOR)

    def test_the_client_in_python_says_so_while_there_is_no_pose(self):
        self.daemon = self.serve(self.simulate()).wait_alive()
        self.real = {"127.0.0.1:8080": f"127.0.0.1:{self.daemon.port}"}
        document = SOURCE / "docs/polling.md"
        root = self.place(document)
        clients = [block for block in blocks_of(document) if block.language == "python"]
        self.assertEqual(len(clients), 1)
        done = self.run_in(root, [sys.executable, "-"], self.put_real(clients[0].text))
        self.assertEqual((done.returncode, done.stdout.count("not valid: ")), (0, 3), done.stdout + done.stderr)
        self.assertNotIn("no answer", done.stdout)

    def test_no_command_hides_from_this_test(self):
        hidden = re.compile(r"^    +(?:calibrd|scripts/|curl|cmake|ctest|sudo|docker|git|build/)\S* .*$", re.MULTILINE)
        for document in DOCUMENTS:
            text = re.sub(r"^```.*?^```", "", document.read_text(encoding="utf-8"), flags=re.DOTALL | re.MULTILINE)
            self.assertEqual(hidden.findall(text), [], f"{document.name}: commands stand between ```sh and ```")


if __name__ == "__main__":
    unittest.main()
