"""Mutation testing of the inference and of the execution of action trees.

    python benchmarks/mutation.py                       every mutant, which takes hours
    python benchmarks/mutation.py --sample 40 --seed 1  some of them
    python benchmarks/mutation.py --only decision.py    those of files with this in their path
    python benchmarks/mutation.py --evaluate paper      which ones `hilt evaluate paper` notices

A mutant is the program with one operator or constant replaced. It is killed if a test fails, or if
the tests take longer than the limit; those that survive are printed: each is a behaviour that no
test states, or a change without effect. No file is changed: the mutant is compiled in a process of
its own when its module is imported.
"""

from __future__ import annotations

import argparse
import ast
import random
import subprocess
import sys
from collections.abc import Callable, Generator, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from importlib.machinery import SourceFileLoader
from pathlib import Path
from types import CodeType

ROOT = Path(__file__).parents[1]
FILES = (
    *sorted((ROOT / "inference").glob("[a-z]*.py")),
    ROOT / "agent" / "execution" / "action_tree_executor.py",
)
TESTS = ("tests/inference", "tests/agent/execution")
TIME_LIMIT_S = 300.0

COMPARISONS: dict[type[ast.cmpop], ast.cmpop] = {
    ast.Gt: ast.GtE(), ast.GtE: ast.Gt(), ast.Lt: ast.LtE(), ast.LtE: ast.Lt(),
    ast.Eq: ast.NotEq(), ast.NotEq: ast.Eq(), ast.In: ast.NotIn(), ast.NotIn: ast.In(),
    ast.Is: ast.IsNot(), ast.IsNot: ast.Is(),
}  # fmt: skip
ARITHMETIC: dict[type[ast.operator], ast.operator] = {
    ast.Add: ast.Sub(), ast.Sub: ast.Add(), ast.Mult: ast.Div(), ast.Div: ast.Mult(),
}  # fmt: skip

Edit = Callable[[], None]


@dataclass(frozen=True)
class Mutant:
    """One change of a file: the position among its mutants, the line, and what is replaced."""

    path: Path
    index: int
    line: int
    change: str

    def __str__(self) -> str:
        return f"{self.path.relative_to(ROOT)}:{self.line} {self.change}"


def mutants(path: Path) -> list[Mutant]:
    """Return the mutants of a file."""
    found = edits(ast.parse(path.read_text(encoding="utf-8")))
    return [Mutant(path, i, line, change) for i, (line, change, _) in enumerate(found)]


def edits(tree: ast.Module) -> Iterator[tuple[int, str, Edit]]:
    """Yield the changes of a module: line, description, and what makes the change in the tree."""
    for node in ast.walk(tree):
        for name, value in ast.iter_fields(node):
            children: Sequence[object] = value if isinstance(value, list) else [value]
            for place, child in enumerate(children):
                if isinstance(child, ast.expr):
                    for new in replacements(child, is_condition=_is_condition(node, name)):
                        put = _putter(node, name, place if isinstance(value, list) else None, new)
                        yield child.lineno, f"{ast.unparse(child)} -> {ast.unparse(new)}", put


def replacements(found: ast.expr, *, is_condition: bool) -> Iterator[ast.expr]:
    """Yield what an expression is replaced by."""
    match found:
        case ast.Compare(left, [operator], [right]):
            yield ast.Compare(left, [COMPARISONS[type(operator)]], [right])
        case ast.BoolOp(operator, values):
            yield ast.BoolOp(ast.Or() if isinstance(operator, ast.And) else ast.And(), values)
        case ast.UnaryOp(ast.Not(), operand):
            yield operand
        case ast.BinOp(left, operator, right) if type(operator) in ARITHMETIC:
            yield ast.BinOp(left, ARITHMETIC[type(operator)], right)
        case ast.Constant(bool() as value):
            yield ast.Constant(not value)
        case ast.Constant(int() | float() as value):
            yield ast.Constant(value + 1)
        case _:
            pass
    if is_condition and not isinstance(found, ast.Constant):
        yield from (ast.Constant(value=True), ast.Constant(value=False))


def _is_condition(parent: ast.AST, name: str) -> bool:
    """Whether a field holds a truth value: a condition, or what a predicate returns."""
    if isinstance(parent, ast.If | ast.IfExp):
        return name == "test"
    return isinstance(parent, ast.Return) and isinstance(parent.value, ast.Compare | ast.BoolOp)


