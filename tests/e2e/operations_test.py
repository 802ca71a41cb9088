#!/usr/bin/env python3
# SPDX-FileCopyrightText: The calibrd authors
# SPDX-License-Identifier: Apache-2.0
"""What an operator leans on: metrics, logs with request and job, readiness by dependency, the service manager, bundles."""

import contextlib
import ctypes
import http.client
import io
import json
import os
import re
import signal
import socket
import subprocess
import tarfile
import time
import unittest
from pathlib import Path
from unittest import mock

from cell import BIN, OF_THIS_BUILD, SENSOR, SOURCE, CellTest, Daemon, wait_until
from prometheus import Metrics

PTRACE_DETACH, PTRACE_SEIZE, PTRACE_INTERRUPT = 17, 0x4206, 0x4207
WAIT_ALL = 0x40000000  # __WALL: also for threads


def scrape(daemon: Daemon) -> Metrics:
    answer = daemon.get("/metrics")
    if answer.status != 200 or answer.headers["Content-Type"] != "text/plain; version=0.0.4; charset=utf-8":
        raise AssertionError(f"/metrics: {answer.status} {answer.headers}")
    return Metrics(answer.body.decode())


def ask(daemon: Daemon, method: str, path: str, **headers: str) -> http.client.HTTPResponse:
    connection = http.client.HTTPConnection("127.0.0.1", daemon.port, timeout=10)
    with contextlib.closing(connection):
        connection.request(method, path, headers={name.replace("_", "-"): value for name, value in headers.items()})
        answer = connection.getresponse()
        answer.read()
        return answer


@contextlib.contextmanager
def halted(process: int, thread: str):
    """Stops one thread of a process, by its name, as one that hangs: the others go on."""
    trace = ctypes.CDLL(None, use_errno=True).ptrace
    trace.argtypes = [ctypes.c_long, ctypes.c_long, ctypes.c_void_p, ctypes.c_void_p]
    task = next(int(path.parent.name) for path in Path(f"/proc/{process}/task").glob("*/comm")
                if path.read_text().strip() == thread)
    for request in (PTRACE_SEIZE, PTRACE_INTERRUPT):
        if trace(request, task, None, None) != 0:
            raise unittest.SkipTest(f"this machine does not let a thread be stopped: {os.strerror(ctypes.get_errno())}")
    os.waitpid(task, WAIT_ALL)
    try:
        yield
    finally:
        trace(PTRACE_DETACH, task, None, None)


class ServiceManager:
    """The receiving end of NOTIFY_SOCKET."""

    def __init__(self, address: str):
        self.socket = socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM)
        self.socket.bind("\0" + address[1:] if address.startswith("@") else address)

    def wait(self, beginning: str, timeout_s: float = 20) -> str:
        """The next word that begins so."""
        heard, deadline = [], time.monotonic() + timeout_s
        while (left := deadline - time.monotonic()) > 0:
            self.socket.settimeout(left)
            with contextlib.suppress(TimeoutError):
                heard.append(self.socket.recv(4096).decode())
                if heard[-1].startswith(beginning):
                    return heard[-1]
        raise AssertionError(f"no {beginning} within {timeout_s} s; heard {heard[-20:]}")

    def silence(self) -> None:
        """Reads what is there already, then until nothing has been heard for two seconds."""
        self.socket.settimeout(2)
        deadline = time.monotonic() + 20
        with contextlib.suppress(TimeoutError):
            while time.monotonic() < deadline:
                self.socket.recv(4096)
            raise AssertionError("it goes on pinging")


