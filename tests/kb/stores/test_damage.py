"""Claims about damaged files: a base is opened with its full content or refused in one line.

A few bits are flipped in every run of the tests; two hundred, over all files of a base, by

    HILT_FLIPS=200 pytest tests/kb/stores/test_damage.py -k flipped -s
"""

from __future__ import annotations

import json
import os
import random
import shutil
import subprocess
import sys
import threading
from collections import Counter
from collections.abc import Iterator
from contextlib import closing
from pathlib import Path
from subprocess import PIPE

import pytest

from hilt.kb.backup import backup, restore
from hilt.kb.knowledge_base import KnowledgeBase
from hilt.kb.stores.base import EmbeddedStore
from hilt.kb.stores.opening import open_store
from hilt.ontology.errors import InUseError, StoreError

FLIPS = int(os.environ.get("HILT_FLIPS", "20"))

# Teaches a base so many sentences in each of several sessions, and closes it or dies at the end.
MAKER = """
import os, sys
from hilt.kb import Interval, KnowledgeBase, functional
from hilt.kb.stores import mark
mark.MAX_LOGGED_CHANGES = 30  # so that the tables are written now and then
place, end, *counts = sys.argv[1:]
for count in counts:
    kb = KnowledgeBase.open(place)
    for number in range(int(count)):
        said = f"thing {kb.sequence + 1}"
        kb.believe(said, "", "sam", [functional(said, "cutting", interval=Interval(0.95, 1))])
    if end == "killed" and count == counts[-1]:
        os._exit(0)
    kb.close()
"""
BASES = {
    "closed": ("closed", "8"),
    "reopened": ("closed", "5", "40"),
    "killed": ("killed", "8"),
    "long": ("killed", "70"),
    "again": ("killed", "40", "9"),
}

# Reads the folders that stdin names: what each holds, or why it is refused, as a line of JSON.
READER = """
import json, sys
from hilt.kb import KnowledgeBase
from hilt.ontology.errors import StoreError

def content(folder, read_only):
    with KnowledgeBase.open(folder, read_only=read_only) as kb:
        said = [one.text for one in kb.history()]
        rules = len(kb.rules())
        return sorted(map(str, kb.store.quads())) + [str(said), str(rules)]

for line in sys.stdin:
    for read_only in (True, False):
        try:
            found = {"content": content(line.strip(), read_only)}
        except StoreError as error:
            found = {"refused": str(error)}
        print(json.dumps(found), flush=True)
"""


class Reader:
    """A process that reads bases, begun again when one has made it die or hang."""

    def __init__(self) -> None:
        self.begin()

    def begin(self) -> None:
        """Start the process."""
        self._process = subprocess.Popen(
            [sys.executable, "-c", READER], stdin=PIPE, stdout=PIPE, stderr=PIPE, text=True
        )

    def read(self, folder: Path) -> list[dict[str, object]]:
        """What a process that only reads, and then an owner, makes of a folder."""
        process = self._process
        assert process.stdin and process.stdout
        watch = threading.Timer(20, process.kill)
        watch.start()
        print(folder, file=process.stdin, flush=True)
        lines = [process.stdout.readline() for _ in range(2)]
        watch.cancel()
        if all(lines):
            return [json.loads(line) for line in lines]
        died = self.end()
        self.begin()
        return [{"died": died}]

    def end(self) -> str:
        """End the process; what it said when it died."""
        self._process.stdin.close()
        said = self._process.stderr.read()
        for stream in (self._process.stdout, self._process.stderr):
            stream.close()
        return f"{self._process.wait()} {said[-600:]}"


