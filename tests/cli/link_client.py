#!/usr/bin/env python3
"""A client of `spinaltap link` that knows nothing of it but OpenIGTLink's protocol: Python's standard library alone.

link_client.py PORT --from X,Y,Z --to X,Y,Z: moves the tool there at a steady rate (places in RAS, mm; the bit points
along the way), times each pose until its bit comes back, and prints what it got as JSON.
"""
import argparse
import json
import select
import socket
import struct
import time

HEADER = struct.Struct(">H12s20sQQQ")


def crc_table():
    table = []
    for byte in range(256):
        value = byte << 56
        for _ in range(8):
            value = ((value << 1) ^ 0x42F0E1EBA9EA3693 if value >> 63 else value << 1) & 0xFFFFFFFFFFFFFFFF
        table.append(value)
    return table


TABLE = crc_table()


def crc64(body):
    """CRC-64/ECMA-182."""
    value = 0
    for byte in body:
        value = (TABLE[(value >> 56) ^ byte] ^ (value << 8)) & 0xFFFFFFFFFFFFFFFF
    return value


assert crc64(b"123456789") == 0x6C40DF5F0B497347


def pack(kind, device, body, stamp=0):
    return HEADER.pack(1, kind.encode(), device.encode(), stamp, len(body), crc64(body)) + body


def pack_string(device, text):
    return pack("STRING", device, struct.pack(">HH", 3, len(text)) + text.encode())


def axes_along(direction):
    """Three columns of a rotation whose z is the direction."""
    length = sum(x * x for x in direction) ** 0.5
    z = [x / length for x in direction]
    helper = [1.0, 0.0, 0.0] if abs(z[0]) < 0.9 else [0.0, 1.0, 0.0]
    along = sum(a * b for a, b in zip(helper, z))
    x = [a - along * b for a, b in zip(helper, z)]
    length = sum(a * a for a in x) ** 0.5
    x = [a / length for a in x]
    y = [z[1] * x[2] - z[2] * x[1], z[2] * x[0] - z[0] * x[2], z[0] * x[1] - z[1] * x[0]]
    return x + y + z


class Client:
    def __init__(self, port):
        self.socket = socket.create_connection(("127.0.0.1", port))
        self.socket.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        self.bytes = bytearray()
        self.is_over = False

    def messages(self, wait_s):
        """What comes within the time; (type, device, stamp, body, checksum)."""
        if self.is_over or not select.select([self.socket], [], [], max(0.0, wait_s))[0]:
            return
        got = self.socket.recv(1 << 18)
        self.is_over = not got
        self.bytes += got
        while len(self.bytes) >= HEADER.size:
            version, kind, device, stamp, size, checksum = HEADER.unpack_from(self.bytes)
            assert version == 1, version
            if len(self.bytes) < HEADER.size + size:
                return
            body = bytes(self.bytes[HEADER.size:HEADER.size + size])
            del self.bytes[:HEADER.size + size]
            yield kind.rstrip(b"\0").decode(), device.rstrip(b"\0").decode(), stamp, body, checksum


def check_polydata(body, report):
    """Triangles whose corners are there, and the box of the vertices."""
    head = struct.unpack_from(">10I", body)
    points, polygons, size = head[0], head[5], head[6]
    assert size == 16 * polygons, (size, polygons)
    floats = struct.unpack_from(f">{3 * points}f", body, 40)
    cells = struct.unpack_from(f">{4 * polygons}I", body, 40 + 12 * points)
    assert all(cells[n] == 3 for n in range(0, len(cells), 4))
    assert not cells or max(cells[n] for n in range(len(cells)) if n % 4) < points
    for axis in range(3):
        of_axis = floats[axis::3]
        if of_axis:
            report["box_ras_mm"][axis][0] = min(report["box_ras_mm"][axis][0], min(of_axis))
            report["box_ras_mm"][axis][1] = max(report["box_ras_mm"][axis][1], max(of_axis))
    report["triangles"] += polygons


def percentile(values, share):
    return sorted(values)[min(len(values) - 1, int(share * len(values)))] if values else None


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("port", type=int)
    parser.add_argument("--from", dest="begin", required=True)
    parser.add_argument("--to", dest="end", required=True)
    parser.add_argument("--rate", type=float, default=1000.0)
    parser.add_argument("--seconds", type=float, default=2.0)
    parser.add_argument("--no-end", action="store_true", help="vanish without a word")
    arguments = parser.parse_args()
    begin = [float(x) for x in arguments.begin.split(",")]
    end = [float(x) for x in arguments.end.split(",")]
    axes = axes_along([b - a for a, b in zip(begin, end)])
    client = Client(arguments.port)
    report = {"counts": {}, "states": [], "events": [], "stops": [], "box_ras_mm": [[1e9, -1e9] for _ in range(3)],
              "triangles": 0, "bad_checksums": 0, "max_off_mm": 0.0}
    surfaces, sent, times_ms = [], {}, []
    count = int(arguments.rate * arguments.seconds)

    def take(wait_s):
        for kind, device, stamp, body, checksum in client.messages(wait_s):
            now = time.perf_counter()
            report["counts"][kind] = report["counts"].get(kind, 0) + 1
            if kind == "POLYDATA":
                surfaces.append((body, checksum))
                continue
            report["bad_checksums"] += crc64(body) != checksum
            if kind == "TRANSFORM" and device == "Bit":
                begun, place = sent.pop(stamp)
                times_ms.append(1e3 * (now - begun))
                bit = struct.unpack(">12f", body)[9:]
                report["max_off_mm"] = max(report["max_off_mm"], max(abs(a - b) for a, b in zip(bit, place)))
            elif kind == "STRING":
                text = json.loads(body[4:])
                {"State": report["states"], "Event": report["events"], "Stop": report["stops"]}.get(device, []).append(text)

    # The bone and the plan come first; they are not what is timed.
    settled = time.perf_counter() + 0.3
    while time.perf_counter() < settled:
        take(0.02)
    start = time.perf_counter()
    for n in range(count):
        due = start + n / arguments.rate
        while (left := due - time.perf_counter()) > 0:
            take(left)
        place = [a + (b - a) * n / max(1, count - 1) for a, b in zip(begin, end)]
        body = struct.pack(">12f", *axes, *place)
        message = pack("TRANSFORM", "Tool", body, n + 1)
        sent[n + 1] = (time.perf_counter(), place)
        client.socket.sendall(message)
        take(0.0)
    settled = time.perf_counter() + 0.3
    while time.perf_counter() < settled:
        take(0.02)
    if not arguments.no_end:
        client.socket.sendall(pack_string("Command", "END"))
        settled = time.perf_counter() + 3.0
        while not client.is_over and time.perf_counter() < settled:
            take(0.02)
    for body, checksum in surfaces:
        check_polydata(body, report)
        report["bad_checksums"] += len(body) < 300000 and crc64(body) != checksum
    report.update(sent=count, returned=len(times_ms), p50_ms=percentile(times_ms, 0.5), p99_ms=percentile(times_ms, 0.99),
                  max_ms=max(times_ms, default=None), late=sum(t > 1.0 for t in times_ms), closed=client.is_over)
    report["last_state"] = report["states"][-1] if report["states"] else None
    report["states"] = len(report["states"])
    print(json.dumps(report))


if __name__ == "__main__":
    main()
