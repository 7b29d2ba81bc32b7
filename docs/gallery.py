"""The pictures and films of the documents, each made by the commands that its page shows.

    python docs/gallery.py [FOLDER [NAME ...]]

writes all of them, or those with the names, to docs/images or the folder.
"""

from __future__ import annotations

import os
import shlex
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

from PIL import Image

ROOT = Path(__file__).parents[1]
COLOURS = 256  # enough for rendered scenes, at a third of the size
TEACH = ('tell "A knife is used for cutting"', 'tell "To pass a knife grab the knife by the blade"')
HAND_OVER = 'do "pass me something used for cutting"'
POUND = ('tell "A hammer is used for pounding"', 'do "pound the nail"')
PICTURES = {
    "pass.gif": (*TEACH, f"{HAND_OVER} --scene objects:knife,mug,spoon --record pass.gif"),
    "pass.png": (*TEACH, f"{HAND_OVER} --record pass.png"),
    "pound.gif": (POUND[0], f"{POUND[1]} --scene objects:nail,hammer,mug --record pound.gif"),
    "kuka.png": (*TEACH, f"{HAND_OVER} --robot kuka --seed 1 --record kuka.png"),
    "scene.png": ("scene show --names --out scene.png",),
    "crowd.png": ("scene show --scene random:7 --out crowd.png",),
    "derivation.svg": ('parse "A knife is used for cutting" --svg derivation.svg',),
    "proof.svg": (*TEACH, 'explain "pass me something used for cutting" --svg proof.svg'),
    "rules.svg": ("import examples/kitchen_rules.yaml", "graph rules.svg"),
}


# Pictures of the page of `hilt serve`: its tests take them in a browser, into out/page.
PAGE_PICTURES = {"page.png": "wide.png", "page_dark.png": "tablet_dark.png"}


def make(name: str, folder: Path) -> Path:
    """Write one of `PICTURES` or `PAGE_PICTURES` into a folder, and return its path.

    Raises:
        CalledProcessError: a command failed.
        FileNotFoundError: the tests of the page did not run.
    """
    path = folder.resolve() / name
    if name in PAGE_PICTURES:
        shutil.copy(ROOT / "out" / "page" / PAGE_PICTURES[name], path)
    with tempfile.TemporaryDirectory() as base:
        for command in PICTURES.get(name, ()):
            words = [str(path) if word == name else word for word in shlex.split(command)]
            subprocess.run(  # noqa: S603 - the commands above
                [Path(sys.executable).with_name("hilt"), *words],
                check=True,
                cwd=ROOT,
                env={**os.environ, "HILT_KB": base},
                stdout=subprocess.DEVNULL,
            )
    if path.suffix == ".png":
        reduced = Image.open(path).quantize(COLOURS, method=Image.Quantize.MAXCOVERAGE, kmeans=2)
        reduced.save(path, optimize=True)
    return path


def main(folder: str = str(ROOT / "docs" / "images"), *names: str) -> None:
    """Write the pictures with the names, or all."""
    Path(folder).mkdir(parents=True, exist_ok=True)
    for name in names or (*PICTURES, *PAGE_PICTURES):
        path = make(name, Path(folder))
        sys.stdout.write(f"{path.stat().st_size:8} {path}\n")


if __name__ == "__main__":
    main(*sys.argv[1:])
