#!/usr/bin/env python3
"""Tests `relume serve` by its protocol: files, tokens, origins, steering, settings, signals."""

import os
import signal
import time
import unittest

from program import ProgramTest
from serve_client import BINARY, Server, Viewer, Watching

SCENE = ("cornell", "--width", 160, "--height", 90, "--max-bounces", 2, "--threads", 1)
SECONDS_TO_END = 20 if "RELUME_SANITIZED" in os.environ else 4  # up to 0.7 s on an idle machine
POLICY_ERROR, TRY_AGAIN_LATER, GOING_AWAY = 1008, 1013, 1001


class Serving(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.server = Server(*SCENE, "--viewers", 3)
        cls.addClassCleanup(cls.server.close)

    def setUp(self):
        time.sleep(0.3)  # until the server has noticed that the viewers of the test before left

    def tearDown(self):
        self.assertTrue(self.server.alive, "".join(self.server.errors))

    def test_the_address_has_a_long_token(self):
        self.assertGreaterEqual(4 * len(self.server.token), 128)
        self.assertTrue(self.server.address.startswith(f"http://127.0.0.1:{self.server.port}/#"))

    def test_pages_and_their_headers(self):
        status, headers, body = self.server.get("/")
        self.assertEqual(status, 200)
        self.assertEqual(headers["content-type"], "text/html; charset=utf-8")
        self.assertEqual(headers["cache-control"], "no-store")
        self.assertEqual(headers["x-content-type-options"], "nosniff")
        policy = headers["content-security-policy"]
        for part in ("default-src 'none'", "script-src 'self'", "frame-ancestors 'none'", "base-uri 'none'"):
            self.assertIn(part, policy)
        self.assertNotIn("unsafe", policy)
        self.assertNotIn(self.server.token.encode(), body)
        for name in ("main", "link", "input", "settings", "views", "timing"):
            self.assertEqual(self.server.get(f"/{name}.js")[0], 200, name)
        self.assertEqual(self.server.get("/", method="HEAD")[2], b"")

    def test_no_other_files(self):
        for target in ("/index.html", "/../../etc/passwd", "/..%2f..%2fetc%2fpasswd", "//etc/passwd", "/etc/passwd", "/main.js?a", "/favicon.ico", f"/?token={self.server.token}"):
            status, _, body = self.server.get(target)
            self.assertEqual(status, 404, target)
            self.assertEqual(body, b"", target)
        self.assertEqual(self.server.get("/", method="POST")[0], 405)

    def test_other_hosts_are_refused(self):
        for host in ("evil.example", f"evil.example:{self.server.port}", "10.0.0.1", "", None):
            self.assertEqual(self.server.get("/", Host=host)[0], 421, host)
        for host in (f"localhost:{self.server.port}", "localhost:9999", "127.0.0.1"):
            self.assertEqual(self.server.get("/", Host=host)[0], 200, host)

    def test_other_origins_are_refused(self):
        for origin in ("http://evil.example", "null", f"http://localhost:{self.server.port}", "http://127.0.0.1:1", f"http://127.0.0.1:{self.server.port}/"):
            with Viewer(self.server, origin=origin) as viewer:
                self.assertEqual(viewer.status, 403, origin)
        with Viewer(self.server, host="evil.example", origin="http://evil.example") as viewer:
            self.assertEqual(viewer.status, 421)
        with Viewer(self.server, target=f"/socket?token={self.server.token}") as viewer:
            self.assertEqual(viewer.status, 404)

    def test_wrong_tokens_are_refused(self):
        token = self.server.token
        wrong = "0" if token[-1] != "0" else "1"
        for given in ("", token[:-1], token[:-1] + wrong, token + wrong, token.upper() + "G", "0" * len(token)):
            with Viewer(self.server, hello=False) as viewer:
                viewer.send({"do": "hello", "token": given})
                self.assertEqual(viewer.code_at_close(), POLICY_ERROR)
                self.assertEqual((viewer.frames, viewer.texts), (0, {}))
        with Viewer(self.server, hello=False) as viewer:
            viewer.send({"do": "steer"})
            self.assertEqual(viewer.code_at_close(), POLICY_ERROR)

    def test_a_viewer_gets_everything(self):
        with Viewer(self.server) as viewer:
            viewer.receive_until(lambda: viewer.frames > 1 and len(viewer.texts) == 4)
            self.assertEqual(set(viewer.texts), {"role", "declarations", "values", "status"})
            self.assertEqual(viewer.last[20:22], b"\xff\xd8", "JPEG")
            viewer.receive_until(lambda: viewer.texts["status"]["times"][0]["passes"])
            declared = {s["name"]: s for group in viewer.texts["declarations"]["groups"] for s in group["settings"]}
            self.assertIn("svgf", declared["denoise"]["choices"])
            self.assertEqual(set(declared), set(viewer.texts["values"]["sides"][0]))

    def test_one_steers_and_others_may_ask(self):
        def denoiser(viewer):
            return viewer.texts["values"]["sides"][0]["denoise"]

        with Viewer(self.server) as first, Viewer(self.server) as second:
            for viewer in (first, second):
                viewer.receive_until(lambda v=viewer: {"role", "values"} <= set(v.texts))
            first.receive_until(lambda: first.texts["role"]["viewers"] == 2)
            if first.texts["role"]["viewer"] != first.texts["role"]["steerer"]:
                first, second = second, first
            chosen = "none" if denoiser(first) != "none" else "bmfr"
            second.send({"do": "set", "side": 0, "name": "denoise", "value": chosen})
            second.send({"do": "steer"})
            asked = second.texts["role"]["viewer"]
            first.receive_until(lambda: asked in first.texts["role"]["requests"])
            self.assertNotEqual(denoiser(first), chosen, "a watching viewer changes nothing")
            first.send({"do": "grant", "viewer": asked})
            second.receive_until(lambda: second.texts["role"]["steerer"] == asked)
            second.send({"do": "set", "side": 0, "name": "denoise", "value": chosen})
            second.receive_until(lambda: denoiser(second) == chosen)
            first.receive_until(lambda: denoiser(first) == chosen)

    def test_input_passes_frames_that_wait(self):
        with Viewer(self.server) as steering, Viewer(self.server) as other:
            for viewer in (steering, other):
                viewer.receive_until(lambda v=viewer: {"role", "values"} <= set(v.texts))
            if steering.texts["role"]["viewer"] != steering.texts["role"]["steerer"]:
                steering, other = other, steering
            chosen = "none" if other.texts["values"]["sides"][0]["denoise"] != "none" else "bmfr"
            until = time.monotonic() + 1  # frames queue for `other`, which does not read
            other.receive_until(lambda: time.monotonic() > until)
            steering.send({"do": "set", "side": 0, "name": "denoise", "value": chosen})
            other.receive_until(lambda: other.texts["values"]["sides"][0]["denoise"] == chosen)

    def test_a_slow_link_gets_smaller_frames(self):
        with Viewer(self.server) as viewer:
            levels, sizes = [], []
            end = time.monotonic() + 60
            while not levels or levels[-1] < 4:
                self.assertLess(time.monotonic(), end, f"levels {levels}")
                opcode, payload = viewer.receive(acknowledges=False)
                if opcode != BINARY:
                    continue
                time.sleep(len(payload) / 8000)  # bytes per second
                viewer.acknowledge(payload)
                levels.append(payload[1])
                sizes.append(len(payload))
            self.assertLess(levels[0], 2)
            self.assertLess(sizes[-1], 0.7 * sizes[0])  # headers are a large part of such small frames

    def test_more_viewers_than_permitted(self):
        with Viewer(self.server) as a, Viewer(self.server) as b, Viewer(self.server) as c:
            for viewer in (a, b, c):
                viewer.receive_until(lambda v=viewer: "role" in v.texts)
            with Viewer(self.server) as fourth:
                self.assertEqual(fourth.code_at_close(), TRY_AGAIN_LATER)
            self.assertTrue(a.still_sends())

    def test_a_page_reads_and_writes_no_files(self):
        with Viewer(self.server) as viewer:
            viewer.receive_until(lambda: viewer.frames > 0 and "status" in viewer.texts)
            viewer.send({"do": "set", "side": 0, "name": "env", "value": "/etc/passwd"})
            viewer.receive_until(lambda: any("cannot name the file" in m["text"] for m in viewer.texts["status"]["messages"]))
            self.assertEqual(viewer.texts["values"]["sides"][0]["env"], "")

    def test_screenshots_are_png(self):
        with Viewer(self.server) as viewer:
            viewer.receive_until(lambda: viewer.frames > 0)
            viewer.send({"do": "screenshot"})
            viewer.receive_until(lambda: viewer.png)
            self.assertEqual(viewer.png[20:28], b"\x89PNG\r\n\x1a\n")


    def test_screenshots_have_a_limit(self):
        with Viewer(self.server) as viewer, Viewer(self.server) as other:
            for each in (viewer, other):
                each.receive_until(lambda v=each: v.frames > 0)
            for _ in range(6):
                viewer.send({"do": "screenshot"})
            viewer.receive_until(lambda: "notice" in viewer.texts and viewer.png)
            self.assertIn("screenshot", viewer.texts["notice"]["text"])
            shown = other.frames
            other.receive_until(lambda: other.frames > shown + 3)
            self.assertNotIn("notice", other.texts)
            self.assertTrue(viewer.still_sends(), "a refusal closes no connection")


class Unwatched(unittest.TestCase):
    def start(self, *arguments):
        server = Server(*SCENE, *arguments)
        self.addCleanup(server.close)
        return server

    def assert_pauses(self, server):
        """Waits for half a second in which the server, whose rendering keeps a processor busy, uses little of one."""
        end = time.monotonic() + 60
        while True:
            before = server.cpu_seconds()
            time.sleep(0.5)
            if server.cpu_seconds() - before < 0.2:
                return
            self.assertLess(time.monotonic(), end, "rendering continues without viewers")

    def test_rendering_pauses_until_a_viewer_connects(self):
        server = self.start()
        self.assert_pauses(server)
        for _ in range(2):
            with Viewer(server) as viewer:
                viewer.receive_until(lambda: viewer.frames > 5)
            self.assert_pauses(server)

    def test_a_goal_of_the_command_line_is_rendered_without_viewers(self):
        server = self.start("--spp", 1000000)
        before = server.cpu_seconds()
        end = time.monotonic() + 60
        while server.cpu_seconds() - before < 1:
            self.assertLess(time.monotonic(), end, "rendering has paused")
            time.sleep(0.1)


class Ending(ProgramTest):
    def test_signals_end_it_soon(self):
        for number in (signal.SIGINT, signal.SIGTERM):
            with self.subTest(number):
                server = Server(*SCENE)
                self.addCleanup(server.close)
                watching = Watching(server)
                with Viewer(server, hello=False):
                    code, seconds = server.stop(number)
                watching.stop()
                self.assertEqual(code, 0, "".join(server.errors))
                self.assertLess(seconds, SECONDS_TO_END)
                self.assertEqual(watching.viewer.close_code, GOING_AWAY)
                server.reader.join(10)
                self.assertNotIn(server.token, server.process.stdout.read() + "".join(server.errors), "the token is printed once")

    def test_other_addresses_get_a_warning(self):
        server = Server(*SCENE, "--bind", "0.0.0.0", "--host", "render.example.com")
        self.addCleanup(server.close)
        self.assertEqual(server.get("/", Host="render.example.com")[0], 200)
        self.assertEqual(server.get("/", Host="other.example.com")[0], 421)
        server.stop()
        server.reader.join(10)
        self.assertIn("not encrypted", "".join(server.errors))
        self.assertIn("ssh -L", "".join(server.errors))

    def test_errors_of_the_command_line(self):
        server = Server(*SCENE)
        self.addCleanup(server.close)
        for arguments, port, expected in (((), server.port, "cannot listen on"), (("--bind", "localhost"), 0, "numeric address"),
                                          ((), 70000, "65535"), (("--host", "a:80"), 0, "without port")):
            with self.assertRaisesRegex(AssertionError, expected):
                Server(*SCENE, *arguments, port=port)
        with self.assertRaisesRegex(AssertionError, "missing.glb"):
            Server("missing.glb")


if __name__ == "__main__":
    unittest.main()
