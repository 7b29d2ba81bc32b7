"""Agreements on the part to grasp by, where experience speaks against what was told.

Hilt asks, and follows the answer from then on in the conversation, until what happens afterwards
contradicts it, too. What was told, and the trust in who told it, are not changed by an answer.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace

from ...inference.affordance import Affordances
from ...inference.experience import OutcomeCounts, contradiction
from ...kb.interval import CERTAIN
from ..execution.doubt import Doubt
from ..execution.request import Request
from .reply import OpenQuestion, Reply


@dataclass(frozen=True)
class _Agreement:
    """The part that was agreed on, the action it is grasped for, and the outcomes till then."""

    part: str
    context: str
    counts: OutcomeCounts


class PartAgreements:
    """The agreements of one conversation; `affordances` returns the inference of the robot."""

    def __init__(self, affordances: Callable[[], Affordances]) -> None:
        self._affordances = affordances
        self._agreed: dict[tuple[str, str], _Agreement] = {}  # by goal and kind of object

    def applied_to(self, request: Request) -> Request:
        """Return a request with the parts that were agreed on for its goal and that still stand."""
        standing = {
            kind: agreed.part
            for (goal, kind), agreed in self._agreed.items()
            if goal == request.action and self._stands(kind, agreed)
        }
        return replace(request, agreed=standing)

    def question(
        self, doubt: Doubt, request: Request, asked: str, carry_out: Callable[[], Reply]
    ) -> OpenQuestion:
        """Return the question about a doubt; an answer lets the request be carried out again."""

        def take(part: str) -> Reply:
            agreed = _Agreement(
                part, doubt.context, self._affordances().outcomes(doubt.object, part, doubt.context)
            )
            self._agreed[request.action, doubt.object] = agreed
            return carry_out()

        return OpenQuestion(
            asked,
            yes=lambda: take(doubt.instead or doubt.part),
            no=(lambda: take(doubt.part)) if doubt.instead else None,
            choose=lambda named: take(named.name) if named.name else None,
        )

    def _stands(self, kind: str, agreed: _Agreement) -> bool:
        since = self._affordances().outcomes(kind, agreed.part, agreed.context).since(agreed.counts)
        bound = self._affordances().settings.contradiction
        return contradiction(CERTAIN, since.interval) <= bound