@pytest.fixture(scope="module")
def bases(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with each of `BASES`."""
    place = tmp_path_factory.mktemp("bases")
    for name, how in BASES.items():
        subprocess.run([sys.executable, "-c", MAKER, str(place / name), *how], check=True)
    return place


@pytest.fixture
def reader() -> Iterator[Reader]:
    """A process that reads bases."""
    opened = Reader()
    yield opened
    opened.end()


def damage(file: Path, at: int, bit: int) -> None:
    """Flip a bit of a file."""
    data = bytearray(file.read_bytes())
    data[at] ^= 1 << bit
    file.write_bytes(data)


def judge(found: dict[str, object], whole: object) -> str:
    """Whether a base is as it was, or is refused as it should be; else what happened."""
    if "content" in found:
        return "whole" if found["content"] == whole else "less in silence"
    refusal = found.get("refused")
    return "refused" if isinstance(refusal, str) and "\n" not in refusal else f"{found}"


def test_flipped_bit_is_never_a_loss_in_silence(bases: Path, tmp_path: Path, reader: Reader):
    """Whatever bit of whatever file is flipped, nobody finds less than was acknowledged."""
    moments = random.Random(FLIPS)  # noqa: S311 - nothing secret
    tally = Counter[tuple[str, str]]()
    whole = {
        name: reader.read(Path(shutil.copytree(bases / name, tmp_path / name)))[0] for name in BASES
    }
    for number in range(FLIPS):
        name = list(BASES)[number % len(BASES)]
        copy = Path(shutil.copytree(bases / name, tmp_path / f"copy{number}"))
        file = moments.choice(sorted(file for file in copy.iterdir() if file.stat().st_size))
        at, bit = moments.randrange(file.stat().st_size), moments.randrange(8)

        damage(file, at, bit)

        kind = file.suffix or file.name.partition("-")[0]
        for found in reader.read(copy):
            verdict = judge(found, whole[name]["content"])
            assert verdict in {"whole", "refused"}, (name, file.name, at, bit, verdict)
            tally[kind, verdict] += 1
        shutil.rmtree(copy)
    print(*sorted(tally.items()), sep="\n")  # noqa: T201 - with -s
    assert sum(number for (_, verdict), number in tally.items() if verdict == "refused")


@pytest.mark.parametrize("name", BASES)
def test_damaged_manifest_is_refused_or_does_no_harm(
    bases: Path, tmp_path: Path, reader: Reader, name: str
):
    """Neither the head of a record nor its content can be wrong without notice; nothing hangs."""
    (manifest,) = (bases / name).glob("MANIFEST-*")
    size = manifest.stat().st_size
    whole = reader.read(Path(shutil.copytree(bases / name, tmp_path / "whole")))[0]["content"]
    for back in range(1, 200, max(1, 2000 // FLIPS)):
        copy = Path(shutil.copytree(bases / name, tmp_path / f"copy{back}"))
        damage(copy / manifest.name, size - back, back % 8)
        verdicts = {judge(found, whole) for found in reader.read(copy)}
        assert verdicts <= {"whole", "refused"}, (back, verdicts)
        shutil.rmtree(copy)


@pytest.mark.parametrize("harm", ["flip", "cut", "remove"])
def test_log_that_lost_something_is_refused(bases: Path, tmp_path: Path, harm: str):
    """The refusal is one line that names the base, what is wrong and what to do."""
    folder = Path(shutil.copytree(bases / "killed", tmp_path / "kb"))
    log = max(folder.glob("*.log"), key=lambda file: file.stat().st_size)
    match harm:
        case "flip":
            damage(log, log.stat().st_size // 2, 3)
        case "cut":
            os.truncate(log, log.stat().st_size - 1)
        case _:
            log.unlink()
    for read_only in (True, False):
        with pytest.raises(StoreError, match=r"utterance 8.*Restore a backup") as refusal:
            KnowledgeBase.open(folder, read_only=read_only)
        assert str(folder) in str(refusal.value) and log.name in str(refusal.value)

    (folder / "acknowledged").unlink()  # as the message says
    with KnowledgeBase.open(folder) as kb:
        assert kb.sequence < 8


def test_every_table_is_read_by_a_deep_check(bases: Path, tmp_path: Path):
    """A flipped bit in the middle of any of them is found; so it is of none that is whole."""

    def check(folder: Path) -> None:
        with closing(open_store(folder, read_only=True)) as store:
            assert isinstance(store, EmbeddedStore)
            store.check_tables()

    for table in (bases / "reopened").glob("*.sst"):
        copy = Path(shutil.copytree(bases / "reopened", tmp_path / table.stem))
        check(copy)
        damage(copy / table.name, table.stat().st_size // 4, 5)
        with pytest.raises(StoreError, match=r"damaged|failed: Corruption"):
            check(copy)


def test_refused_base_is_not_kept_open(bases: Path, tmp_path: Path):
    """Whoever still has the error can restore the folder, and open it, at once."""
    refusals = []
    for table in (bases / "closed").glob("*.sst"):
        copy = Path(shutil.copytree(bases / "closed", tmp_path / table.stem))
        damage(copy / table.name, table.stat().st_size // 4, 5)
        for _ in range(2):
            try:
                KnowledgeBase.open(copy).close()
            except StoreError as refusal:
                refusals.append(refusal)
    assert refusals
    assert not any(isinstance(refusal, InUseError) for refusal in refusals)


def test_damaged_mark_is_refused(bases: Path, tmp_path: Path):
    """A mark that cannot be believed is said, whoever opens the base."""
    folder = Path(shutil.copytree(bases / "killed", tmp_path / "kb"))
    damage(folder / "acknowledged", 12, 1)
    for read_only in (True, False):
        with pytest.raises(StoreError, match=r"acknowledged.* damaged"):
            KnowledgeBase.open(folder, read_only=read_only)


def test_base_that_another_program_made_smaller_is_refused(bases: Path, tmp_path: Path):
    """What the engine's own files cannot tell, the number of the last utterance does."""
    folder = Path(shutil.copytree(bases / "killed", tmp_path / "kb"))
    marked = (folder / "acknowledged").read_bytes()
    log = max(folder.glob("*.log"), key=lambda file: file.stat().st_size)
    damage(log, log.stat().st_size // 2, 3)
    (folder / "acknowledged").unlink()
    KnowledgeBase.open(folder).close()
    (folder / "acknowledged").write_bytes(marked)
    with pytest.raises(StoreError, match=r"ends with utterance [0-7],"):
        KnowledgeBase.open(folder)


def test_backup_has_a_mark(bases: Path, tmp_path: Path):
    """A backup whose log is damaged later is refused, too."""
    folder = Path(shutil.copytree(bases / "killed", tmp_path / "kb"))
    with KnowledgeBase.open(folder) as kb:
        backup(kb, tmp_path / "saved")
    (manifest,) = (tmp_path / "saved").glob("MANIFEST-*")
    damage(manifest, manifest.stat().st_size - 3, 2)
    with pytest.raises(StoreError, match="MANIFEST"):
        restore(tmp_path / "saved", str(tmp_path / "back"))


def test_base_of_an_earlier_version_gets_a_mark(tmp_path: Path):
    """A base without a mark opens, and has one from then on."""
    KnowledgeBase.open(tmp_path / "kb").close()
    (tmp_path / "kb" / "acknowledged").unlink()
    KnowledgeBase.open(tmp_path / "kb", read_only=True).close()
    KnowledgeBase.open(tmp_path / "kb").close()
    assert (tmp_path / "kb" / "acknowledged").exists()
