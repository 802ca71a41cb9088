#!/usr/bin/env python3
# SPDX-FileCopyrightText: The calibrd authors
# SPDX-License-Identifier: Apache-2.0
"""Cuts the daemon off from its controller and its sensor again and again, in every way that a peer can go, and measures
how soon it has them again once they are there, and whether anything of it stays behind.

usage: disconnects.py [N [SEED [controller | sensor]]]     N of the controller and N of the sensor, at the same time (1000), or of one
"""

import json
import os
import random
import signal
import sys
import threading
import time
import unittest

from cell import SENSOR, CellTest, Daemon, Simulator, wait_until
from flaky_wire import FlakyWire
from holdings import Asking, Holdings, children_of

WITHIN_S = 1.0
MORE_MEMORY_KIB = 1024
POLL_S = 0.005
NOTICED_S = 20.0
WARM_UP = 24  # of each: until buffers, logs of events and the allocator's pools are as large as they get
# Nobody throws the daemon out here, however quickly connections end: that pause has a test of its own.
NOT_EVICTED = "robot.link.eviction_within=0s"


class Peer:
    """One that goes and comes back; how long the daemon needed each time (s), by the way it went."""

    def __init__(self, daemon: Daemon, seed: int):
        self.daemon, self.random = daemon, random.Random(seed)
        self.ask = Asking(daemon.port)
        self.took: dict[str, list[float]] = {}
        self.failure: BaseException | None = None

    def run(self, times: int) -> None:
        try:
            for i in range(times):
                kind = self.KINDS[i % len(self.KINDS)]
                self.took.setdefault(kind, []).append(self.lose_and_find(kind))
        except BaseException as failure:  # told by the thread that waits
            self.failure = failure
        finally:
            self.ask.close()  # it is one of the daemon's descriptors

    def wait_for(self, what: str, condition, timeout_s: float = NOTICED_S) -> float:
        wait_until(what, condition, timeout_s, POLL_S)
        return time.monotonic()

    def stay_away(self) -> None:
        """For a random time, so that the daemon is met in every state of its back-off."""
        time.sleep(self.random.uniform(0, 0.7))


class Controller(Peer):
    KINDS = FlakyWire.KINDS

    def __init__(self, daemon: Daemon, wire: FlakyWire, seed: int):
        super().__init__(daemon, seed)
        self.wire = wire

    def link(self) -> dict:
        return self.ask.json("/api/v1/robot")["link"]

    def lose_and_find(self, kind: str) -> float:
        self.wire.break_(kind)
        self.wait_for(f"{kind} is noticed", lambda: self.link()["state"] != "streaming")
        if kind == "half_open":  # it came back as another: the old connection must be given up first
            self.wait_for("the old connection is given up", lambda: self.link()["state"] == "connecting")
        self.stay_away()
        self.wire.mend()
        begin = time.monotonic()
        return self.wait_for(f"joints come after {kind}", lambda: self.link()["state"] == "streaming") - begin


class Sensor(Peer):
    KINDS = ("killed", "unplugged", "killed", "stopped", "killed", "unplugged")

    def __init__(self, daemon: Daemon, simulator: Simulator, seed: int):
        super().__init__(daemon, seed)
        self.simulator = simulator

    def report(self) -> dict:
        return self.ask.json(f"/api/v1/sensors/{SENSOR}")

    def lose_and_find(self, kind: str) -> float:
        before = self.report()["restarts"]
        begin = {"killed": self.kill, "stopped": self.stop, "unplugged": self.unplug}[kind]()

        def streams() -> bool:
            now = self.report()
            return now["health"] == "streaming" and now["restarts"] > before
        return self.wait_for(f"frames come after it was {kind}", streams) - begin

    def child(self) -> int:
        return wait_until("there is a sensor process", lambda: children_of(self.daemon.process.pid))[0]

    def kill(self) -> float:
        os.kill(self.child(), signal.SIGKILL)
        return time.monotonic()

    def stop(self) -> float:
        """From the moment on when the daemon gives it up."""
        child = self.child()
        os.kill(child, signal.SIGSTOP)
        return self.wait_for("a stopped process is given up", lambda: child not in children_of(self.daemon.process.pid))

    def unplug(self) -> float:
        self.simulator.sensor_mode("unplugged")
        self.wait_for("it is missed", lambda: self.report()["health"] != "streaming")
        self.stay_away()
        self.simulator.sensor_mode("normal")
        return time.monotonic()


