"""Mutation testing of the inference and of the execution of action trees.

    python benchmarks/mutation.py                       every mutant
    python benchmarks/mutation.py --sample 40 --seed 1  some of them
    python benchmarks/mutation.py --only decision.py    those of files with this in their path
    python benchmarks/mutation.py --evaluate paper      which ones `hilt evaluate paper` notices

A mutant is the program with one operator or constant replaced. It is killed if a test fails, or if
the tests take longer than the limit; those that survive are printed: each is a behaviour that no
test states, or a change without effect. No file is changed.

The tests are collected once. A mutant of a function replaces its code in a fork of that process and
meets the tests that reach its line, fastest first. Any other mutant meets all tests in a process of
its own, where it is compiled when its module is imported.
"""

from __future__ import annotations

import argparse
import ast
import gc
import json
import multiprocessing
import os
import random
import subprocess
import sys
import time
from collections.abc import Callable, Collection, Generator, Iterable, Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager, redirect_stdout
from dataclasses import dataclass
from functools import partial
from importlib.machinery import SourceFileLoader
from pathlib import Path
from tempfile import TemporaryDirectory
from types import CodeType, FunctionType

import pytest
from coverage import Coverage
from hypothesis import Phase, settings

ROOT = Path(__file__).resolve().parents[1]
FILES = (
    *sorted(ROOT.glob("inference/[a-z]*.py")),
    *ROOT.glob("agent/execution/action_tree_executor.py"),
)
TESTS = (
    *("tests/inference", "tests/agent/execution"),
    *("tests/agent/dialogue", "tests/kb/formats/test_ontology.py"),  # go through them, too
)
TIME_LIMIT_S = 100.0
# Without cache: no file is written, and failures of one mutant do not order another's tests.
OPTIONS = [
    *("-x", "-q", "-s", "--tb=no", "--assert=plain", "-m", "not sim"),
    *("-p", "no:cacheprovider", "-p", "no:benchmark"),
]
PASSED, BROKEN, FAILED = range(3)  # exit codes of forks; a fault of this program is 1
FORK = multiprocessing.get_context("fork")

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


def replace_code(path: Path, index: int) -> None:
    """Put the code of a mutant into the functions of a file that is imported."""
    code = {_place(each): each for each in _nested(compile_mutant(path, index))}
    gc.unfreeze()  # or not all functions are found
    functions = [each for each in gc.get_objects() if isinstance(each, FunctionType)]
    for each in functions:
        old = each.__code__
        if old.co_filename.endswith(path.name) and path.samefile(old.co_filename):
            each.__code__ = code.get(_place(old), old)


def _nested(code: CodeType) -> Iterator[CodeType]:
    for each in code.co_consts:
        if isinstance(each, CodeType):
            yield each
            yield from _nested(each)


def _place(code: CodeType) -> tuple[str, int]:
    return code.co_name, code.co_firstlineno


def statement_at(path: Path, line: int) -> range | None:
    """Return the lines of the innermost statement in a function; None outside of functions."""
    tree = ast.parse(path.read_text(encoding="utf-8"))
    functions = [node for node in ast.walk(tree) if isinstance(node, ast.FunctionDef)]
    bodies = [statement for function in functions for statement in function.body]
    nodes = (node for body in bodies for node in ast.walk(body) if isinstance(node, ast.stmt))
    spans = (range(node.lineno, (node.end_lineno or 0) + 1) for node in nodes)
    return min((span for span in spans if line in span), key=len, default=None)


class Trial:
    """A plugin of pytest: what each mutant comes to with the tests that are collected.

    `survives` judges the mutants outside of functions. The result is in `alive`.
    """

    def __init__(
        self, found: Sequence[Mutant], jobs: int, limit_s: float, survives: Callable[[Mutant], bool]
    ) -> None:
        self.found, self.jobs, self.limit_s, self._survives = found, jobs, limit_s, survives
        self.alive: list[Mutant] = []

    def pytest_collection(self) -> None:
        """Let any example be enough against a mutant, so that no smaller one is looked for."""
        phases = [Phase.explicit, Phase.generate]
        settings.register_profile("mutation", settings(), phases=phases)
        settings.load_profile("mutation")

    def pytest_runtestloop(self, session: pytest.Session) -> bool:
        """Try all mutants."""
        self.session = session
        self.items = {item.nodeid: item for item in session.items}
        with TemporaryDirectory() as name, ThreadPoolExecutor(self.jobs) as pool:
            self.folder = Path(name)
            self.reached = self._measured()
            self.alive = reported(self.found, pool.map(self._is_alive, self.found))
        return True

    def _is_alive(self, mutant: Mutant) -> bool:
        statement = statement_at(mutant.path, mutant.line)
        if statement is None:
            return self._survives(mutant)
        lines = self.reached[str(mutant.path)]
        tests = {test for line in statement for test in lines.get(str(line), ())}
        task = partial(self._try, mutant, tests)
        code = self._exit_code(task, self.limit_s) if tests else PASSED
        assert code != BROKEN, f"{mutant} cannot be tried"
        return code == PASSED

    def _try(self, mutant: Mutant, tests: Collection[str]) -> int:
        replace_code(mutant.path, mutant.index)
        return self._run([test for test in self.order if test in tests])

    def _run(self, tests: Sequence[str], begin: Callable[[str], None] = str) -> int:
        items = [self.items[test] for test in tests]
        for item, following in zip(items, [*items[1:], None], strict=True):
            begin(item.nodeid)
            item.ihook.pytest_runtest_protocol(item=item, nextitem=following)
            if self.session.testsfailed:
                return FAILED
        return PASSED

    def _measured(self) -> dict[str, dict[str, list[str]]]:
        """Return the tests that run each line of each file, and find the order of the tests."""
        if self._exit_code(self._measure, None) != PASSED:
            raise pytest.UsageError("A test fails without any mutant.")
        found = json.loads((self.folder / "reach.json").read_text())
        self.order: list[str] = found["order"]
        return found["reached"]

    def _measure(self) -> int:
        coverage = Coverage(data_file=None, config_file=False, include=list(map(str, FILES)))
        begun: list[tuple[str, float]] = []

        def begin(test: str) -> None:
            begun.append((test, time.process_time()))
            coverage.switch_context(test)

        with coverage.collect():
            code = self._run([*self.items], begin)
        ended = [*(start for _, start in begun[1:]), time.process_time()]
        spent = {test: end - start for (test, start), end in zip(begun, ended, strict=True)}
        data = coverage.get_data()
        reached = {str(path): data.contexts_by_lineno(str(path)) for path in FILES}
        found = {"order": sorted(spent, key=spent.__getitem__), "reached": reached}
        (self.folder / "reach.json").write_text(json.dumps(found))
        return code

    def _exit_code(self, task: Callable[[], int], limit_s: float | None) -> int | None:
        """Run a task in a fork of this process, which is killed at the limit."""
        process = FORK.Process(target=self._exit, args=(task,))
        process.start()
        process.join(limit_s)
        if process.exitcode is None:
            process.kill()
            process.join()
        return process.exitcode

    def _exit(self, task: Callable[[], int]) -> None:
        os.environ["PYTEST_DEBUG_TEMPROOT"] = str(self.folder)
        silence = os.open(os.devnull, os.O_WRONLY)
        os.dup2(silence, 1)
        os.dup2(silence, 2)
        os._exit(task())  # without the end of the threads, which are not in a fork