class Operations(CellTest):
    def started(self, *settings: str):
        simulator = self.simulate()
        simulator.hurry()
        return simulator, self.serve(simulator, *settings).wait_ready()

    def test_metrics_and_logs_follow_a_calibration(self):
        _, daemon = self.started("log.format=json")
        before = scrape(daemon)
        self.assertEqual(before.value("calibrd_pose_valid", sensor=SENSOR), 0)
        self.assertEqual(before.value("calibrd_robot_connected"), 1)
        asked = ask(daemon, "POST", f"/api/v1/sensors/{SENSOR}/calibrations", X_Request_Id="shift-42")
        self.assertEqual((asked.status, asked.headers["X-Request-Id"]), (202, "shift-42"))
        location = asked.headers["Location"]
        self.assertEqual(daemon.wait_calibration(location)["status"], "succeeded")
        self.assertEqual(ask(daemon, "GET", "/no/such/path").status, 404)
        after = wait_until("the metrics say valid", lambda: (
            now if (now := scrape(daemon)).value("calibrd_pose_valid", sensor=SENSOR) == 1 else None))
        self.check_growth(before, after)
        self.check_lines(daemon, location.rsplit("/", 1)[1])

    def check_growth(self, before: Metrics, after: Metrics):
        for name in ("calibrd_sensor_frames_total", "calibrd_sensor_views_total"):
            self.assertGreater(after.value(name, sensor=SENSOR), before.value(name, sensor=SENSOR), name)
        self.assertGreater(after.value("calibrd_robot_joint_messages_total"), before.value("calibrd_robot_joint_messages_total"))
        self.assertEqual(after.value("calibrd_calibrations_total", sensor=SENSOR, result="succeeded"), 1)
        self.assertEqual(after.value("calibrd_calibration_duration_seconds_count", sensor=SENSOR), 1)
        self.assertEqual(after.value("calibrd_pose_state", sensor=SENSOR, state="calibrated"), 1)
        self.assertLess(after.value("calibrd_pose_sigma_position_meters", sensor=SENSOR), 0.002)
        self.assertAlmostEqual(after.value("calibrd_pose_calibrated_timestamp_seconds", sensor=SENSOR), time.time(), delta=120)
        self.assertGreater(after.value("calibrd_drift_threshold", sensor=SENSOR), 0)
        self.assertGreater(after.value("calibrd_storage_database_bytes"), 4096)
        self.assertGreater(after.value("process_threads"), 5)
        self.assertEqual(after.value("calibrd_http_requests_total", route="unmatched", method="any", status="404"), 1)
        self.assertEqual(after.value("calibrd_http_requests_total", route="/api/v1/sensors/{id}/calibrations", method="POST",
                                     status="202"), 1)
        self.assertFalse({value for value in after.label_values("route") if "such" in value or SENSOR in value})

    def check_lines(self, daemon: Daemon, job: str):
        lines = [json.loads(line) for line in daemon.output().splitlines()]
        of_job = [line["message"] for line in lines if line.get("job_id") == job]
        self.assertTrue(any("asked for" in message for message in of_job), of_job)
        self.assertTrue(any("succeeded" in message for message in of_job), of_job)
        of_request = [line["message"] for line in lines if line.get("request_id") == "shift-42"]
        self.assertEqual(sorted(of_job), sorted(of_request))

    def test_every_answer_names_its_request(self):
        _, daemon = self.started("log.format=json", "log.level=debug")
        for path, status in (("/livez", 200), ("/nothing", 404), (f"/api/v1/sensors/{SENSOR}/calibrations", 200)):
            made, bad = ask(daemon, "GET", path), ask(daemon, "GET", path, X_Request_Id="a b")
            self.assertEqual((made.status, bad.status), (status, status))
            for answer in (made, bad):
                self.assertRegex(answer.headers["X-Request-Id"], re.compile(r"^[A-Za-z0-9._-]{1,64}$"))
            wait_until("the log names it", lambda: any(
                line.get("request_id") == made.headers["X-Request-Id"] and path in line["message"]
                for line in map(json.loads, daemon.output().splitlines())))

    def test_what_is_missing_is_named_while_the_process_lives(self):
        simulator, daemon = self.started()
        simulator.sensor_mode("unplugged")
        simulator.controller_mode("refuse")
        wait_until("both are missed", lambda: {d["name"] for d in daemon.get("/readyz?verbose").json()["dependencies"]
                                               if not d["ready"]} == {"robot", f"sensor {SENSOR}"})
        answer = daemon.get("/readyz?verbose")
        self.assertEqual(answer.status, 503)
        self.assertTrue(all(d["reason"] for d in answer.json()["dependencies"] if not d["ready"]))
        self.assertEqual(daemon.get("/livez").status, 200)
        metrics = scrape(daemon)
        self.assertEqual(metrics.value("calibrd_sensor_health", sensor=SENSOR, health="streaming"), 0)
        self.assertEqual(metrics.value("calibrd_robot_connected"), 0)
        simulator.sensor_mode("normal")
        simulator.controller_mode("normal")
        daemon.wait_ready(60)

    def test_the_service_manager_is_told_and_pinged_only_while_every_thread_goes_on(self):
        address = f"@calibrd-e2e-{os.getpid()}"
        manager = ServiceManager(address)
        with mock.patch.dict(os.environ, NOTIFY_SOCKET=address, WATCHDOG_USEC="2000000"):
            os.environ.pop("WATCHDOG_PID", None)
            _, daemon = self.started()
        manager.wait("READY=1")
        self.assertIn("robot streaming", manager.wait("STATUS=robot streaming"))
        manager.wait("WATCHDOG=1")
        for thread in ("http", "robot link", f"sensor {SENSOR}"):
            with self.subTest(thread), halted(daemon.process.pid, thread):
                manager.silence()
            manager.wait("WATCHDOG=1")
            self.assertIn(f"thread {thread} does not go on", daemon.output())
        daemon.process.send_signal(signal.SIGHUP)
        self.assertIn("MONOTONIC_USEC=", manager.wait("RELOADING=1"))
        manager.wait("READY=1")
        daemon.process.terminate()
        manager.wait("STOPPING=1")
        daemon.process.wait(10)

    def test_a_bundle_is_made_with_and_without_a_daemon(self):
        _, daemon = self.started("log.format=json")
        files = self.bundle(daemon)
        for name in ("version.txt", "config.toml", "readyz.json", "cell.json", "log.txt", "captures.txt", "README.txt",
                     f"sensors/{SENSOR}/pose.json", f"sensors/{SENSOR}/drift.json", f"sensors/{SENSOR}/calibrations.json"):
            self.assertIn(name, files)
        Metrics(files["metrics.txt"])
        self.assertTrue(json.loads(files["readyz.json"])["ready"])
        self.assertIn("frames are coming in", files["log.txt"])
        self.assertIn(f"port = {daemon.port}", files["config.toml"])
        answer = daemon.get("/api/v1/support_bundle")
        self.assertLess(len(answer.body), 2_000_000)
        self.assertIn("calibrd-support-", answer.headers["Content-Disposition"])
        daemon.stop()
        files = self.bundle(daemon)
        self.assertIn("did not answer", files["daemon.txt"])
        self.assertIn("calibrd.db", files["storage.txt"])

    def bundle(self, daemon: Daemon) -> dict[str, str]:
        settings = (*OF_THIS_BUILD, f"server.port={daemon.port}", f"storage.path={self.folder / 'calibrd.db'}")
        options = [word for setting in settings for word in ("--set", setting)]
        made = subprocess.run([BIN / "calibrd", "support-bundle", "--config", SOURCE / "config/demo.toml", *options],
                              cwd=self.folder, capture_output=True, text=True, timeout=60, check=False)
        self.assertEqual(made.returncode, 0, made.stderr)
        file = self.folder / made.stdout.strip()
        self.assertEqual(file.stat().st_mode & 0o077, 0)
        with tarfile.open(fileobj=io.BytesIO(file.read_bytes())) as tar:
            return {member.name.split("/", 1)[1]: tar.extractfile(member).read().decode() for member in tar.getmembers()}


if __name__ == "__main__":
    unittest.main()
