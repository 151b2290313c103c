#!/usr/bin/env python3
"""Hostile clients of `relume serve`: the server lives, reveals neither its token nor files, its memory grows by less than 64 MiB,
and a well-behaved viewer still receives images."""

import json
import os
import random
import socket
import struct
import sys
import time
import unittest

from serve_client import BINARY, CLOSE, PING, SECONDS_TO_ANSWER, TEXT, Server, Viewer, Watching

SCENE = ("cornell", "--width", 160, "--height", 90, "--max-bounces", 2, "--threads", 1)
SANITIZED = "RELUME_SANITIZED" in os.environ
MOST_GROWTH = 64 << 20  # bytes
# On an otherwise idle machine, the well-behaved viewer must receive a smooth stream during every attack.
QUIET = os.environ.get("RELUME_QUIET_MACHINE") == "1"
MOST_GAP_S = 60 if SANITIZED else 1 if QUIET else 10
LEAST_HZ = 10 if QUIET else 0
HANDSHAKE_S = 5  # kHandshake_s of serve/limits.h
TOO_BIG = 1009  # of RFC 6455

VALID = [
    {"do": "ack", "frame": 3}, {"do": "fly", "x": 0, "y": 0, "z": -1, "fast": False}, {"do": "drag", "pan": False, "x": 0.1, "y": 0},
    {"do": "wheel", "notches": 1}, {"do": "set", "side": 0, "name": "denoise", "value": "none"}, {"do": "preset", "side": 1, "name": "preview"},
    {"do": "buffer", "name": "depth"}, {"do": "split-at", "at": 0.5}, {"do": "resize", "width": 640, "height": 360},
    {"do": "bookmark", "verb": "go", "slot": 1}, {"do": "press", "button": "pause"}, {"do": "grant", "viewer": 2}, {"do": "still", "n": 4},
]


def noise(rng, most):
    return rng.randbytes(rng.randrange(most))


def damaged(rng, data):
    """Data with a few bytes replaced, removed or repeated."""
    data = bytearray(data)
    for _ in range(rng.randrange(1, 6)):
        at = rng.randrange(len(data) + 1)
        kind = rng.randrange(4)
        if kind == 0:
            data[at:at + 1] = bytes([rng.randrange(256)])
        elif kind == 1:
            del data[at:at + rng.randrange(1, 20)]
        elif kind == 2:
            data[at:at] = data[: rng.randrange(1, 40)]
        else:
            data[at:at] = noise(rng, 30)
    return bytes(data)


def bad_message(rng):
    """A message that is not valid, as bytes."""
    kind = rng.randrange(6)
    message = dict(rng.choice(VALID))
    if kind == 0:
        message[rng.choice(list(message))] = rng.choice([None, [], {}, [[]], -1, 1e300, "x" * 2000, True])
        message["do"] = message["do"] if rng.random() < 0.7 else rng.choice([7, None, "quit", "hello" * 9])
        message["extra"] = 1
        return json.dumps(message).encode()
    if kind == 1:
        return b"[" * rng.randrange(1, 16000)
    if kind == 2:
        return b'{"do":' * rng.randrange(1, 2000)
    if kind == 3:
        return json.dumps(message).encode()[: -rng.randrange(1, 8)]
    if kind == 4:
        return b"\xff" + noise(rng, 2000)
    return json.dumps({**message, "n": rng.choice([-1, 1.5, 1e40, "1", None])}).encode()