def _putter(node: ast.AST, name: str, place: int | None, new: ast.expr) -> Edit:
    if place is None:
        return lambda: setattr(node, name, new)
    return lambda: getattr(node, name).__setitem__(place, new)


def compile_mutant(path: Path, index: int) -> CodeType:
    """Return the code of a file with the mutation of this position."""
    tree = ast.parse(path.read_text(encoding="utf-8"))
    [*edits(tree)][index][2]()
    return compile(ast.fix_missing_locations(tree), str(path), "exec")


@contextmanager
def mutated(path: Path, index: int) -> Generator[None]:
    """Put a mutant in the place of its module, which is not imported yet, for the block."""
    original, code = SourceFileLoader.get_code, compile_mutant(path, index)

    def get_code(self: SourceFileLoader, fullname: str) -> CodeType | None:
        return code if path.samefile(self.path) else original(self, fullname)

    SourceFileLoader.get_code = get_code
    yield
    SourceFileLoader.get_code = original


def run_tests(path: Path, index: int, tests: Sequence[str]) -> int:
    """Run tests in this process with a mutant in place of its module; return the exit code."""
    import pytest

    # Without cache: no file is written, and failures of one mutant do not order another's tests.
    options = ["-x", "-q", "-m", "not sim", "-p", "no:cacheprovider", "-p", "no:benchmark"]
    with mutated(path, index):
        return int(pytest.main([*options, *tests]))


def run_evaluation(path: Path, index: int, name: str) -> int:
    """Run an evaluation in this process with a mutant; return the exit code: 0 if all is right."""
    from hilt.agent.cli import main

    with mutated(path, index):
        try:
            main(["evaluate", name, "--json"])
        except SystemExit as end:
            return int(end.code or 0)
    return 0


def survives(mutant: Mutant, options: Sequence[str], limit_s: float) -> bool:
    """Whether all tests pass with a mutant within the time limit [s]."""
    arguments = ["--run", f"{mutant.path}:{mutant.index}", *options]
    command = [sys.executable, __file__, *arguments]
    try:
        done = subprocess.run(  # noqa: S603 - this file, with a path of its own
            command, cwd=ROOT, timeout=limit_s, capture_output=True, check=False
        )
    except subprocess.TimeoutExpired:
        return False
    return done.returncode == 0


def main() -> int:
    """Print the mutants that survive, and return 1 if there are any."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else "")
    parser.add_argument("--only", default="", help="a part of the paths of the files to mutate")
    parser.add_argument("--change", default="", help="a part of the line that shows the mutant")
    parser.add_argument("--sample", type=int, help="how many mutants to draw")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--limit", type=float, default=TIME_LIMIT_S, help="seconds for a mutant")
    parser.add_argument("--tests", nargs="+", default=list(TESTS))
    parser.add_argument("--evaluate", help="an evaluation that is run instead of the tests")
    parser.add_argument("--run", help=argparse.SUPPRESS)
    chosen = parser.parse_args()
    if chosen.run:
        path, _, index = chosen.run.rpartition(":")
        if chosen.evaluate:
            return run_evaluation(Path(path), int(index), chosen.evaluate)
        return run_tests(Path(path), int(index), chosen.tests)
    options = ["--evaluate", chosen.evaluate] if chosen.evaluate else ["--tests", *chosen.tests]
    paths = [path for path in FILES if chosen.only in str(path.relative_to(ROOT))]
    found = [each for path in paths for each in mutants(path)]
    found = [each for each in found if chosen.change in str(each)]
    if chosen.sample:
        drawn = random.Random(chosen.seed)  # noqa: S311 - a sample, not a secret
        found = drawn.sample(found, min(chosen.sample, len(found)))
    alive = 0
    for number, mutant in enumerate(found, 1):
        if survives(mutant, options, chosen.limit):
            alive += 1
            print(f"survives: {mutant}", flush=True)
        elif sys.stderr.isatty():
            print(f"{number}/{len(found)} killed: {mutant}", file=sys.stderr)
    print(f"{len(found) - alive} of {len(found)} mutants were killed")
    return 1 if alive else 0


if __name__ == "__main__":
    sys.exit(main())
