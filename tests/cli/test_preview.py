"""The live preview: a peer that speaks tev's protocol checks every byte, hangs, comes late or goes away."""

import array
import os
import signal
import socket
import struct
import subprocess
import sys
import threading
import time
import unittest

import exr
from support import DONE, PROGRAM, TINY, USAGE, CliTest, warnings_of

CREATE, UPDATE = 4, 6
SIZE = ["--resolution", "40x30"]


class Reader:
    """The contents of one message."""

    def __init__(self, data):
        self.data, self.at = data, 0

    def take(self, form):
        values = struct.unpack_from("<" + form, self.data, self.at)
        self.at += struct.calcsize("<" + form)
        return values if len(values) > 1 else values[0]

    def text(self):
        end = self.data.index(b"\0", self.at)
        value = self.data[self.at : end].decode()
        self.at = end + 1
        return value


class Peer:
    """The state that tev keeps: the images that were created and updated. Raises in messages() where a byte is out
    of place."""

    def __init__(self):
        self.listener = socket.create_server(("127.0.0.1", 0))
        self.address = "127.0.0.1:%d" % self.listener.getsockname()[1]
        self.images, self.focus, self.updates, self.error = {}, [], 0, None
        self.thread = threading.Thread(target=self.serve, daemon=True)

    def start(self):
        self.thread.start()
        return self

    def serve(self):
        try:
            connection, _ = self.listener.accept()
            with connection:
                while header := self.exactly(connection, 4):
                    self.message(Reader(self.exactly(connection, struct.unpack("<I", header)[0] - 4)))
        except Exception as e:  # for the main thread, which fails the test
            self.error = e
        finally:
            self.listener.close()

    @staticmethod
    def exactly(connection, count):
        data = b""
        while len(data) < count:
            part = connection.recv(count - len(data))
            if not part:
                if data:
                    raise ValueError("ended in the middle of a message")
                return data
            data += part
        return data

    def message(self, m):
        kind, focus = m.take("BB")
        name = m.text()
        if kind == CREATE:
            width, height, count = m.take("iii")
            channels = [m.text() for _ in range(count)]
            self.focus.append(focus)
            self.images[name] = {c: array.array("f", bytes(4 * width * height)) for c in channels}
            self.size = width, height
        elif kind == UPDATE:
            self.updates += 1
            channels = [m.text() for _ in range(m.take("i"))]
            x, y, width, height = m.take("iiii")
            offsets = [m.take("q") for _ in channels]
            strides = [m.take("q") for _ in channels]
            values = array.array("f", m.data[m.at :])
            last = max(o + (width * height - 1) * s for o, s in zip(offsets, strides))
            if len(values) != last + 1:
                raise ValueError(f"{len(values)} values, not {last + 1}")
            m.at = len(m.data)
            for channel, offset, stride in zip(channels, offsets, strides):
                target = self.images[name][channel]
                for row in range(height):
                    for column in range(width):
                        i = (y + row) * self.size[0] + x + column
                        target[i] = values[offset + stride * (row * width + column)]
        else:
            raise ValueError(f"unknown message {kind}")
        if m.at != len(m.data):
            raise ValueError(f"{len(m.data) - m.at} bytes too many")


