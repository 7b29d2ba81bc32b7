"""Files as streams, compressed or not, standard input and output, and limits on their size.

A hostile file must not fill the memory. Document types in XML, which expand when they are read, and
huge single values are refused, and what has to be read whole has a maximum size.
"""

import codecs
import gzip
import io
import os
import sys
import tempfile
import zlib
from collections.abc import Generator, Iterator
from contextlib import contextmanager, nullcontext, suppress
from pathlib import Path
from typing import BinaryIO, cast

from ...ontology.errors import DataError
from ..bulk.exporter import Progress
from .registry import PACKED, STREAM, FileFormat

MAX_STATEMENT = 64 * 2**20  # bytes that may be read before one statement is complete
MAX_LINE = 2**20  # characters of one line of a table
_GZIP = b"\x1f\x8b"
_DOCTYPE = b"<!DOCTYPE"
_CHUNK = 2**20


class CheckedStream(io.RawIOBase):
    """A stream that counts and checks what a parser reads of it."""

    def __init__(
        self, stream: BinaryIO, name: str, chosen: FileFormat, progress: Progress | None = None
    ) -> None:
        super().__init__()
        self.name = name
        self._stream, self._chosen, self._progress = stream, chosen, progress
        self._read = self._since_statement = 0
        self._tail = b""

    def readable(self) -> bool:
        """Return True."""
        return True

    def report_statement(self) -> None:
        """Note that a statement is complete."""
        self._since_statement = 0

    def readinto(self, buffer: memoryview, /) -> int:  # pyright: ignore[reportIncompatibleMethodOverride]
        """Read bytes into a buffer, and return their number; DataError if they are refused."""
        try:
            found = self._stream.read(min(len(buffer), _CHUNK))
            if not self._read and found.startswith(codecs.BOM_UTF8):
                found = found.removeprefix(codecs.BOM_UTF8) or self._stream.read(len(buffer))
        except (OSError, EOFError, zlib.error) as error:
            raise self._refused(f"cannot be read: {str(error).rstrip('.')}.") from error
        self._check(found)
        buffer[: len(found)] = found
        return len(found)

    def lines(self) -> Iterator[str]:
        """Iterate over its lines; DataError if it is no UTF-8, or a line is too long."""
        text = io.TextIOWrapper(io.BufferedReader(self), encoding="utf-8-sig", newline="")
        number = 0
        try:
            while line := text.readline(MAX_LINE):
                number += 1
                if len(line) >= MAX_LINE:
                    raise DataError("is too long a line.", source=self.name, line=number)
                self.report_statement()
                yield line
        except UnicodeDecodeError as error:
            line = number + 1 + error.object[: error.start].count(b"\n")
            raise DataError("expected UTF-8 text.", source=self.name, line=line) from error
        finally:
            with suppress(ValueError):  # the file is closed, where its reader gave up
                text.detach()

    def _check(self, found: bytes) -> None:
        self._read += len(found)
        self._since_statement += len(found)
        if (most := self._chosen.most) is not None and self._read > most:
            raise self._refused(
                f"is larger than {most // 2**20} MB, which is too much for this format. "
                "Take CSV, N-Quads or Turtle."
            )
        if self._since_statement > MAX_STATEMENT:
            raise self._refused(f"holds no whole statement in {MAX_STATEMENT // 2**20} MB.")
        if self._chosen.is_xml:  # whose entities unfold: some hundred bytes become gigabytes
            # In UTF-16 and UTF-32 every ASCII character has a zero byte: the search would miss it.
            if b"\0" in found:
                raise self._refused("expected UTF-8 text, found bytes that are zero.")
            if _DOCTYPE in (self._tail + found).upper():
                raise self._refused("has a document type (<!DOCTYPE), which is refused.")
            self._tail = found[-len(_DOCTYPE) :]
        if self._progress:
            self._progress(self._read)

    def _refused(self, problem: str) -> DataError:
        return DataError(problem, source=self.name)


@contextmanager
def open_input(
    file: str, chosen: FileFormat, progress: Progress | None = None
) -> Generator[CheckedStream]:
    """A file as a stream, unpacked where it is packed; "-" is standard input.

    `progress` is called with how many bytes have been read. DataError if the file cannot be read.
    """
    try:
        opened = nullcontext(sys.stdin.buffer) if file == STREAM else Path(file).open("rb")  # noqa: SIM115
    except OSError as error:
        raise DataError(f"cannot be read: {error.strerror}.", source=file) from error
    with opened as plain:
        stream = plain if plain.seekable() else io.BufferedReader(cast(io.RawIOBase, plain))

        def report(read: int) -> None:
            if progress:  # of a packed file, its own bytes are told
                progress(plain.tell() if plain.seekable() else read)

        peek = getattr(stream, "peek", None)
        head = cast(bytes, peek(2))[:2] if peek else b""
        if head == _GZIP or (not peek and file.endswith(PACKED)):
            stream = cast(BinaryIO, gzip.GzipFile(fileobj=stream))
        elif file.endswith(PACKED):
            problem = f"is called {PACKED} and is not packed by gzip. Rename it, or pack it."
            raise DataError(problem, source=file)
        yield CheckedStream(stream, file, chosen, report)


@contextmanager
def open_output(file: str) -> Generator[BinaryIO]:
    """Open a file for writing, compressed where its name ends in .gz; "-" is standard output.

    It replaces an existing file when all is written, not before. DataError if it cannot be written.
    """
    try:
        if file == STREAM:
            yield sys.stdout.buffer
            sys.stdout.buffer.flush()
            return
        handle, name = tempfile.mkstemp(dir=Path(file).parent, prefix=f".{Path(file).name}.")
        try:
            with os.fdopen(handle, "wb") as stream:
                if file.endswith(PACKED):
                    # Without name and time, so that the same content is the same file.
                    with gzip.GzipFile("", "wb", 6, stream, mtime=0) as packed:
                        yield cast(BinaryIO, packed)
                else:
                    yield stream
            Path(name).chmod(0o644)
            Path(name).replace(file)
        except BaseException:
            Path(name).unlink(missing_ok=True)
            raise
    except OSError as error:
        if isinstance(error, BrokenPipeError):
            raise
        raise DataError(f"cannot be written: {error.strerror or error}.", source=file) from error
