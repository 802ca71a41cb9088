# SPDX-FileCopyrightText: The calibrd authors
# SPDX-License-Identifier: Apache-2.0
"""Seeds that are no text, made from what the protocols and formats say: {target: {name: bytes}}."""

import random
import struct
import zlib

JOINTS = [0.1 * i for i in range(10)]


def simple_message(kind: int, body: bytes, order: str, comm: int = 1, reply: int = 0) -> bytes:
    return struct.pack(order + "iiii", 12 + len(body), kind, comm, reply) + body


def feedback(order: str, real: str, group: int, values: list[float]) -> bytes:
    return struct.pack(f"{order}ii{real}" + 30 * real, group, 15, 1.5, *(values + values + values))


def state_stream(order: str, real: str) -> bytes:
    """One message of each kind a controller sends."""
    record = feedback(order, real, 0, JOINTS)
    return b"".join((
        simple_message(10, struct.pack(f"{order}i10{real}", 1, *JOINTS), order),
        simple_message(15, record, order),
        simple_message(13, struct.pack(order + "7i", 1, 0, 0, 0, 0, 2, 1), order),
        simple_message(2017, struct.pack(order + "i", 2) + record + 3 * feedback(order, real, 1, JOINTS), order),
        simple_message(15, feedback(order, real, 0, [float("nan")] * 10), order),
        simple_message(1, b"", order),
        simple_message(77, b"unknown", order),
    ))


def motion_answers(order: str, real: str) -> bytes:
    def answer(command: int, result: int, subcode: int) -> bytes:
        body = struct.pack(f"{order}iiiii10{real}", 0, 1, command, result, subcode, *JOINTS)
        return simple_message(2002, body, order, 3, 1)

    return answer(200101, 0, 0) + answer(200121, 5, 5003) + answer(14, 1, 0) + answer(200111, 9, 4242)


def simple_message_seeds() -> dict[str, bytes]:
    seeds = {}
    for variant, (order, real) in enumerate((("<", "f"), (">", "f"), ("<", "d"), (">", "d"))):
        for piece in (0, 19, 255):
            seeds[f"state_{variant}_{piece}"] = bytes((variant, piece)) + state_stream(order, real)
        seeds[f"ranges_{variant}"] = bytes((variant | 4, 255)) + state_stream(order, real)
        seeds[f"answers_{variant}"] = bytes((variant, 255)) + motion_answers(order, real)
    return seeds


def rtde_package(kind: str, payload: bytes) -> bytes:
    return struct.pack(">Hc", 3 + len(payload), kind.encode()) + payload


def rtde_handshake(protocol: int, types: str) -> bytes:
    recipe = b"\x01" if protocol == 2 else b""
    refusal = rtde_package("V", b"\x00") if protocol == 1 else b""
    return (rtde_package("M", b"\x05Hello\x03URC\x00") + refusal + rtde_package("V", b"\x01")
            + rtde_package("v", struct.pack(">4I", 5, 11, 1, 108318))
            + rtde_package("O", recipe + types.encode()) + rtde_package("S", b"\x01"))


def rtde_data(protocol: int, time_s: float, mode: int = 7) -> bytes:
    recipe = b"\x01" if protocol == 2 else b""
    return rtde_package("U", recipe + struct.pack(">d6d6diI", time_s, *JOINTS[:6], *JOINTS[:6], mode, 1))


def rtde_seeds() -> dict[str, bytes]:
    types = "DOUBLE,VECTOR6D,VECTOR6D,INT32,UINT32"
    seeds = {}
    for protocol in (1, 2):
        data = b"".join(rtde_data(protocol, 0.008 * i) for i in range(4)) + rtde_data(protocol, 1.0, mode=3)
        for piece in (0, 6, 255):
            seeds[f"stream_{protocol}_{piece}"] = bytes((0, piece)) + rtde_handshake(protocol, types) + data
    seeds["ranges"] = b"\x01\xff" + rtde_handshake(2, types) + rtde_data(2, 1.0)
    seeds["back"] = b"\x00\xff" + rtde_handshake(2, types) + rtde_data(2, 1.0) + rtde_data(2, 0.5)
    seeds["missing"] = b"\x00\xff" + rtde_handshake(2, types.replace("INT32", "NOT_FOUND", 1))
    seeds["other_type"] = b"\x00\xff" + rtde_handshake(2, types.replace("UINT32", "DOUBLE"))
    return seeds


def chunk(kind: bytes, data: bytes) -> bytes:
    return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))