@unittest.skipIf(sys.byteorder == "big", "compares little-endian values")
class Preview(CliTest):
    def finished(self, peer):
        peer.thread.join(10)
        self.assertFalse(peer.thread.is_alive())
        self.assertIsNone(peer.error)
        return peer

    def test_the_viewer_ends_with_the_image_of_the_file(self):
        for arguments in (["--method", "uniform"], ["--crop", "5,3,37,29"]):
            with self.subTest(arguments=arguments):
                peer = Peer().start()
                image = exr.read(self.rendered(*SIZE, *arguments, "--spp", "30", "--tev", peer.address))
                self.finished(peer)
                self.assertEqual((peer.size, list(peer.images), peer.focus), ((40, 30), ["out.exr"], [1]))
                self.assertGreater(peer.updates, 2)  # passes before the last
                x0, y0, x1, y1 = image.data_window
                for c in "RGB":
                    shown = peer.images["out.exr"][c]
                    for y in range(30):
                        for x in range(40):
                            inside = x0 <= x < x1 and y0 <= y < y1
                            expected = image.pixels[c][(y - y0) * (x1 - x0) + x - x0] if inside else 0
                            self.assertEqual(shown[y * 40 + x], expected)

    def test_chosen_layers(self):
        peer = Peer().start()
        image = exr.read(self.rendered(*SIZE, "--spp", "8", "--tev", peer.address, "--tev-layers", "samples,Z,filter", "--layers", "none"))
        self.finished(peer)
        shown = peer.images["out.exr"]
        self.assertEqual(set(shown), {"R", "G", "B", "A", "Z", "samples.Y", "filter.xx", "filter.xy", "filter.yy"})
        self.assertEqual(set(image.channels), {"R", "G", "B", "A"})
        self.assertGreaterEqual(min(shown["samples.Y"]), 1)

    def test_a_viewer_that_is_absent_changes_nothing(self):
        plain = self.rendered(*SIZE, "--reproducible", output="plain.exr").read_bytes()
        with socket.socket() as closed:
            closed.bind(("127.0.0.1", 0))
            port = closed.getsockname()[1]
            for address in (f"127.0.0.1:{port}", "no-such-host.invalid:1"):
                path = self.rendered(*SIZE, "--reproducible", "--tev", address, output="shown.exr", timeout=20)
                self.assertEqual(path.read_bytes(), plain)

    def test_a_viewer_that_is_absent_is_told_once(self):
        """The warning comes, too, for renders so short, and for names so slow to look up, that nothing is known
        before the end."""
        with socket.socket() as closed:
            closed.bind(("127.0.0.1", 0))
            port = closed.getsockname()[1]
            for address, why in (
                (f"127.0.0.1:{port}", "Connection refused"),
                ("no-such-host.invalid:1", ""),
                ("no-such-host.invalid", ""),  # the port is tev's own
            ):
                for spp in ("1", "64"):
                    with self.subTest(address=address, spp=spp):
                        result = self.render(TINY, *SIZE, "--spp", spp, "--method", "uniform", "--tev", address, timeout=30)
                        self.assertEqual(result.code, DONE, result)
                        [(_, text)] = warnings_of(result)
                        for fragment in ("--tev", "tev is not there", f"'{address}'", why):
                            self.assertIn(fragment, text)
                        self.assertNotRegex(text, r": $")
            result = self.render(TINY, "--spp", "1", "--quiet", "--tev", f"127.0.0.1:{port}")
            self.assertEqual((result.code, result.stderr), (DONE, ""))

    def test_a_viewer_that_is_there_is_no_warning(self):
        peer = Peer().start()
        result = self.render(TINY, *SIZE, "--spp", "4", "--tev", peer.address)
        self.finished(peer)
        self.assertEqual((result.code, warnings_of(result)), (DONE, []), result)

    def test_a_viewer_that_comes_late(self):
        peer = Peer()
        port = peer.address.split(":")[1]
        peer.listener.close()
        self.write("scene.pbrt", TINY)
        command = [PROGRAM, "render", "scene.pbrt", "-o", "out.exr", "--quiet", "--time", "3", *SIZE, "--tev", f"127.0.0.1:{port}"]
        render = subprocess.Popen(command, cwd=self.folder)
        time.sleep(0.7)
        peer.listener = socket.create_server(("127.0.0.1", int(port)))
        peer.start()
        self.assertEqual(render.wait(30), DONE)
        self.finished(peer)
        self.assertEqual(list(peer.images["out.exr"]["R"]), list(exr.read(self.folder / "out.exr").pixels["R"]))

    def test_a_viewer_that_hangs_or_is_killed(self):
        """The viewer is a process of its own, stopped with SIGSTOP before anything is read, or killed after the
        first bytes."""
        plain = self.rendered("--resolution", "200x150", "--spp", "4", "--reproducible", output="plain.exr").read_bytes()
        viewer = (
            "import socket, sys\n"
            "l = socket.create_server(('127.0.0.1', 0)); print(l.getsockname()[1], flush=True)\n"
            "c, _ = l.accept()\n"
            "while True: c.recv(1000)\n"
        )
        for stop in (signal.SIGSTOP, signal.SIGKILL):
            with self.subTest(signal=stop.name):
                process = subprocess.Popen([sys.executable, "-c", viewer], stdout=subprocess.PIPE, text=True)
                self.addCleanup(process.wait)
                self.addCleanup(process.stdout.close)
                self.addCleanup(process.kill)
                port = process.stdout.readline().strip()
                timer = threading.Timer(0.3 if stop == signal.SIGKILL else 0, os.kill, (process.pid, stop))
                timer.start()
                layers = ["--tev-layers", "all"]  # more than the buffers of a socket hold
                arguments = ["--resolution", "200x150", "--spp", "4", "--reproducible", "--tev", f"127.0.0.1:{port}", *layers]
                path = self.rendered(*arguments, output="shown.exr", timeout=60)
                self.assertEqual(path.read_bytes(), plain)
                timer.join()

    def test_wrong_addresses(self):
        for address in ("", ":1", "host:", "host:0", "host:70000", "host:x", "a:b:1", "[::1"):
            self.assert_fails(self.render(TINY, f"--tev={address}"), USAGE, "--tev")
        self.assert_fails(self.render(TINY, "--tev-layers", "nope"), USAGE, "--tev-layers", "nope")
        self.assert_fails(self.render(TINY, "--tev-layers", "raw"), USAGE, "--tev-layers", "--tev HOST:PORT")


if __name__ == "__main__":
    unittest.main()
