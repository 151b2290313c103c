"""A server under test, and a WebSocket client of Python's standard library that can also break the protocol (RFC 6455)."""

import base64
import json
import os
import re
import signal
import socket
import struct
import tempfile
import threading
import time

from program import start

SECONDS_TO_START = 120
SECONDS_TO_ANSWER = 30
TEXT, BINARY, CLOSE, PING, PONG = 1, 2, 8, 9, 10


class Server:
    """`relume serve` on a free port of the loopback interface."""

    def __init__(self, *arguments, port=0):
        self.folder = tempfile.TemporaryDirectory(prefix="relume_")
        environment = {**os.environ, "XDG_STATE_HOME": self.folder.name}
        self.process = start("serve", *arguments, "--port", port, cwd=self.folder.name, env=environment)
        self.errors = []
        self.reader = threading.Thread(target=lambda: self.errors.extend(self.process.stderr), daemon=True)
        self.reader.start()
        timer = threading.Timer(SECONDS_TO_START, self.process.kill)
        timer.start()
        self.address = self.process.stdout.readline().strip()
        timer.cancel()
        match = re.fullmatch(r"http://([\d.]+|\[[0-9a-f:]+\]):(\d+)/#([0-9a-f]+)", self.address)
        if not match:
            self.process.wait(SECONDS_TO_ANSWER)
            self.close()
            raise AssertionError(f"no address: {self.address!r} {''.join(self.errors)}")
        self.host, self.port, self.token = f"{match[1]}:{match[2]}", int(match[2]), match[3]
        self.name = match[1].strip("[]")

    @property
    def alive(self):
        return self.process.poll() is None

    def resident_bytes(self):
        with open(f"/proc/{self.process.pid}/status", encoding="ascii") as status:
            return 1024 * int(re.search(r"VmRSS:\s+(\d+) kB", status.read())[1])

    def cpu_seconds(self):
        with open(f"/proc/{self.process.pid}/stat", encoding="ascii") as stat:
            fields = stat.read().rpartition(")")[2].split()
        return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")

    def stop(self, number=signal.SIGTERM):
        """Exit code, and seconds until the end."""
        began = time.monotonic()
        self.process.send_signal(number)
        code = self.process.wait(SECONDS_TO_ANSWER)
        return code, time.monotonic() - began

    def close(self):
        if self.alive:
            self.process.kill()
        self.process.wait(SECONDS_TO_ANSWER)
        self.reader.join(SECONDS_TO_ANSWER)
        self.process.stdout.close()
        self.process.stderr.close()
        self.folder.cleanup()

    def connect(self, timeout=SECONDS_TO_ANSWER):
        return socket.create_connection((self.name, self.port), timeout=timeout)

    def exchange(self, data, timeout=SECONDS_TO_ANSWER, ends=False):
        """Sends bytes, and returns all that the server sends until it closes. `ends`: tells the server that no more follow."""
        answer = b""
        with self.connect(timeout) as connection:
            try:
                connection.sendall(data)
                if ends:
                    connection.shutdown(socket.SHUT_WR)
                while block := connection.recv(65536):
                    answer += block
            except TimeoutError:
                raise
            except OSError:  # closed in the middle
                pass
        return answer

    def get(self, target, method="GET", **headers):
        """Status, headers in lower case, and body."""
        fields = {"Host": self.host, **{name.replace("_", "-"): value for name, value in headers.items()}}
        lines = [f"{method} {target} HTTP/1.1", *(f"{name}: {value}" for name, value in fields.items() if value is not None)]
        answer = self.exchange("\r\n".join([*lines, "", ""]).encode("latin-1"))
        head, _, body = answer.partition(b"\r\n\r\n")
        first, *rest = head.decode("latin-1").split("\r\n")
        status = int(first.split()[1]) if first else 0
        return status, {name.lower(): value.strip() for name, _, value in (line.partition(":") for line in rest)}, body


