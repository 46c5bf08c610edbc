"""`occlod serve` at the level of bytes: what leaves the folder, what waits, what is too large."""
import json
import os
import pathlib
import re
import signal
import socket
import subprocess
import time
import unittest

from tool_case import OCCLOD, ToolTest

SECRET = "not to be seen"


class Server(ToolTest):
    def setUp(self):
        super().setUp()
        served = self.folder / "served"
        (served / "tiles").mkdir(parents=True)
        (served / "tileset.json").write_text('{"asset": {}}')
        (served / "tiles/a b.glb").write_bytes(bytes(range(256)) * 1000)
        (self.folder / "secret.txt").write_text(SECRET)
        (self.folder / "served-too").mkdir()
        (self.folder / "served-too/secret.txt").write_text(SECRET)
        (served / "out").symlink_to("../secret.txt")
        (served / "up").symlink_to("..")
        (served / "within.json").symlink_to("tileset.json")
        os.mkfifo(served / "pipe")
        self.start()

    def start(self, *arguments, host="127.0.0.1"):
        self.server = subprocess.Popen([OCCLOD, "serve", "served", "--port", "0", *map(str, arguments)], cwd=self.folder,
                                       stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        self.addCleanup(self.stop, self.server)
        line = self.server.stdout.readline()
        told = re.fullmatch(r"http://\[?([^/\]]*)\]?:(\d+)/\n", line)
        self.assertEqual(told.group(1), host)
        self.host, self.port = host, int(told.group(2))

    @staticmethod
    def stop(server):
        if server.poll() is None:
            server.kill()
        server.communicate()

    def connect(self):
        connection = socket.create_connection((self.host, self.port), timeout=30)
        self.addCleanup(connection.close)
        return connection

    def ask(self, target, *headers, method="GET", host="127.0.0.1"):
        """Status, headers (lower case) and body of one request on a connection of its own."""
        connection = self.connect()
        lines = [f"{method} {target} HTTP/1.1", f"Host: {host}", "Connection: close", *headers]
        connection.sendall("\r\n".join([*lines, "", ""]).encode("latin-1"))
        return self.answer(self.read_all(connection))

    @staticmethod
    def read_all(connection):
        parts = []
        try:
            while part := connection.recv(1 << 16):
                parts.append(part)
        except ConnectionResetError:
            pass  # closed with bytes of ours unread: what was answered has come
        return b"".join(parts)

    @staticmethod
    def answer(data):
        head, _, body = data.partition(b"\r\n\r\n")
        first, *lines = head.decode("latin-1").split("\r\n")
        return int(first.split()[1]), {key.lower(): value for key, value in (line.split(": ", 1) for line in lines)}, body

    def test_files(self):
        status, headers, body = self.ask("/tileset/tileset.json")
        self.assertEqual((status, headers["content-type"], body), (200, "application/json", b'{"asset": {}}'))
        status, headers, body = self.ask("/tileset/tiles/a%20b.glb?v=1")
        self.assertEqual((status, headers["content-type"], headers["content-length"]), (200, "model/gltf-binary", "256000"))
        self.assertEqual(body, bytes(range(256)) * 1000)
        self.assertEqual(self.ask("/tileset/within.json")[0], 200)
        status, headers, body = self.ask("/tileset/tileset.json", method="HEAD")
        self.assertEqual((status, headers["content-length"], body), (200, "13", b""))
        status, headers, body = self.ask("/")
        self.assertEqual((status, headers["content-type"]), (200, "text/html; charset=utf-8"))
        self.assertIn(b"https://cesium.com/downloads/cesiumjs/releases/1.", body)

    def test_ranges(self):
        whole = bytes(range(256)) * 1000
        for text, expected in (("0-0", whole[:1]), ("5-9", whole[5:10]), ("255990-", whole[-10:]), ("-7", whole[-7:]), ("100-999999", whole[100:]), ("-999999", whole)):
            status, headers, body = self.ask("/tileset/tiles/a%20b.glb", f"Range: bytes={text}")
            self.assertEqual(body, expected, text)
            self.assertEqual(status, 200 if expected == whole else 206, text)
            if status == 206:
                first = whole.index(expected) if len(expected) > 256 else int(headers["content-range"].split()[1].split("-")[0])
                self.assertEqual(headers["content-range"], f"bytes {first}-{first + len(expected) - 1}/256000")
        for text in ("256000-", "999999-9999999", "-0"):
            status, headers, _ = self.ask("/tileset/tiles/a%20b.glb", f"Range: bytes={text}")
            self.assertEqual((status, headers["content-range"]), (416, "bytes */256000"), text)
        for text in ("bytes=9-5", "bytes=0-1,5-6", "bytes=x", "lines=1-2", "bytes=", "bytes=-", "bytes=99999999999999999999-"):
            self.assertEqual(self.ask("/tileset/tiles/a%20b.glb", f"Range: {text}")[0], 200, text)

    def test_nothing_leaves_the_folder(self):
        for target in ("/tileset/../secret.txt", "/tileset/%2e%2e/secret.txt", "/tileset/%2E%2E%2Fsecret.txt", "/tileset/..%5Csecret.txt", "/tileset/out",
                       "/tileset/up/secret.txt", "/tileset/tiles/../../secret.txt", "/tileset//etc/passwd", "/tileset/%2Fetc%2Fpasswd", "/tileset/%00", "/tileset/out%00.json",
                       "/tileset-too/secret.txt", "/tileset/../served-too/secret.txt", "/etc/passwd", "/../secret.txt", "//secret.txt", "/tileset/", "/tileset", "/tileset/tiles",
                       "/tileset/pipe", "/tileset/none", "/tileset/%", "/tileset/%2", "/tileset/%zz", "/cesium/Cesium.js", "secret.txt", "*", f"http://127.0.0.1{self.folder}/secret.txt"):
            status, _, body = self.ask(target)
            self.assertIn(status, (400, 404), target)
            self.assertNotIn(SECRET.encode(), body, target)
            self.assertNotIn(b"root:", body, target)

    def test_only_reading(self):
        for method in ("POST", "PUT", "DELETE", "OPTIONS", "CONNECT", "BREW"):
            self.assertIn(self.ask("/tileset/tileset.json", "Content-Length: 0", method=method)[0], (400, 405), method)

    def test_pages_from_elsewhere_may_read(self):
        """CORS, on every answer: a viewer with a server of its own reads the tiles, and is told what is wrong."""
        for target, headers, method, status in (("/", [], "GET", 200), ("/tileset/tileset.json", [], "GET", 200), ("/tileset/tileset.json", [], "HEAD", 200),
                                                ("/tileset/tiles/a%20b.glb", ["Range: bytes=5-9"], "GET", 206), ("/tileset/tiles/a%20b.glb", ["Range: bytes=256000-"], "GET", 416),
                                                ("/tileset/none", [], "GET", 404), ("/tileset/%", [], "GET", 400), ("/tileset/tileset.json", [], "POST", 405)):
            told, answered, _ = self.ask(target, "Origin: https://example.org", *headers, method=method)
            self.assertEqual((told, answered["access-control-allow-origin"]), (status, "*"), target)

    def test_hosts(self):
        """By default no other address of this machine answers; one that is asked for does, by any name."""
        with self.assertRaises(OSError):
            socket.create_connection(("127.0.0.2", self.port), timeout=2)
        self.start("--host", "127.0.0.2", host="127.0.0.2")
        self.assertEqual(self.ask("/", host="example.org")[0], 200)
        self.start("--host", "0.0.0.0", host="0.0.0.0")
        for self.host in ("127.0.0.1", "127.0.0.2"):
            self.assertEqual(self.ask("/tileset/tileset.json")[0], 200)
        if pathlib.Path("/proc/net/if_inet6").exists() and "lo" in pathlib.Path("/proc/net/if_inet6").read_text():
            self.start("--host", "::1", host="::1")
            self.assertEqual(self.ask("/")[0], 200)
        for host, problem in (("example.org", "example.org: is no address"), ("203.0.113.1", "port 0 of 203.0.113.1: cannot be had")):
            self.assertIn(problem, self.failure_of("serve", "served", "--port", 0, "--host", host))

    def test_many_requests_on_one_connection(self):
        connection = self.connect()
        connection.sendall(b"GET /tileset/tileset.json HTTP/1.1\r\nHost: 127.0.0.1\r\n\r\n" * 50 + b"GET / HTTP/1.1\r\nHost: 127.0.0.1\r\nConnection: close\r\n\r\n")
        self.assertEqual(self.read_all(connection).count(b"HTTP/1.1 200 OK"), 51)

    def test_huge_headers(self):
        for head in (b"GET /" + b"a" * 10**6, b"GET / HTTP/1.1\r\nHost: 127.0.0.1\r\nX: " + b"a" * 10**6,
                     b"GET / HTTP/1.1\r\n" + b"".join(b"X%d: y\r\n" % i for i in range(10**5))):
            connection = self.connect()
            try:
                connection.sendall(head)
                answer = self.read_all(connection)
                self.assertTrue(not answer or answer.startswith((b"HTTP/1.1 431", b"HTTP/1.1 400")), answer[:100])
            except ConnectionError:
                pass  # closed while we were sending
        self.assertEqual(self.ask("/")[0], 200)
        self.assertLess(self.memory_kb(), 100_000)

    def memory_kb(self):
        status = pathlib.Path(f"/proc/{self.server.pid}/status").read_text()
        return int(re.search(r"VmRSS:\s+(\d+)", status).group(1))

    def test_garbage(self):
        for data in (b"\0" * 1000, b"\r\n" * 1000, b"GET\r\n\r\n", b"\x16\x03\x01\x02\x00\x01\x00", os.urandom(4000) + b"\r\n\r\n"):
            connection = self.connect()
            try:
                connection.sendall(data)
                connection.shutdown(socket.SHUT_WR)
                self.read_all(connection)
            except OSError:
                pass  # the server has closed it already: a reset while sending, or nothing left to shut down
        self.assertEqual(self.ask("/")[0], 200)

    def test_slow_clients_are_dropped_and_hinder_nobody(self):
        """300 clients that send a byte a second; 256 are served at once, and others come to their turn when those are dropped."""
        slow = [self.connect() for _ in range(300)]
        begin, dropped = time.monotonic(), 0
        while dropped < 256 and time.monotonic() - begin < 60:
            for connection in slow:
                try:
                    connection.sendall(b"G")
                except OSError:
                    pass
            time.sleep(1)
            dropped = 0
            for connection in slow:
                connection.setblocking(False)
                try:
                    dropped += connection.recv(1, socket.MSG_PEEK) == b""
                except BlockingIOError:
                    pass
                except OSError:
                    dropped += 1
                connection.setblocking(True)
        self.assertGreaterEqual(dropped, 256)
        self.assertLess(time.monotonic() - begin, 30)
        self.assertEqual(self.ask("/")[0], 200)

    def test_a_client_that_does_not_read(self):
        (self.folder / "served/large.glb").write_bytes(bytes(64 << 20))
        connection = self.connect()
        connection.sendall(b"GET /tileset/large.glb HTTP/1.1\r\nHost: 127.0.0.1\r\n\r\n")
        time.sleep(1)
        self.assertEqual(self.ask("/")[0], 200)
        self.assertLess(self.memory_kb(), 60_000)  # parts, not files

    def test_signals_and_ports(self):
        done = subprocess.run([OCCLOD, "serve", "served", "--port", str(self.port)], cwd=self.folder, capture_output=True, text=True)
        self.assertEqual((done.returncode, done.stderr.count("\n")), (1, 1))
        self.assertIn("cannot be had", done.stderr)
        self.server.send_signal(signal.SIGINT)
        self.assertEqual(self.server.wait(10), 0)
        self.assertIn("no tileset.json", self.failure_of("serve", "."))
        self.assertIn("no Cesium.js", self.failure_of("serve", "served", "--cesium", "."))

    def test_a_cesium_of_ones_own(self):
        (self.folder / "cesium").mkdir()
        (self.folder / "cesium/Cesium.js").write_text("0;")
        self.start("--cesium", "cesium")
        self.assertEqual(self.ask("/cesium/Cesium.js")[1]["content-type"], "text/javascript")
        page = self.ask("/")[2]
        self.assertIn(b'"/cesium/"', page)
        self.assertNotIn(b"https://", page)
        self.assertEqual(json.loads(self.ask("/tileset/tileset.json")[2]), {"asset": {}})


if __name__ == "__main__":
    unittest.main(verbosity=1)
