"""Messages between two processes, each whole and within a time; a limit holds for all of one."""

from __future__ import annotations

import socket
import struct
from time import monotonic

HEAD = struct.Struct(">Q")
CHUNK_BYTES = 1 << 20


class Closed(Exception):
    """The other side is gone, or said what is no message."""


class Channel:
    """One end of a connected pair of sockets.

    Parameters
    ----------
    end : socket
    """

    def __init__(self, end: socket.socket) -> None:
        self._end = end

    def send(self, message: bytes, limit_s: float | None = None) -> None:
        """Send a message.

        Raises
        ------
        TimeoutError
            If the other side does not take it in time.
        Closed
        """
        self._end.settimeout(limit_s)
        try:
            self._end.sendall(HEAD.pack(len(message)) + message)
        except TimeoutError:
            raise
        except OSError as error:
            raise Closed(str(error)) from error

    def receive(self, limit_s: float | None = None, most_bytes: int | None = None) -> bytes:
        """Wait for a message.

        Raises
        ------
        TimeoutError
            If it is not whole in time.
        Closed
            Also if it is larger than ``most_bytes``.
        """
        until = None if limit_s is None else monotonic() + limit_s
        (length,) = HEAD.unpack(self._bytes(HEAD.size, until))
        if most_bytes is not None and length > most_bytes:
            raise Closed(f"a message of {length} bytes, at most {most_bytes} are taken")
        return bytes(self._bytes(length, until))

    def close(self) -> None:
        """Close this end."""
        self._end.close()

    def _bytes(self, length: int, until: float | None) -> bytearray:
        taken = bytearray()
        while len(taken) < length:
            if until is not None and monotonic() >= until:
                raise TimeoutError
            self._end.settimeout(None if until is None else max(until - monotonic(), 1e-3))
            try:
                part = self._end.recv(min(length - len(taken), CHUNK_BYTES))
            except TimeoutError:
                raise
            except OSError as error:
                raise Closed(str(error)) from error
            if not part:
                raise Closed("the other side closed")
            taken += part
        return taken