class Viewer:
    """A connected WebSocket. `hello`: shows the token."""

    def __init__(self, server, hello=True, host=None, origin=None, target="/socket", timeout=SECONDS_TO_ANSWER):
        self.server = server
        self.buffer = b""
        self.texts = {}
        self.frames = 0
        self.last = None
        self.png = None
        self.close_code = None
        self.connection = server.connect(timeout)
        key = base64.b64encode(os.urandom(16)).decode()
        host = server.host if host is None else host
        origin = f"http://{server.host}" if origin is None else origin
        lines = [f"GET {target} HTTP/1.1", f"Host: {host}", "Upgrade: websocket", "Connection: Upgrade", f"Sec-WebSocket-Key: {key}", "Sec-WebSocket-Version: 13", f"Origin: {origin}", "", ""]
        self.connection.sendall("\r\n".join(lines).encode())
        while b"\r\n\r\n" not in self.buffer:
            block = self.connection.recv(65536)
            if not block:
                break
            self.buffer += block
        head, _, self.buffer = self.buffer.partition(b"\r\n\r\n")
        self.status = int(head.split()[1]) if head else 0
        if hello and self.status == 101:
            self.send({"do": "hello", "token": server.token})

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.connection.close()

    def send_frame(self, opcode, payload, first_bits=0x80, masked=True, length=None):
        """A frame, by default a correct one. `length`: that it claims."""
        length = len(payload) if length is None else length
        mask_bit = 0x80 if masked else 0
        head = bytes([first_bits | opcode])
        if length < 126:
            head += bytes([mask_bit | length])
        elif length < 1 << 16:
            head += struct.pack(">BH", mask_bit | 126, length)
        else:
            head += struct.pack(">BQ", mask_bit | 127, length)
        if masked:
            mask = os.urandom(4)
            head += mask
            payload = bytes(byte ^ mask[i % 4] for i, byte in enumerate(payload))
        self.connection.sendall(head + payload)

    def send(self, message):
        self.send_frame(TEXT, json.dumps(message).encode())

    def take(self, count):
        while len(self.buffer) < count:
            block = self.connection.recv(1 << 16)
            if not block:
                raise ConnectionError("closed")
            self.buffer += block
        data, self.buffer = self.buffer[:count], self.buffer[count:]
        return data

    def acknowledge(self, frame):
        self.send({"do": "ack", "frame": struct.unpack_from("<I", frame, 4)[0]})

    def receive(self, acknowledges=True):
        """Next frame: opcode and payload. Acknowledges frames, answers pings, and keeps the newest texts."""
        first, second = self.take(2)
        length = second & 0x7F
        if length == 126:
            length = struct.unpack(">H", self.take(2))[0]
        elif length == 127:
            length = struct.unpack(">Q", self.take(8))[0]
        payload = self.take(length)
        opcode = first & 0x0F
        if opcode == TEXT:
            text = json.loads(payload)
            self.texts[text["kind"]] = text
        elif opcode == BINARY and payload[0] == 0:
            self.frames += 1
            self.last = payload
            if acknowledges:
                self.acknowledge(payload)
        elif opcode == BINARY:
            self.png = payload
        elif opcode == PING:
            self.send_frame(PONG, payload)
        elif opcode == CLOSE:
            self.close_code = struct.unpack(">H", payload[:2])[0] if len(payload) >= 2 else 0
        return opcode, payload

    def receive_until(self, condition, seconds=SECONDS_TO_ANSWER):
        end = time.monotonic() + seconds
        while not condition():
            if time.monotonic() > end:
                raise AssertionError("the server did not answer in time")
            self.receive()

    def code_at_close(self):
        """The code of the closing frame; None if the connection ends without one. Fails if it does not end."""
        try:
            self.receive_until(lambda: self.close_code is not None)
        except TimeoutError:
            raise AssertionError("the server keeps the connection") from None
        except OSError:
            pass
        return self.close_code

    def still_sends(self):
        """Whether the server sends a frame soon."""
        try:
            self.receive()
        except OSError:
            return False
        return self.close_code is None


class Watching:
    """A viewer in a thread, which counts frames and the longest time between two."""

    def __init__(self, server):
        self.viewer = Viewer(server)
        self.viewer.receive_until(lambda: self.viewer.frames > 2, SECONDS_TO_START)
        self.longest_gap_s = 0
        self.failure = None
        self.ends = False
        self.thread = threading.Thread(target=self.run, daemon=True)
        self.thread.start()

    @property
    def frames(self):
        return self.viewer.frames

    def run(self):
        last = time.monotonic()
        try:
            while not self.ends:
                before = self.frames
                self.viewer.receive()
                if self.frames == before:
                    continue
                now = time.monotonic()
                self.longest_gap_s = max(self.longest_gap_s, now - last)
                last = now
        except (OSError, AssertionError) as error:
            self.failure = None if self.ends else error

    def stop(self):
        self.ends = True
        self.thread.join(SECONDS_TO_ANSWER)
        self.viewer.connection.close()
