"""Results of grasping episodes, and Markdown tables of them."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

from grasping_truth import Lift

from hilt.sim.manipulation.motion_report import MotionReport

FACING_DEG = 45.0  # within which a free part faces the receiver


@dataclass(frozen=True)
class Episode:
    """The result of one episode.

    Attributes:
        object, part: the object to grasp, and the part to grasp it by; an empty part is any.
        seed: of the scene.
        reports: of grasp, lift and hand-over, up to the first that failed.
        truth: where the object really was after the lift; None where nothing was grasped.
        is_held: whether it was held high and firmly then, by the part only.
        closed, wrong: number of closings on anything, and on something other than the part.
        bumped: the neighbours that were moved, but not put aside.
        facing_deg: angle from the free part to the receiver when handed over [deg]; None without.
        taken: whether the receiver, who pulls, had it after the hand opened.
        touches: links other than the fingers that touched something, and the type of that.
        cpu_s: processor time [s], up to the handover.
        shares: kind of work -> processor time [s].
        steps: number of simulator steps.
        bare_s: processor time of as many bare steps [s]; None if not measured.
    """

    object: str
    part: str
    seed: int
    reports: tuple[MotionReport, ...]
    truth: Lift | None
    is_held: bool
    closed: int
    wrong: int
    bumped: tuple[str, ...]
    facing_deg: float | None
    taken: bool
    touches: tuple[tuple[str, str], ...]
    cpu_s: float
    shares: Mapping[str, float]
    steps: int
    bare_s: float | None

    @property
    def last(self) -> MotionReport:
        """The report of the last motion."""
        return self.reports[-1]

    @property
    def lift(self) -> MotionReport | None:
        """The report of the lift, if the hand ever held the part."""
        return self.reports[1] if len(self.reports) > 1 else None

    @property
    def ok(self) -> bool:
        """Whether the object was lifted and held by the part, and the robot knows it."""
        return self.is_held and self.is_judged_right

    @property
    def is_judged_right(self) -> bool:
        """Whether the robot judged the lift as it was."""
        return self.is_held == (self.lift is not None and self.lift.ok)

    @property
    def first(self) -> bool:
        """Whether it was lifted and held after a single closing."""
        return self.ok and self.closed == 1

    @property
    def given(self) -> bool:
        """Whether the object was handed over."""
        return self.last.action == "hand_over" and self.last.ok

    @property
    def put_aside(self) -> tuple[str, ...]:
        """The kinds of neighbours that were put aside for it, in order."""
        return tuple(kind for report in self.reports for kind in report.moved)

    @property
    def hit(self) -> bool:
        """Whether a link other than the fingers touched what was not to be grasped."""
        return any(kind != self.object for _, kind in self.touches)

    @property
    def touched_palm(self) -> bool:
        """Whether a link other than the fingers touched what was to be grasped."""
        return any(kind == self.object for _, kind in self.touches)

    @property
    def trouble(self) -> str:
        """All failures, recovered ones included; empty when there were none."""
        what = [*self.last.failures]
        if not self.is_judged_right:
            what.append("judged wrongly")
        if not self.last.ok:
            what.append(f"{self.last.action}: {self.last.reason}")
        if self.put_aside:
            what.append(f"put aside {', '.join(self.put_aside)}")
        if self.bumped:
            what.append(f"bumped {', '.join(self.bumped)}")
        what += [f"{link} touched {kind}" for link, kind in self.touches]
        return "; ".join(what)

    def __str__(self) -> str:
        really = self.truth.slip_m if self.truth else 0.0
        facing = "none" if self.facing_deg is None else f"{self.facing_deg:.0f} degrees"
        return (
            f"{self.object}/{self.part} seed {self.seed}: {self.trouble or 'ok'}; "
            f"touched {'+'.join(self.last.touched) or 'nothing'}, score {self.last.score:.2f}, "
            f"slip {self.last.slip_m * 1e3:.1f} mm, really {really * 1e3:.1f} mm, "
            f"facing {facing}, {self.cpu_s:.2f} s"
        )


def pair_table(episodes: Sequence[Episode]) -> str:
    """Return a table with a row for each object and part, and their failures."""
    rows = [
        "| object/part | poses | right part | first | held | given | facing | CPU | troubles |",
        "|---" * 9 + "|",
    ]
    for pair in dict.fromkeys((e.object, e.part) for e in episodes):
        group = [e for e in episodes if (e.object, e.part) == pair]
        troubles = Counter(e.trouble for e in group if e.trouble)
        told = "; ".join(f"{count} x {what}" for what, count in troubles.items())
        closed, wrong = sum(e.closed for e in group), sum(e.wrong for e in group)
        rows.append(
            f"| {'/'.join(filter(None, pair))} | {len(group)} | {closed - wrong}/{closed} "
            f"| {sum(e.first for e in group)} | {sum(e.ok for e in group)} "
            f"| {sum(e.given for e in group)} | {'/'.join(map(str, _facing(group)))} "
            f"| {_mean(e.cpu_s for e in group):.2f} s | {told} |"
        )
    return "\n".join(rows)


def summary_table(measured: Mapping[str, Sequence[Episode]]) -> str:
    """Return a table with a row for each setting."""
    rows = [
        "| setting | episodes | right part | first | held | judged | given | facing | taken "
        "| slip p95 | tries | put aside | bumped | hits | palm | CPU |",
        "|---" * 16 + "|",
    ]
    for title, group in measured.items():
        n, closed = len(group), sum(e.closed for e in group)
        counts = (
            (closed - sum(e.wrong for e in group), closed),
            (sum(e.first for e in group), n),
            (sum(e.ok for e in group), n),
            (sum(e.is_judged_right for e in group), n),
            (sum(e.given for e in group), n),
            _facing(group),
            (sum(e.taken for e in group), sum(e.given for e in group)),
        )
        bumped = sum(bool(e.bumped) for e in group)
        hits, palm = sum(e.hit for e in group), sum(e.touched_palm for e in group)
        put_aside = _mean(len(e.put_aside) for e in group)
        cpu_s = _mean(e.cpu_s for e in group)
        rows.append(
            f"| {title} | {n} | {' | '.join(_share(*count) for count in counts)} "
            f"| {_slip_mm(group):.1f} mm | {_mean(e.last.attempts for e in group):.2f} "
            f"| {put_aside:.2f} | {_share(bumped, n)} | {_share(hits, n)} | {_share(palm, n)} "
            f"| {cpu_s:.2f} s |"
        )
    return "\n".join(rows)


def time_table(measured: Mapping[str, Sequence[Episode]]) -> str:
    """Return a table of processor time, with a column for each kind of work."""
    kinds = list(next(iter(measured.values()))[0].shares)
    head = ["setting", *kinds, "all", "steps", "as many bare steps"]
    rows = [f"| {' | '.join(head)} |", "|---" * len(head) + "|"]
    for title, episodes in measured.items():
        bare = [e.bare_s for e in episodes if e.bare_s is not None]
        numbers = [_mean(e.shares[kind] for e in episodes) for kind in kinds]
        numbers.append(_mean(e.cpu_s for e in episodes))
        told = " | ".join(f"{number:.2f} s" for number in numbers)
        steps = _mean(e.steps for e in episodes)
        rows.append(f"| {title} | {told} | {steps:.0f} | {_mean(bare):.2f} s |")
    return "\n".join(rows)


def contrast_table(episodes: Sequence[Episode]) -> str:
    """Return a table of the parts that the hand chooses when no part is given."""
    rows = ["| object | best grasp lands on |", "|---|---|"]
    for name in dict.fromkeys(e.object for e in episodes):
        group = [e for e in episodes if e.object == name and e.lift is not None]
        parts = Counter("+".join(e.reports[0].touched) for e in group)
        told = ", ".join(f"{part} {_share(n, len(group))}" for part, n in parts.most_common())
        rows.append(f"| {name} | {told} |")
    return "\n".join(rows)


def _facing(episodes: Sequence[Episode]) -> tuple[int, int]:
    """Return how many free parts face the receiver, and how many have a direction."""
    angles = [e.facing_deg for e in episodes if e.facing_deg is not None]
    return sum(angle <= FACING_DEG for angle in angles), len(angles)


def _slip_mm(episodes: Sequence[Episode]) -> float:
    """Return the 95th percentile of the slip of lift and hold [mm]."""
    slips = sorted(e.truth.slip_m for e in episodes if e.truth is not None and e.is_held)
    return slips[round(0.95 * (len(slips) - 1))] * 1e3 if slips else 0.0


def _share(count: int, of: int) -> str:
    return f"{count}/{of} = {100 * count / of:.1f} %" if of else "none"


def _mean(values: Iterable[float]) -> float:
    found = list(values)
    return sum(found) / max(1, len(found))
