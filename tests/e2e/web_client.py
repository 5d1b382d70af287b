"""A small client of `skyquilt view`: HTTP with its cookie, and a WebSocket (RFC 6455) without any package. For tests and measurements."""
import base64
import http.client
import json
import os
import queue
import re
import shutil
import socket
import struct
import subprocess
import threading
import time
import zlib

from harness import Failure, expect


class Viewer:
    """The program as a process, and the session that its link gives."""

    def __init__(self, skyquilt, project, *flags, ranks=0, environment=None):
        self.process = subprocess.Popen(skyquilt.command(["view", project, *flags], ranks), env=dict(skyquilt.environment, **(environment or {})),
                                        stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, errors="replace", start_new_session=True)
        self.printed = ""
        self.lines = queue.Queue()
        self.reader = threading.Thread(target=self.read_lines, daemon=True)
        self.reader.start()
        self.link = self.next_link()
        self.port = int(re.search(r":(\d+)/", self.link).group(1))
        self.cookie = None

    def read_lines(self):
        for line in self.process.stdout:
            self.printed += line
            self.lines.put(line)
        self.lines.put(None)

    def next_link(self, seconds=60):
        """The next link that it prints."""
        end = time.monotonic() + seconds
        while time.monotonic() < end:
            try:
                line = self.lines.get(timeout=0.2)
            except queue.Empty:
                continue
            if line is None:
                raise Failure(f"the viewer ended with {self.process.wait()}:\n{self.printed}")
            found = re.search(r"http://\S+/\?token=\S+", line)
            if found:
                return found.group(0)
        raise Failure(f"no link within {seconds} s:\n{self.printed}")

    def request(self, method, path, body=None, headers=None, cookie=True):
        """Status, headers and body."""
        connection = http.client.HTTPConnection("127.0.0.1", self.port, timeout=60)
        sent = {"Origin": f"http://127.0.0.1:{self.port}"} if method == "PUT" else {}
        if cookie and self.cookie:
            sent["Cookie"] = self.cookie
        sent.update(headers or {})
        try:
            connection.request(method, path, body=body, headers=sent)
            reply = connection.getresponse()
            return reply.status, dict(reply.getheaders()), reply.read()
        finally:
            connection.close()

    def log_in(self):
        status, headers, _ = self.request("GET", self.link[self.link.index("/?"):], cookie=False)
        expect(status == 303 and "Set-Cookie" in headers, f"the link is answered with {status} {headers}")
        self.cookie = headers["Set-Cookie"].split(";")[0]
        return self

    def project(self):
        status, _, body = self.request("GET", "/data/project.json")
        expect(status == 200, f"project.json: {status}")
        return json.loads(body)

    def socket(self, **options):
        return WebSocket(self.port, self.cookie, **options)

    def rss_bytes(self):
        """Resident memory of all processes that belong to it: under mpirun, the ranks too."""
        total = 0
        for name in os.listdir("/proc"):
            try:
                if name.isdigit() and os.getsid(int(name)) == self.process.pid:
                    with open(f"/proc/{name}/status", encoding="utf-8") as file:
                        total += int(re.search(r"VmRSS:\s+(\d+)", file.read()).group(1)) * 1024
            except (OSError, AttributeError):
                continue  # it has just ended
        return total

    def close(self, seconds=30):
        """Ends it as Ctrl-C does; returns its exit status."""
        if self.process.poll() is None:
            self.process.send_signal(2)
        try:
            self.process.wait(timeout=seconds)
            self.reader.join(5)
        except subprocess.TimeoutExpired as late:
            self.process.kill()
            raise Failure(f"the viewer does not end within {seconds} s of SIGINT:\n{self.printed}") from late
        return self.process.returncode


