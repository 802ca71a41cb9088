#!/usr/bin/env python3
# SPDX-FileCopyrightText: The calibrd authors
# SPDX-License-Identifier: Apache-2.0
"""The daemon ends within a second of SIGTERM, whatever it is doing."""

import os
import socket
import unittest
from pathlib import Path

from cell import SENSOR, CellTest, call, wait_until

MAX_S = 1.0


def children_of(pid: int) -> set[int]:
    return {int(child) for task in Path(f"/proc/{pid}/task").iterdir() for child in (task / "children").read_text().split()}


class Shutdown(CellTest):
    def setUp(self):
        super().setUp()
        self.simulator = self.simulate()

    def expect_ends(self, daemon):
        children = children_of(daemon.process.pid)
        took = daemon.stop()
        print(f"{self.id()}: ended {took:.3f} s after SIGTERM")
        self.assertLess(took, MAX_S)
        self.assertEqual(daemon.process.returncode, 0, daemon.output())
        wait_until("its children are gone", lambda: not any(os.path.exists(f"/proc/{c}") for c in children), 2)

    def test_while_it_starts(self):
        daemon = self.serve(self.simulator)
        wait_until("it opens its port", lambda: daemon.get("/livez").status == 200, period_s=0.002)
        self.expect_ends(daemon)

    def test_while_it_streams(self):
        self.expect_ends(self.serve(self.simulator).wait_ready())

    def test_while_robot_and_sensor_are_off(self):
        self.simulator.controller_mode("refuse")
        self.simulator.sensor_mode("unplugged")
        self.expect_ends(self.serve(self.simulator).wait_alive())

    def test_while_the_sensor_hangs(self):
        daemon = self.serve(self.simulator).wait_ready()
        self.simulator.sensor_mode("hanging")
        wait_until("frames stop", lambda: daemon.sensor()["health"] != "streaming")
        self.expect_ends(daemon)

    def test_while_a_client_holds_connections_open(self):
        daemon = self.serve(self.simulator).wait_ready()
        idle = [socket.create_connection(("127.0.0.1", daemon.port)) for _ in range(5)]
        idle[0].sendall(b"GET /livez HTTP/1.1\r\nHost: half")
        self.expect_ends(daemon)
        for connection in idle:
            connection.close()

    def test_while_it_collects_postures(self):
        daemon = self.serve(self.simulator).wait_ready()
        location = daemon.start_calibration(postures=50)
        wait_until("it collects", lambda: daemon.json(location)["status"] == "collecting")
        self.expect_ends(daemon)

    def test_while_it_computes(self):
        self.simulator.hurry()
        daemon = self.serve(self.simulator).wait_ready()
        location = daemon.start_calibration()
        wait_until("it computes", lambda: daemon.json(location)["status"] == "running", 120, period_s=0.005)
        self.expect_ends(daemon)

    def test_while_it_records(self):
        daemon = self.serve(self.simulator).wait_ready()
        body = b'{"postures": 50, "timeout_s": 600}'
        recording = socket.create_connection(("127.0.0.1", daemon.port))
        recording.sendall(b"POST /api/v1/sensors/%s/captures HTTP/1.1\r\nHost: a\r\nContent-Type: application/json\r\n"
                          b"Content-Length: %d\r\n\r\n%s" % (SENSOR.encode(), len(body), body))
        self.assertEqual(call(daemon.port, "GET", "/livez").status, 200)
        self.expect_ends(daemon)
        recording.close()


if __name__ == "__main__":
    unittest.main(verbosity=2)
