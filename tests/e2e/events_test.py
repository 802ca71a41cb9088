#!/usr/bin/env python3
# SPDX-FileCopyrightText: The calibrd authors
# SPDX-License-Identifier: Apache-2.0
"""Who listens to the events hears of a calibration, of a knock and of the healing, and goes on where it was after a break."""

import http.client
import json
import time
import unittest

from cell import SENSOR, CellTest, Daemon
from contract import Contract


class Listener:
    """An EventSource: reads events one by one, and holds each against the document of the interface."""

    def __init__(self, daemon: Daemon, last_id: str = ""):
        self.contract = Contract(daemon.json("/openapi.json"))
        self.connection = http.client.HTTPConnection("127.0.0.1", daemon.port, timeout=20)
        self.connection.request("GET", "/api/v1/events?joints=true", headers={"Last-Event-ID": last_id} if last_id else {})
        self.answer = self.connection.getresponse()
        self.last_id = last_id
        self.joints_heard = 0
        self.newest: dict[str, dict] = {}  # data of each kind of event

    def next(self) -> tuple[str, dict]:
        fields: dict[str, str] = {}
        while line := self.answer.readline().decode():
            if line == "\n" and "data" in fields:
                self.last_id = fields.get("id", self.last_id)
                event, data = fields["event"], json.loads(fields["data"])
                self.contract.check_event("streamEvents", event, data)
                fields = {}
                if event == "joints":  # 30 a second, between all others
                    self.joints_heard += 1
                    continue
                self.newest[event] = data
                return event, data
            name, _, value = line.rstrip("\n").partition(": ")
            if name:
                fields[name] = value
        raise AssertionError("the stream has ended")

    def wait(self, event: str, timeout_s: float = 60, **wanted) -> dict:
        """The next event of this name whose data have these values."""
        deadline, heard = time.monotonic() + timeout_s, []
        while time.monotonic() < deadline:
            name, data = self.next()
            heard.append((name, data))
            if name == event and all(data[key] == value for key, value in wanted.items()):
                return data
        raise AssertionError(f"no {event} with {wanted}; heard {heard[-20:]}")

    def until(self, event: str, **wanted) -> dict:
        """As wait(), but what was heard last counts, too."""
        now = self.newest.get(event)
        return now if now and all(now[key] == value for key, value in wanted.items()) else self.wait(event, **wanted)

    def close(self) -> None:
        self.connection.close()


class Events(CellTest):
    def test_what_happens_is_told_in_its_order_and_resumed_after_a_break(self):
        simulator = self.simulate()
        simulator.hurry()
        daemon = self.serve(simulator).wait_ready()
        listener = Listener(daemon)
        self.assertFalse(listener.wait("pose", state="uncalibrated")["valid"])
        job = daemon.start_calibration(postures=4).rsplit("/", 1)[1]
        listener.wait("calibration", calibration=job, status="collecting")
        self.assertTrue(listener.wait("calibration", calibration=job, status="succeeded")["current"])
        listener.until("drift", verdict="in_place")
        self.assertGreater(listener.joints_heard, 0)
        listener.close()
        simulator.tell("POST", f"/sensors/{SENSOR}/knock", turn_deg=[0, 0, 3.0], shift_m=[0.02, 0.02, 0.01])
        time.sleep(1)  # away while it happens
        listener = Listener(daemon, listener.last_id)
        self.assertIn("moved", listener.until("pose", state="drifted")["reason"])
        listener.wait("calibration", status="succeeded")
        listener.close()
        daemon.stop()
        again = self.serve(simulator).wait_ready()
        listener = Listener(again, listener.last_id)
        self.assertEqual(listener.next()[0], "reset")
        listener.until("pose", valid=True)
        listener.close()


if __name__ == "__main__":
    unittest.main()
