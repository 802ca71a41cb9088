#!/usr/bin/env python3
# SPDX-FileCopyrightText: The calibrd authors
# SPDX-License-Identifier: Apache-2.0
"""Who listens to the events hears of a calibration, of a knock and of the healing, and goes on where it was after a break."""

import http.client
import json
import time
import unittest

from cell import SENSOR, CellTest


class Listener:
    """An EventSource: reads events one by one."""

    def __init__(self, port: int, last_id: str = ""):
        self.connection = http.client.HTTPConnection("127.0.0.1", port, timeout=20)
        self.connection.request("GET", "/api/v1/events", headers={"Last-Event-ID": last_id} if last_id else {})
        self.answer = self.connection.getresponse()
        self.last_id = last_id
        self.newest: dict[str, dict] = {}  # data of each kind of event

    def next(self) -> tuple[str, dict]:
        fields: dict[str, str] = {}
        while line := self.answer.readline().decode():
            if line == "\n" and "data" in fields:
                self.last_id = fields.get("id", self.last_id)
                self.newest[fields["event"]] = json.loads(fields["data"])
                return fields["event"], self.newest[fields["event"]]
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
        listener = Listener(daemon.port)
        self.assertFalse(listener.wait("pose", state="uncalibrated")["valid"])
        job = daemon.start_calibration(postures=4).rsplit("/", 1)[1]
        listener.wait("calibration", calibration=job, status="collecting")
        self.assertTrue(listener.wait("calibration", calibration=job, status="succeeded")["current"])
        listener.until("drift", verdict="in_place")
        listener.close()
        simulator.tell("POST", f"/sensors/{SENSOR}/knock", turn_deg=[0, 0, 3.0], shift_m=[0.02, 0.02, 0.01])
        time.sleep(1)  # away while it happens
        listener = Listener(daemon.port, listener.last_id)
        self.assertIn("moved", listener.until("pose", state="drifted")["reason"])
        listener.wait("calibration", status="succeeded")
        listener.close()
        daemon.stop()
        again = self.serve(simulator).wait_ready()
        listener = Listener(again.port, listener.last_id)
        self.assertEqual(listener.next()[0], "reset")
        listener.until("pose", valid=True)
        listener.close()


if __name__ == "__main__":
    unittest.main()