class WebSocket:
    def __init__(self, port, cookie, origin=None, host=None, hello=True):
        self.socket = socket.create_connection(("127.0.0.1", port), timeout=60)
        self.socket.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        self.buffer = b""
        own = f"127.0.0.1:{port}"
        lines = ["GET /ws HTTP/1.1", f"Host: {host or own}", "Upgrade: websocket", "Connection: Upgrade", "Sec-WebSocket-Version: 13",
                 "Sec-WebSocket-Key: " + base64.b64encode(os.urandom(16)).decode(), f"Origin: {origin or 'http://' + own}"]
        if cookie:
            lines.append(f"Cookie: {cookie}")
        self.socket.sendall(("\r\n".join(lines) + "\r\n\r\n").encode())
        while b"\r\n\r\n" not in self.buffer:
            self.fill()
        head, self.buffer = self.buffer.split(b"\r\n\r\n", 1)
        self.status = int(head.split()[1])
        self.welcome = None
        if self.status == 101 and hello:
            self.send({"type": "hello", "version": 1})
            self.welcome = self.text("welcome")

    def fill(self):
        data = self.socket.recv(1 << 18)
        if not data:
            raise ConnectionError("closed")
        self.buffer += data

    def take(self, count):
        while len(self.buffer) < count:
            self.fill()
        taken, self.buffer = self.buffer[:count], self.buffer[count:]
        return taken

    def send_frame(self, opcode, payload):
        mask = os.urandom(4)
        size = len(payload)
        head = bytes([0x80 | opcode])
        head += bytes([0x80 | size]) if size < 126 else bytes([0x80 | 126]) + struct.pack(">H", size) if size < 65536 else bytes([0x80 | 127]) + struct.pack(">Q", size)
        self.socket.sendall(head + mask + bytes(byte ^ mask[i % 4] for i, byte in enumerate(payload)))

    def send(self, message):
        self.send_frame(1, json.dumps(message).encode())

    def receive(self):
        """The next message: a dict, or the bytes of a frame."""
        whole, kind = b"", 0
        while True:
            first, second = self.take(2)
            size = second & 0x7F
            if size == 126:
                size = struct.unpack(">H", self.take(2))[0]
            elif size == 127:
                size = struct.unpack(">Q", self.take(8))[0]
            payload = self.take(size)
            opcode = first & 0x0F
            if opcode == 9:
                self.send_frame(10, payload)
                continue
            if opcode == 10:
                continue
            if opcode == 8:
                raise ConnectionError(f"closed: {struct.unpack('>H', payload[:2])[0] if len(payload) >= 2 else 0} {payload[2:].decode(errors='replace')}")
            if opcode:
                kind = opcode
            whole += payload
            if first & 0x80:
                return json.loads(whole) if kind == 1 else whole

    def text(self, kind):
        """The next text of this type; frames are acknowledged and dropped."""
        while True:
            message = self.receive()
            if isinstance(message, bytes):
                self.acknowledge(Frame(message))
            elif message["type"] == kind:
                return message
            elif message["type"] == "error":
                raise Failure(f"waiting for {kind}: {message}")

    def frame(self, seq):
        """The next frame of this view or a later one, acknowledged."""
        while True:
            message = self.receive()
            if isinstance(message, dict):
                if message["type"] == "error":
                    raise Failure(f"waiting for a frame: {message}")
                continue
            frame = Frame(message)
            self.acknowledge(frame)
            if frame.seq >= seq:
                return frame

    def last_frame(self, seq):
        while True:
            frame = self.frame(seq)
            if frame.complete:
                return frame

    def acknowledge(self, frame):
        self.send({"type": "ack", "seq": frame.seq, "pass": frame.number})

    def view(self, seq, eye, rotation, width, height, fovy=50.0, project="main"):
        self.send({"type": "view", "seq": seq, "project": project, "eye": list(eye), "rotation": list(rotation), "projection": "perspective",
                   "fovy_deg": fovy, "w": width, "h": height})

    def close(self):
        self.socket.close()


class Frame:
    """docs/viewer_protocol.md"""

    def __init__(self, data):
        magic, version, header, self.seq, self.revision = struct.unpack_from("<4sHHII", data, 0)
        expect(magic == b"SKYF" and version == 1 and header == 128, f"not a frame: {data[:16]}")
        self.number, self.passes, self.format, self.flags = struct.unpack_from("<4B", data, 16)
        self.width, self.height, self.x, self.y, self.w, self.h = struct.unpack_from("<6H", data, 20)
        self.near, self.far, self.depth_width, self.depth_height, color, depth = struct.unpack_from("<ffHHII", data, 96)
        expect(len(data) == header + color + depth, f"{len(data)} bytes instead of {header + color + depth}")
        self.color = data[header:header + color]
        self.depth = zlib.decompress(data[header + color:], -15) if depth else b""
        self.complete = self.number == self.passes - 1


def skip(text):
    print(f"skipped: {text}", flush=True)


def page_can_be_checked(web, script):
    """Whether the front end and Chromium are there; says what is missing."""
    if not (web / "dist_test" / script).exists():
        skip("the page: its front end was not built (nodejs, npm or the network was missing)")
        return False
    if not shutil.which("chromium"):
        skip("the page: chromium is not installed")
        return False
    return True


def looking(eye, target):
    """cam_from_enu as w, x, y, z of a level camera at `eye` that looks at `target` (not straight up or down)."""
    ahead = [t - e for t, e in zip(target, eye)]
    length = sum(a * a for a in ahead) ** 0.5
    ahead = [a / length for a in ahead]
    flat = (ahead[0] ** 2 + ahead[1] ** 2) ** 0.5
    right = [ahead[1] / flat, -ahead[0] / flat, 0.0]
    down = [ahead[1] * right[2] - ahead[2] * right[1], ahead[2] * right[0] - ahead[0] * right[2], ahead[0] * right[1] - ahead[1] * right[0]]
    m = [right, down, ahead]
    trace = m[0][0] + m[1][1] + m[2][2]
    # Shepperd's method: the largest of the four squares first.
    squares = [trace, m[0][0], m[1][1], m[2][2]]
    largest = squares.index(max(squares))
    if largest == 0:
        q = [1 + trace, m[2][1] - m[1][2], m[0][2] - m[2][0], m[1][0] - m[0][1]]
    else:
        i = largest - 1
        j, k = (i + 1) % 3, (i + 2) % 3
        q = [0.0] * 4
        q[0] = m[k][j] - m[j][k]
        q[1 + i] = 1 + m[i][i] - m[j][j] - m[k][k]
        q[1 + j] = m[i][j] + m[j][i]
        q[1 + k] = m[i][k] + m[k][i]
    size = sum(x * x for x in q) ** 0.5
    return [x / size for x in q]