def lose_all(peers: list[Peer], times: int) -> None:
    threads = [threading.Thread(target=peer.run, args=(times,), daemon=True) for peer in peers]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    for peer in peers:
        if peer.failure:
            raise peer.failure


def settled_holdings(daemon: Daemon, expected: Holdings | None = None) -> Holdings:
    """Once both stream and nothing is under way; where it is known what to expect, some time for it to come."""
    wait_until("both stream", lambda: daemon.get("/readyz").status == 200)

    def equal() -> Holdings | None:
        now = Holdings.of(daemon.process.pid)
        return now if (now.descriptors, now.threads) <= (expected.descriptors, expected.threads) else None
    if expected:
        try:
            return wait_until("nothing is left over", equal, 5)
        except AssertionError:
            pass  # told as growth
    return Holdings.of(daemon.process.pid)


def tell(peers: list[Peer]) -> float:
    slowest = 0.0
    for peer in peers:
        for kind, took in peer.took.items():
            ordered = sorted(took)
            print(json.dumps({"peer": type(peer).__name__.lower(), "how": kind, "times": len(took),
                              "back_after_s_median": round(ordered[len(ordered) // 2], 3),
                              "back_after_s_most": round(ordered[-1], 3)}), flush=True)
            slowest = max(slowest, ordered[-1])
    return slowest


def run(test: CellTest, times: int, seed: int, warm_up: int = WARM_UP, only: str = "") -> tuple[float, dict[str, int]]:
    """How long (s) the daemon was without a peer that was there, at most; and what it holds more than before."""
    def peers_of(seed: int) -> list[Peer]:
        peers = [Controller(daemon, wire, seed), Sensor(daemon, simulator, seed)]
        return [peer for peer in peers if only in ("", type(peer).__name__.lower())]
    simulator = test.simulate()
    wire = FlakyWire(simulator)
    test.addCleanup(wire.close)
    daemon = test.serve(wire, NOT_EVICTED).wait_ready()
    lose_all(peers_of(seed), warm_up)
    before = settled_holdings(daemon)
    peers = peers_of(seed + 1)
    begin = time.monotonic()
    lose_all(peers, times)
    grown = settled_holdings(daemon, before).minus(before)
    slowest = tell(peers)
    print(json.dumps({"losses_of_each": times, "seed": seed, "took_s": round(time.monotonic() - begin),
                      "slowest_s": round(slowest, 3), "grown": grown, "load_average": round(os.getloadavg()[0], 1)}), flush=True)
    return slowest, grown


class Disconnects(CellTest):
    times, seed, only = 1000, 1, ""

    def test_both_are_back_within_a_second_and_nothing_grows(self):
        slowest, grown = run(self, self.times, self.seed, only=self.only)
        self.assertLessEqual(slowest, WITHIN_S)
        self.assertLessEqual(grown["descriptors"], 0)
        self.assertLessEqual(grown["threads"], 0)
        self.assertLessEqual(grown["memory_kib"], MORE_MEMORY_KIB)


if __name__ == "__main__":
    if len(sys.argv) > 1:
        Disconnects.times = int(sys.argv.pop(1))
    if len(sys.argv) > 1:
        Disconnects.seed = int(sys.argv.pop(1))
    if len(sys.argv) > 1:
        Disconnects.only = sys.argv.pop(1)
    unittest.main(verbosity=2)