def run_tests(path: Path, index: int, tests: Sequence[str]) -> int:
    """Run tests in this process with a mutant in place of its module; return the exit code."""
    with mutated(path, index):
        return int(pytest.main([*OPTIONS, *tests]))


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
    """Whether all tests pass with a mutant, in a process of its own, within the time limit [s]."""
    command = [sys.executable, __file__, "--run", f"{mutant.path}:{mutant.index}", *options]
    try:
        done = subprocess.run(  # noqa: S603 - this file, with a path of its own
            command, cwd=ROOT, timeout=limit_s, capture_output=True, check=False
        )
    except subprocess.TimeoutExpired:
        return False
    return done.returncode == 0


def reported(found: Sequence[Mutant], results: Iterable[bool]) -> list[Mutant]:
    """Return the mutants that survive, and show what is known so far."""
    alive: list[Mutant] = []
    for number, (mutant, is_alive) in enumerate(zip(found, results, strict=True), 1):
        if is_alive:
            alive.append(mutant)
        state = "survives" if is_alive else "killed"
        print(f"{number}/{len(found)} {state}: {mutant}", file=sys.stderr)
    return alive


def try_all(found: Sequence[Mutant], chosen: argparse.Namespace) -> list[Mutant]:
    """Return the mutants that survive the chosen tests or evaluation."""
    if chosen.evaluate:
        options = ["--evaluate", chosen.evaluate]
        return reported(found, (survives(each, options, chosen.limit) for each in found))
    alone = partial(survives, options=["--tests", *chosen.tests], limit_s=chosen.limit)
    trial = Trial(found, chosen.jobs, chosen.limit, alone)
    with redirect_stdout(sys.stderr):
        code = pytest.main([*OPTIONS, *chosen.tests], plugins=[trial])
    if code != pytest.ExitCode.OK:
        raise SystemExit("The tests cannot be collected, or one fails without any mutant.")
    return trial.alive


def arguments() -> argparse.Namespace:
    """Return the options of the command line."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else "")
    parser.add_argument("--only", default="", help="a part of the paths of the files to mutate")
    parser.add_argument("--change", default="", help="a part of the line that shows the mutant")
    parser.add_argument("--sample", type=int, help="how many mutants to draw")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--jobs", type=int, default=2, help="how many mutants at a time")
    parser.add_argument("--limit", type=float, default=TIME_LIMIT_S, help="seconds for a mutant")
    parser.add_argument("--tests", nargs="+", default=list(TESTS))
    parser.add_argument("--evaluate", help="an evaluation that is run instead of the tests")
    parser.add_argument("--run", help=argparse.SUPPRESS)
    return parser.parse_args()


def main() -> int:
    """Print the mutants that survive, and return 1 if there are any."""
    chosen = arguments()
    if chosen.run:
        path, _, index = chosen.run.rpartition(":")
        if chosen.evaluate:
            return run_evaluation(Path(path), int(index), chosen.evaluate)
        return run_tests(Path(path), int(index), chosen.tests)
    paths = [path for path in FILES if chosen.only in str(path.relative_to(ROOT))]
    found = [each for path in paths for each in mutants(path) if chosen.change in str(each)]
    if chosen.sample:
        drawn = random.Random(chosen.seed)  # noqa: S311 - a sample, not a secret
        found = drawn.sample(found, min(chosen.sample, len(found)))
    alive = try_all(found, chosen)
    for mutant in alive:
        print(f"survives: {mutant}")
    print(f"{len(found) - len(alive)} of {len(found)} mutants were killed")
    return 1 if alive else 0


if __name__ == "__main__":
    sys.exit(main())
