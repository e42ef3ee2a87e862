"""Images that the program sends while it renders, in the protocol of the viewer tev: each message has a uint32 length of all
of it, one byte of kind, and contents; little endian, texts end with a zero byte (tev's Ipc, version 1.19 and later)."""

import socket
import struct

import numpy as np

CREATE, UPDATE = 4, 6


class _Message:
    def __init__(self, data):
        self.data, self.at = data, 0

    def take(self, form):
        values = struct.unpack_from("<" + form, self.data, self.at)
        self.at += struct.calcsize("<" + form)
        return values

    def text(self):
        end = self.data.index(b"\0", self.at)
        value = self.data[self.at:end].decode()
        self.at = end + 1
        return value


class TevReceiver:
    """Listens for one program at `address`; `receive` hands over each image once it is whole."""

    def __init__(self):
        self._listener = socket.create_server(("127.0.0.1", 0))
        self.address = "127.0.0.1:%d" % self._listener.getsockname()[1]
        self._connection, self._data, self._image = None, b"", None

    def close(self):
        for end in (self._connection, self._listener):
            if end is not None:
                end.close()

    def receive(self, seconds):
        """Waits for `seconds` at most; (height, width, 4) float32, rows from the bottom, or None."""
        try:
            if self._connection is None:
                self._listener.settimeout(seconds)
                self._connection, _ = self._listener.accept()
            self._connection.settimeout(seconds)
            self._data += self._connection.recv(1 << 20)
        except (TimeoutError, socket.timeout, ConnectionError):
            return None
        newest = None
        while len(self._data) >= 4:
            (length,) = struct.unpack_from("<I", self._data)
            if len(self._data) < length:
                break
            message, self._data = self._data[4:length], self._data[length:]
            newest = self._understand(_Message(message)) or newest
        return None if newest is None else newest[0]

    def _understand(self, message):
        """(image,) where this message completes one."""
        (kind, _), _ = message.take("BB"), message.text()
        if kind == CREATE:
            width, height, _ = message.take("3i")
            self._image = np.ones((height, width, 4), np.float32)
        elif kind == UPDATE and self._image is not None:
            (count,) = message.take("i")
            channels = [message.text() for _ in range(count)]
            x, y, width, height = message.take("4i")
            offsets, strides = message.take(f"{count}q"), message.take(f"{count}q")
            values = np.frombuffer(message.data, "<f4", offset=message.at)
            for i, letter in enumerate("RGBA"):
                if letter not in channels:
                    continue  # opaque
                at = channels.index(letter)
                plane = values[offsets[at]:][:strides[at] * width * height:strides[at]]
                self._image[y:y + height, x:x + width, i] = plane.reshape(height, width)
            if y + height == len(self._image):
                return (self._image[::-1].copy(),)
        return None
