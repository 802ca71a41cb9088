# SPDX-FileCopyrightText: The calibrd authors
# SPDX-License-Identifier: Apache-2.0
"""Starts the programs of calibrd in a folder of their own and speaks to them as their users do."""

import contextlib
import http.client
import json
import os
import signal
import socket
import subprocess
import tempfile
import time
import unittest
from pathlib import Path

SOURCE = Path(__file__).resolve().parents[2]
BUILD = Path(os.environ.get("CALIBRD_BUILD", SOURCE / "build/release"))
BIN = BUILD / "bin"
ROBOTS = BUILD / "share/calibrd/robots"
URDF = ROBOTS / "demo_arm7/urdf/demo_arm7.urdf"
SIX_AXES = BUILD / "tests/robots/test_arm6/urdf/test_arm6.urdf"
SENSOR = "kinect2"
OF_THIS_BUILD = (f"robot.urdf={URDF}", f"sensors.{SENSOR}.driver_directory={BUILD / 'lib/calibrd-sim-openni'}")


def free_port() -> int:
    with socket.create_server(("127.0.0.1", 0)) as listener:
        return listener.getsockname()[1]


# Under a sanitizer programs are many times slower: so much longer is waited, and more time is allowed.
SLOWNESS = float(os.environ.get("CALIBRD_SLOWNESS", "1"))


def wait_until(what: str, condition, timeout_s: float = 30.0, period_s: float = 0.05):
    """The first true answer of `condition`. A refused connection counts as not yet."""
    timeout_s *= SLOWNESS
    deadline, last = time.monotonic() + timeout_s, None
    while time.monotonic() < deadline:
        with contextlib.suppress(OSError, http.client.HTTPException):
            last = condition()
            if last:
                return last
        time.sleep(period_s)
    raise AssertionError(f"waited {timeout_s:.0f} s for: {what}; last answer: {last}")


class Answer:
    def __init__(self, response: http.client.HTTPResponse):
        self.status, self.headers, self.body = response.status, response.headers, response.read()

    def json(self):
        return json.loads(self.body)


def call(port: int, method: str, path: str, body=None, timeout_s: float = 30.0) -> Answer:
    connection = http.client.HTTPConnection("127.0.0.1", port, timeout=timeout_s)
    with contextlib.closing(connection):
        text = None if body is None else json.dumps(body)
        connection.request(method, path, text, {"Content-Type": "application/json"} if text else {})
        return Answer(connection.getresponse())


class Program:
    """A running program; its output goes to files in `folder`."""

    def __init__(self, name: str, folder: Path, *arguments, env: dict[str, str] | None = None):
        self.name = name
        self.log = folder / f"{name}.log"
        with self.log.open("w") as log:
            self.process = subprocess.Popen([BIN / name, *map(str, arguments)], cwd=folder, stdin=subprocess.DEVNULL,
                                            stdout=subprocess.DEVNULL, stderr=log, env={**os.environ, **(env or {})})

    def alive(self) -> bool:
        return self.process.poll() is None

    def output(self) -> str:
        return self.log.read_text(errors="replace")

    def stop(self, patience_s: float = 10.0) -> float:
        """Asks it to end and returns how long that took (s); kills it when it does not."""
        start = time.monotonic()
        if self.alive():
            self.process.send_signal(signal.SIGTERM)
        try:
            self.process.wait(patience_s)
        except subprocess.TimeoutExpired:
            self.process.kill()
            self.process.wait()
            raise AssertionError(f"{self.name} did not end within {patience_s} s of SIGTERM:\n{self.output()}") from None
        return time.monotonic() - start


