"""A Gymnasium environment: the instruction is a sentence, the reward the proper part handed over.

An episode has some things on a table and an instruction ("pass me something used for cutting").
Its one action chooses a thing and the part to hold it by; Hilt's simulated robot grasps it so,
lifts it and hands it over. What is proper, Hilt itself concludes from sentences that it was told;
whoever learns from rewards gets to know neither these nor the conclusion.
Needs the packages of the extra `bench`. Run: python examples/gym_environment.py
"""

import string
from typing import Any, ClassVar

import gymnasium
import numpy as np
from gymnasium import spaces

from hilt.agent import Agent, AgentConfig
from hilt.ontology import load_objects
from hilt.sim import Body, parse_scene

THINGS = {  # what each is used for, and the part to hold it by when it is passed
    "glass": ("drinking", "stem"),
    "hammer": ("pounding", "head"),
    "knife": ("cutting", "blade"),
    "spoon": ("stirring", "bowl"),
}
ON_TABLE = 3  # of them, in an episode
LONGEST = 60  # letters of an instruction


class HandOver(gymnasium.Env[dict[str, Any], np.int64]):
    """Hand over what a sentence asks for, by the part by which it should be given.

    Observations have the `instruction`, and which of `THINGS` are `on_table`. Actions are indices
    of `choices`. An episode is one step; its reward is 1.0 where the proper thing is handed over by
    the proper part and no other, and 0.0 otherwise.

    Attributes:
        choices: pairs of a thing and a part.
        proper: the index of the one that is rewarded.
    """

    metadata: ClassVar[dict[str, Any]] = {"render_modes": []}

    def __init__(self) -> None:
        self.objects = load_objects()
        self.choices = [(thing, part) for thing in THINGS for part in self.objects[thing].parts]
        self.proper = 0
        self.action_space = spaces.Discrete(len(self.choices))
        letters = spaces.Text(LONGEST, charset=string.ascii_lowercase + " ")
        on_table = spaces.MultiBinary(len(THINGS))
        self.observation_space = spaces.Dict(instruction=letters, on_table=on_table)
        self._judge = Agent.open("memory:", AgentConfig(simulate=False))
        for thing, (use, part) in THINGS.items():
            self._judge.hear(f"A {thing} is used for {use}")
            self._judge.hear(f"To pass a {thing} grab it by the {part}")

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[dict[str, Any], dict[str, Any]]:
        """Lay the table anew; the instruction names a thing on it, or its use."""
        super().reset(seed=seed, options=options)
        names = self.np_random.choice([*THINGS], ON_TABLE, replace=False)
        asked = [f"the {names[0]}", f"something used for {THINGS[names[0]][0]}"]
        instruction = f"pass me {self.np_random.choice(asked)}"
        seed_of_scene = int(self.np_random.integers(2**31))
        spec = f"objects:{','.join(sorted(names))}"
        self._scene = parse_scene(spec, seed=seed_of_scene, objects=self.objects)
        with self._judge.in_scene(self._scene) as judge:
            reply = judge.hear(instruction, only="do", keep=False)
        if reply.chosen is None or reply.decision is None:
            raise ValueError(f'"{instruction}": {reply.said}')
        self.proper = self.choices.index((reply.chosen.object, reply.decision.chosen_part))
        self._instruction = instruction
        return self._observation(), {}

    def _observation(self) -> dict[str, Any]:
        on_table = np.array([name in self._scene.types for name in THINGS], dtype=np.int8)
        return {"instruction": self._instruction, "on_table": on_table}

    def step(self, action: np.int64) -> tuple[dict[str, Any], float, bool, bool, dict[str, Any]]:
        """Hand a thing over by a part; the information says how that ended."""
        thing, part = self.choices[action]
        ended = "not_seen" if thing not in self._scene.types else self._hand_over(thing, part)
        reward = float(ended == "handed_over" and action == self.proper)
        return self._observation(), reward, True, False, {"ended": ended}

    def _hand_over(self, thing: str, part: str) -> str:
        with Body(self._scene, self.objects, seed=self._scene.seed) as body:
            seen = body.search([f"object:{thing}"])
            if not seen:
                return "not_seen"
            for move in (lambda: body.grasp(seen[0], part), body.lift, body.hand_over):
                report = move()
                if not report.ok or set(report.touched) != {part}:
                    return report.reason or "wrong_part"
        return "handed_over"

    def close(self) -> None:
        """Forget what the judge was told."""
        self._judge.close()


def main() -> None:
    """One episode by chance, and one by what the judge concludes."""
    environment = HandOver()
    for name in ("chance", "the judge"):
        seen, _ = environment.reset(seed=7)
        environment.action_space.seed(7)
        action = environment.action_space.sample() if name == "chance" else environment.proper
        _, reward, _, _, info = environment.step(np.int64(action))
        thing, part = environment.choices[action]
        print(
            f'"{seen["instruction"]}", {name}: the {thing} by the {part}, {info["ended"]}: {reward}'
        )
    environment.close()


if __name__ == "__main__":
    main()