class Hostile(unittest.TestCase):
    """700 malformed requests, handshakes, frames and messages, with fixed seeds; and other offences."""

    TIMES = 1  # factor of the number of malformed ones

    @classmethod
    def setUpClass(cls):
        cls.server = Server(*SCENE)
        cls.addClassCleanup(cls.server.close)
        cls.well_behaved = Watching(cls.server)
        cls.addClassCleanup(cls.well_behaved.stop)
        # Until the memory of techniques and frames is allocated.
        end = time.monotonic() + SECONDS_TO_ANSWER
        while cls.well_behaved.frames < 30 and time.monotonic() < end:
            time.sleep(0.05)
        cls.memory = cls.server.resident_bytes()

    def setUp(self):
        self.frames = self.well_behaved.frames
        self.began = time.monotonic()
        self.well_behaved.longest_gap_s = 0

    def tearDown(self):
        self.assertTrue(self.server.alive, "".join(self.server.errors))
        end = time.monotonic() + SECONDS_TO_ANSWER
        while self.well_behaved.frames < self.frames + 3 and time.monotonic() < end:
            time.sleep(0.05)
        self.assertIsNone(self.well_behaved.failure)
        self.assertGreaterEqual(self.well_behaved.frames, self.frames + 3, "the well-behaved viewer gets no frames")
        seconds = time.monotonic() - self.began
        hz = (self.well_behaved.frames - self.frames) / seconds
        memory = self.server.resident_bytes()
        print(f"{self.id().split('.')[-1]}: {hz:.1f} frames/s, longest gap {1000 * self.well_behaved.longest_gap_s:.0f} ms, {memory >> 20} MiB", file=sys.stderr)
        self.assertLess(self.well_behaved.longest_gap_s, MOST_GAP_S)
        self.assertGreaterEqual(hz, LEAST_HZ)
        if not SANITIZED:  # they keep freed memory
            self.assertLess(memory, self.memory + MOST_GROWTH)

    def assert_gives_nothing_away(self, answer):
        self.assertNotIn(self.server.token.encode(), answer)
        self.assertNotIn(b"root:", answer)
        self.assertLess(len(answer), 1 << 18)

    def test_malformed_requests(self):
        rng = random.Random(1)
        host = self.server.host
        good = f"GET / HTTP/1.1\r\nHost: {host}\r\nAccept: */*\r\n\r\n".encode()
        for i in range(300 * self.TIMES):
            kind = i % 6
            if kind == 0:
                data = damaged(rng, good)
            elif kind == 1:
                data = noise(rng, 3000) + b"\r\n\r\n"
            elif kind == 2:
                target = "".join(rng.choice(["../", "..%2f", "/", "\\", "%00", "etc", "passwd", ".", "a", "?", "#", "main.js"]) for _ in range(rng.randrange(1, 20)))
                data = f"GET /{target} HTTP/1.1\r\nHost: {host}\r\n\r\n".encode()
            elif kind == 3:
                data = b"GET / HTTP/1.1\r\n" + b"".join(f"X{n}: {'a' * rng.randrange(300)}\r\n".encode() for n in range(rng.randrange(200))) + b"\r\n"
            elif kind == 4:
                length = rng.choice(["-1", "99999999999999999999", "1000000", "abc", "5"])
                data = f"POST / HTTP/1.1\r\nHost: {host}\r\nContent-Length: {length}\r\nTransfer-Encoding: chunked\r\n\r\n".encode() + noise(rng, 500)
            else:
                data = f"{rng.choice(['GET', 'PRI', 'OPTIONS', 'G' * 3000])} {'/' * rng.randrange(1, 9000)} HTTP/{rng.choice(['1.1', '0.9', '2.0', '9'])}\r\nHost: {host}\r\nHost: evil\r\n\r\n".encode()
            self.assert_gives_nothing_away(self.server.exchange(data, 2 * HANDSHAKE_S, ends=True))

    def test_malformed_handshakes(self):
        rng = random.Random(2)
        lines = ["GET /socket HTTP/1.1", f"Host: {self.server.host}", "Upgrade: websocket", "Connection: Upgrade", "Sec-WebSocket-Key: AAAAAAAAAAAAAAAAAAAAAA==",
                 "Sec-WebSocket-Version: 13", f"Origin: http://{self.server.host}"]
        for _ in range(132 * self.TIMES):
            chosen = [line for line in lines if rng.random() < 0.85]
            rng.shuffle(chosen)
            data = "\r\n".join([lines[0], *(line for line in chosen if line != lines[0]), "", ""]).encode()
            if rng.random() < 0.6:
                data = damaged(rng, data)
            self.assert_gives_nothing_away(self.server.exchange(data + noise(rng, 200), 2 * HANDSHAKE_S, ends=True))

    def test_malformed_frames_before_the_token(self):
        rng = random.Random(3)
        for i in range(136 * self.TIMES):
            with Viewer(self.server, hello=False, timeout=2 * HANDSHAKE_S) as viewer:
                self.assertEqual(viewer.status, 101)
                try:
                    kind = i % 8
                    if kind == 0:
                        viewer.connection.sendall(noise(rng, 4000))
                        viewer.connection.shutdown(socket.SHUT_WR)
                    elif kind == 1:
                        viewer.send_frame(TEXT, noise(rng, 200))
                    elif kind == 2:
                        viewer.send_frame(rng.randrange(3, 8), b"reserved")
                    elif kind == 3:
                        viewer.send_frame(TEXT, b"{}", first_bits=0x80 | rng.choice([0x40, 0x20, 0x10]))
                    elif kind == 4:
                        viewer.send_frame(TEXT, b"{}", masked=False)
                    elif kind == 5:
                        viewer.send_frame(BINARY, b"", length=rng.choice([1 << 20, 1 << 40, (1 << 63) - 1, 1 << 63]))
                        viewer.connection.shutdown(socket.SHUT_WR)
                    elif kind == 6:
                        viewer.send_frame(PING, b"a" * 126)
                    else:
                        viewer.send_frame(CLOSE, struct.pack(">H", rng.randrange(65536)) + noise(rng, 100))
                except OSError:  # closed already
                    continue
                viewer.code_at_close()
                self.assertEqual((viewer.frames, viewer.texts), (0, {}))

    def test_malformed_messages_with_the_token(self):
        rng = random.Random(4)
        for _ in range(132 * self.TIMES):
            with Viewer(self.server, timeout=2 * HANDSHAKE_S) as viewer:
                viewer.receive_until(lambda v=viewer: "role" in v.texts or v.close_code)
                self.assertIn("role", viewer.texts)
                message = bad_message(rng)
                viewer.send_frame(TEXT, message)
                self.assertIsNotNone(viewer.code_at_close(), message[:100])

    def test_long_messages(self):
        for length in (16 * 1024 + 1, 1 << 20):
            with Viewer(self.server) as viewer:
                viewer.receive_until(lambda v=viewer: "role" in v.texts)
                try:
                    viewer.send_frame(TEXT, b" " * length)
                except ConnectionError:
                    pass
                self.assertIn(viewer.code_at_close(), (TOO_BIG, None))

    def test_floods_of_messages_and_pings(self):
        for opcode, payload in ((TEXT, b'{"do":"still"}'), (PING, b"x"), (TEXT, json.dumps(VALID[1]).encode())):
            with Viewer(self.server) as viewer:
                viewer.receive_until(lambda v=viewer: "role" in v.texts)
                end = time.monotonic() + SECONDS_TO_ANSWER
                with self.assertRaises(ConnectionError):
                    while time.monotonic() < end:
                        viewer.send_frame(opcode, payload)

    def test_slow_clients_are_closed(self):
        request = f"GET / HTTP/1.1\r\nHost: {self.server.host}\r\nX: {'a' * 1000}\r\n\r\n".encode()
        slow = [self.server.connect() for _ in range(40)]
        began = time.monotonic()
        opened = len(slow)
        at = 0
        while slow and time.monotonic() - began < 4 * HANDSHAKE_S:
            for connection in list(slow):
                try:
                    connection.sendall(request[at:at + 1])
                    connection.settimeout(0.001)
                    closed = connection.recv(1) == b""
                except TimeoutError:
                    closed = False
                except OSError:
                    closed = True
                if closed:
                    connection.close()
                    slow.remove(connection)
            at += 1
            time.sleep(0.4)
        for connection in slow:
            connection.close()
        self.assertEqual(len(slow), 0, f"of {opened} slow connections remain")

    def test_two_hundred_connections(self):
        crowd = [self.server.connect() for _ in range(200)]
        try:
            # They wait for nothing, but new viewers still get in.
            with Viewer(self.server) as viewer:
                viewer.receive_until(lambda: viewer.frames > 0)
            self.assertEqual(self.server.get("/")[0], 200)
        finally:
            for connection in crowd:
                connection.close()

    def test_a_viewer_that_reads_nothing(self):
        with Viewer(self.server) as viewer:
            viewer.receive_until(lambda: "role" in viewer.texts)
            time.sleep(3)  # frames and texts would fill the server's memory
            self.assertTrue(self.server.alive)

    def test_viewers_that_vanish(self):
        for _ in range(100):
            viewer = Viewer(self.server)
            viewer.connection.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, struct.pack("ii", 1, 0))  # a reset instead of an end
            viewer.connection.close()


class ManyHostile(Hostile):
    """2,100 malformed requests, handshakes, frames and messages, including those of Hostile."""

    TIMES = 3


if __name__ == "__main__":
    unittest.main(defaultTest=sys.argv[1:] or "Hostile", argv=sys.argv[:1])