def png(width: int, height: int, depth: int, color: int, interlaced: int = 0, extra: bytes = b"",
        level: int = -1) -> bytes:
    channels = {0: 1, 2: 3, 3: 1, 4: 2, 6: 4}[color]
    rng = random.Random(1)
    rows = b"".join(bytes([y % 5]) + rng.randbytes((width * channels * depth + 7) // 8) for y in range(height))
    palette = chunk(b"PLTE", bytes(range(256)) * 3) if color == 3 else b""
    header = struct.pack(">IIBBBBB", width, height, depth, color, 0, 0, interlaced)
    return (b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + palette + extra + chunk(b"IDAT", zlib.compress(rows, level))
            + chunk(b"IEND", b""))


def png_seeds() -> dict[str, bytes]:
    text = chunk(b"tEXt", b"Comment\x00a capture") + chunk(b"zTXt", b"k\x00\x00" + zlib.compress(b"text"))
    kinds = ((16, 0), (8, 0), (4, 0), (2, 0), (1, 0), (8, 2), (16, 2), (8, 3), (2, 3), (8, 4), (16, 4), (8, 6), (16, 6))
    seeds = {f"bits{depth}_color{color}": b"\x01" + png(16, 12, depth, color) for depth, color in kinds}
    # Not compressed: what a fuzzer changes are pixels then, not codes.
    seeds |= {f"stored_bits{depth}_color{color}": b"\x03" + png(16, 12, depth, color, level=0) for depth, color in kinds}
    seeds["text"] = b"\x01" + png(16, 12, 16, 0, extra=text)
    seeds["transparent"] = b"\x01" + png(16, 12, 16, 0, extra=chunk(b"tRNS", b"\x00\x05"))
    seeds["interlaced"] = b"\x02" + png(1, 1, 16, 0, interlaced=1)
    seeds["wide"] = b"\x02" + png(200, 2, 16, 0)
    return seeds


def http_seeds() -> dict[str, bytes]:
    def ask(line: str, body: str = "", *headers: str) -> bytes:
        fields = ["Host: cell", *headers]
        if body:
            fields += ["Content-Type: application/json", f"Content-Length: {len(body)}"]
        return "\r\n".join([line + " HTTP/1.1", *fields, "", body]).encode()

    sensor = "/api/v1/sensors/kinect2"
    gets = [f"{sensor}/pose?format=quaternion&wait=30s", f"{sensor}/drift", f"{sensor}/calibrations?limit=2&before=c1",
            f"{sensor}/clouds/residual?frame=base", f"{sensor}/next-posture?table_height_m=0.2", "/api/v1/calibrations/c1",
            "/api/v1/robot", "/api/v1/robot/motions/m1", "/api/v1/cell/obstacles?sensor=kinect2", "/api/v1/cell/cloud?robot=false",
            "/api/v1/cell/cross-checks", "/api/v1/cell", "/livez", "/readyz?verbose", "/%e2%82%ac/%2F?a=%20+b&&c"]
    seeds = {f"get_{i:02}": bytes((i, 8 * i)) + ask("GET " + path, "", "If-None-Match: *") for i, path in enumerate(gets)}
    seeds["start"] = b"\x00\xff" + ask(f"POST {sensor}/calibrations", '{"postures": 3}', "Idempotency-Key: k1")
    seeds["capture"] = b"\x00\x00" + ask(f"POST {sensor}/captures", '{"timeout_s": 5, "note": "n"}')
    seeds["delete"] = b"\x01\x00" + ask("DELETE /api/v1/calibrations/c1") + ask("OPTIONS /api/v1/cell") + ask("HEAD /livez")
    seeds["chunked"] = (b"\x00\x01POST /api/v1/robot/motions HTTP/1.1\r\nTransfer-Encoding: chunked\r\nExpect: 100-continue\r\n"
                        b"Content-Type: application/json; charset=utf-8\r\n\r\n11;x=y\r\n{\"route\": \"tour\"}\r\n0\r\nT: 1\r\n\r\n")
    return seeds


def sensor_child_seeds() -> dict[str, bytes]:
    text = struct.pack("<H", 7) + b"Kinect2"
    arguments = "--device=\n--recording=\n--speed=1\n--loop=0\n--width=512\n--height=424\n--fps=30\n" \
                "--depth-unit-um=1000\n--image=infrared\n--mirror=1"
    ring = bytes(b for i in range(12) for b in (24 + i, 0, i, 1, 0))
    return {"hello": b"\x00\x01" + struct.pack("<I", 1),
            "streaming": b"\x00\x02" + text + text + struct.pack("<HHHI", 512, 424, 30, 1000),
            "failure": b"\x00\x03" + struct.pack("<H", 6) + text,
            "arguments": b"\x01" + arguments.encode(), "ring": b"\x02\x01" + ring, "ring_depth": b"\x02\x00" + ring}


def mesh_seeds() -> dict[str, bytes]:
    facets = b"".join(struct.pack("<12fH", 0, 0, 1, i, 0, 0, i + 1, 0, 0, i, 1, 0, 0) for i in range(3))
    return {"binary_stl": b"\x00" + b"calibrd".ljust(80, b"\x00") + struct.pack("<I", 3) + facets}


def capture_seeds(document: bytes) -> dict[str, bytes]:
    """The recording of the corpus, whose second image comes with it."""
    return {"with_image": document + b"\n%png\n" + png(16, 12, 16, 0), "colour": document + b"\n%png\n" + png(16, 12, 8, 2)}


def all_seeds(capture_document: bytes) -> dict[str, dict[str, bytes]]:
    return {"simple_message": simple_message_seeds(), "rtde": rtde_seeds(), "png": png_seeds(), "http_request": http_seeds(),
            "sensor_child": sensor_child_seeds(), "mesh": mesh_seeds(), "capture": capture_seeds(capture_document)}
