# SPDX-FileCopyrightText: The calibrd authors
# SPDX-License-Identifier: Apache-2.0
"""A TCP wire between the daemon and the simulated controller that comes apart in all the ways wires and peers do."""

import contextlib
import selectors
import socket
import struct
import threading

RESET_ON_CLOSE = struct.pack("ii", 1, 0)
READ_AT_ONCE = 4096


def reset(connection: socket.socket) -> None:
    """Closes with RST instead of FIN."""
    connection.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, RESET_ON_CLOSE)
    connection.close()


class FlakyWire:
    """Carries each connection of the daemon to the controller until it is told to break; to the daemon it is a simulator.
    What `break_` is given, and what the client sees until `mend`:

    fin          the connection is closed; new ones are closed as soon as they are accepted
    rst          the connection is reset; new ones, too
    mid_message  half of a message, then the connection is closed; new ones, too
    refused      the connection is closed; new ones are refused
    silent       nothing comes any more; new connections are accepted, nothing comes there either
    half_open    nothing comes any more, and never will on that connection; new ones are not answered at all
    """

    KINDS = ("fin", "rst", "mid_message", "refused", "silent", "half_open")

    def __init__(self, simulator):
        self.server_port, self.world_file = simulator.controller_port, simulator.world_file
        self.broken: str | None = None
        self.links: dict[socket.socket, socket.socket | None] = {}  # client: server; None: there is none behind it
        self.dead: list[socket.socket] = []  # held open, and never looked at again
        self.accepted = 0
        self.listener = self.listen(0)
        self.controller_port = self.listener.getsockname()[1]
        self.lock = threading.RLock()
        self.ending = False
        self.selector = selectors.DefaultSelector()
        self.selector.register(self.listener, selectors.EVENT_READ)
        self.thread = threading.Thread(target=self.carry, daemon=True)
        self.thread.start()

    def listen(self, port: int, backlog: int = 64) -> socket.socket:
        listener = socket.socket()
        listener.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        listener.bind(("127.0.0.1", port))
        listener.listen(backlog)
        listener.setblocking(False)
        return listener

    def close(self) -> None:
        self.ending = True
        self.thread.join()
        with self.lock:
            self.drop_all(reset)
            self.forget_dead()
            self.listener.close()

    # What happens to it.

    def break_(self, kind: str) -> None:
        assert kind in self.KINDS and self.broken is None
        with self.lock:
            self.broken = kind
            if kind == "fin":
                self.drop_all(socket.socket.close)
            elif kind == "rst":
                self.drop_all(reset)
            elif kind == "mid_message":
                self.cut_a_message()
            elif kind == "silent":
                self.leave_the_server()
            elif kind == "refused":
                self.stop_listening()
                self.drop_all(socket.socket.close)
            elif kind == "half_open":
                self.stop_listening()
                self.abandon_all()
                self.answer_nobody()

    def mend(self) -> None:
        with self.lock:
            kind, self.broken = self.broken, None
            if kind == "silent":
                for client in [c for c, server in self.links.items() if server is None]:
                    self.connect(client)
            elif kind in ("refused", "half_open"):
                self.stop_listening()
                self.forget_dead()
                self.listener = self.listen(self.controller_port)
                self.selector.register(self.listener, selectors.EVENT_READ)

    # How.

    def carry(self) -> None:
        while not self.ending:
            for key, _ in self.selector.select(0.02):
                with self.lock, contextlib.suppress(OSError, KeyError, ValueError):
                    if key.fileobj is self.listener:
                        self.accept()
                    elif key.fileobj.fileno() >= 0:
                        self.forward(key.fileobj, key.data)

    def accept(self) -> None:
        client = self.listener.accept()[0]
        self.accepted += 1
        if self.broken in ("fin", "mid_message"):
            return client.close()
        if self.broken == "rst":
            return reset(client)
        self.links[client] = None
        self.selector.register(client, selectors.EVENT_READ, client)
        if self.broken is None:
            self.connect(client)

    def connect(self, client: socket.socket) -> None:
        self.links[client] = server = socket.create_connection(("127.0.0.1", self.server_port))
        self.selector.register(server, selectors.EVENT_READ, client)

    def forward(self, source: socket.socket, client: socket.socket) -> None:
        data = source.recv(READ_AT_ONCE)
        target = client if source is not client else self.links[client]
        if not data:
            self.drop(client, socket.socket.close)
        elif target is not None:
            target.sendall(data)

    def leave_the_server(self) -> None:
        """What it sends meanwhile is nobody's; afterwards a message is begun anew."""
        for client, server in self.links.items():
            if server is not None:
                self.selector.unregister(server)
                server.close()
                self.links[client] = None

    def cut_a_message(self) -> None:
        for client, server in list(self.links.items()):
            with contextlib.suppress(OSError):
                server.settimeout(1.0)
                client.sendall(server.recv(READ_AT_ONCE)[:25])
            self.drop(client, socket.socket.close)

    def drop(self, client: socket.socket, how) -> None:
        server = self.links.pop(client, None)
        for end in (client, server):
            if end is not None:
                self.selector.unregister(end)
                how(end) if end is client else end.close()

    def drop_all(self, how) -> None:
        for client in list(self.links):
            self.drop(client, how)

    def abandon_all(self) -> None:
        for client in list(self.links):
            server = self.links.pop(client)
            self.selector.unregister(client)
            self.dead.append(client)
            if server is not None:
                self.selector.unregister(server)
                server.close()

    def stop_listening(self) -> None:
        with contextlib.suppress(KeyError, ValueError):  # it may be closed already
            self.selector.unregister(self.listener)
        self.listener.close()

    def answer_nobody(self) -> None:
        """A full queue of connections: the kernel drops further requests without a word."""
        self.listener = self.listen(self.controller_port, backlog=0)
        for _ in range(4):
            filler = socket.socket()
            filler.setblocking(False)
            filler.connect_ex(("127.0.0.1", self.controller_port))
            self.dead.append(filler)

    def forget_dead(self) -> None:
        for connection in self.dead:
            connection.close()
        self.dead.clear()