class Simulator(Program):
    """The simulated cell: controller, and the world that the simulated sensor looks into."""

    def __init__(self, folder: Path, controller_port: int = 0, world: Path = SOURCE / "config/demo_cell/world.json",
                 urdf: Path = URDF):
        self.world_file, ready = folder / "world", folder / "simulator.ready"
        ready.unlink(missing_ok=True)
        super().__init__("calibrd-sim", folder, "run", "--world", world, "--urdf", urdf, "--models", urdf.parents[2],
                         "--world-file", self.world_file, "--controller-port", controller_port, "--control-port", 0,
                         "--ready-file", ready)
        wait_until("the simulator is ready", lambda: ready.exists() or not self.alive())
        if not self.alive():
            raise AssertionError(f"the simulator ended:\n{self.output()}")
        ports = dict(word.split("=") for word in ready.read_text().split()[1:])
        self.controller_port = int(ports["controller"].split(":")[1])
        self.motion_port = int(ports["motion"].split(":")[1])
        self.control_port = int(ports["control"].split(":")[1])

    def tell(self, method: str, path: str, **body) -> dict:
        answer = call(self.control_port, method, path, body)
        if answer.status != 200:
            raise AssertionError(f"{method} {path} {body}: {answer.status} {answer.body.decode()}")
        return answer.json()

    def truth(self, at_ns: int | None = None) -> dict:
        return call(self.control_port, "GET", "/truth" + (f"?at_ns={at_ns}" if at_ns else "")).json()

    def true_pose(self) -> list[list[float]]:
        return next(s for s in self.truth()["sensors"] if s["id"] == SENSOR)["T_base_sensor"]

    def hurry(self) -> None:
        """Lets the robot go from posture to posture faster than the demo cell's does."""
        self.tell("PUT", "/motion", mode="run", seed=11, count=12, speed_rad_s=2.0, hold_s=0.8)

    def sensor_mode(self, mode: str) -> None:
        self.tell("PUT", f"/sensors/{SENSOR}/mode", mode=mode)

    def controller_mode(self, mode: str) -> None:
        self.tell("PUT", "/controller", mode=mode)


class Daemon(Program):
    """calibrd with the demo's configuration; `settings` are section.key=value."""

    def __init__(self, folder: Path, controller_port: int, world_file: Path, *settings: str,
                 config: Path = SOURCE / "config/demo.toml", of_demo: bool = True):
        self.port = free_port()
        own = (f"server.port={self.port}", f"robot.port={controller_port}", f"storage.path={folder / 'calibrd.db'}",
               *(OF_THIS_BUILD if of_demo else OF_THIS_BUILD[:1]))
        options = [word for setting in (*own, *settings) for word in ("--set", setting)]
        super().__init__("calibrd", folder, "serve", "--config", config, *options,
                         env={"CALIBRD_SIM_WORLD": str(world_file)})

    def wait_alive(self) -> "Daemon":
        wait_until("the daemon answers", lambda: not self.alive() or self.get("/livez").status == 200)
        if not self.alive():
            raise AssertionError(f"the daemon ended with {self.process.returncode}:\n{self.output()}")
        return self

    def wait_ready(self, timeout_s: float = 30.0) -> "Daemon":
        self.wait_alive()
        wait_until("robot and sensor are up", lambda: self.get("/readyz").status == 200, timeout_s)
        return self

    def get(self, path: str) -> Answer:
        return call(self.port, "GET", path)

    def json(self, path: str) -> dict:
        answer = self.get(path)
        if answer.status != 200:
            raise AssertionError(f"GET {path}: {answer.status} {answer.body.decode()}")
        return answer.json()

    def robot(self) -> dict:
        return self.json("/api/v1/robot")

    def sensor(self) -> dict:
        return self.json(f"/api/v1/sensors/{SENSOR}")

    def pose(self) -> dict:
        return self.json(f"/api/v1/sensors/{SENSOR}/pose")

    def start_calibration(self, **body) -> str:
        answer = call(self.port, "POST", f"/api/v1/sensors/{SENSOR}/calibrations", body)
        if answer.status != 202:
            raise AssertionError(f"calibration refused: {answer.status} {answer.body.decode()}")
        return answer.headers["Location"]

    def wait_calibration(self, location: str, timeout_s: float = 240.0) -> dict:
        ended = ("succeeded", "failed", "cancelled")
        return wait_until("the calibration ends", timeout_s=timeout_s, period_s=0.2, condition=lambda: (
            job if (job := self.json(location))["status"] in ended else None))

    def calibrate(self, **body) -> dict:
        return self.wait_calibration(self.start_calibration(**body))


class CellTest(unittest.TestCase):
    """A test with programs of its own, in a folder of its own; all of them end with it."""

    def setUp(self):
        self.folder = Path(self.enterContext(tempfile.TemporaryDirectory(prefix="calibrd-e2e-")))
        self.programs: list[Program] = []
        self.addCleanup(self.end_programs)

    def end_programs(self):
        for program in reversed(self.programs):
            if program.alive():
                program.process.kill()
                program.process.wait()
            print(f"--- end of the log of {program.name}, {self.id()}\n{program.output()[-3000:]}")  # ctest hides it

    def simulate(self, controller_port: int = 0) -> Simulator:
        self.programs.append(Simulator(self.folder, controller_port))
        return self.programs[-1]

    def serve(self, simulator: Simulator, *settings: str) -> Daemon:
        self.programs.append(Daemon(self.folder, simulator.controller_port, simulator.world_file, *settings))
        return self.programs[-1]
