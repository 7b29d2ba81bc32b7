# SPDX-License-Identifier: Apache-2.0
"""Check a certificate of `hilt evaluate all-scenarios` by the definition, without Hilt.

Everything in the file is worked out again from its names and its seed, and compared number by
number: `python check_certificate.py certificate.json`. It takes less than a minute.
"""

import json
import sys
from decimal import Decimal
from hashlib import sha256
from itertools import product
from math import log2
from random import Random

LEFT_OPEN = (50, 250, 500, 750)  # thousandths that a level leaves open, the highest level first
ACTIONS = {"pass": "pass me", "pickUp": "pick up", "pointTo": "point to"}
GRASPING = {"pass": "pass", "pickUp": "pick up"}


def score(code):
    """Lower, upper, lambda and accepted of a cell that was taught the levels of a code."""
    left = 10**12
    for bit, thousandths in zip((8, 4, 2, 1), LEFT_OPEN, strict=True):
        left = left * thousandths // 1000 if code & bit else left
    share = 1 / (1 + left / 10**12)
    sure = 1 + share * log2(share) + (1 - share) * log2(1 - share) if code else 0.0
    return [float(Decimal(10**12 - left) / 10**12), 1.0, round(sure, 9), int(sure > 0.005)]


def best(codes):
    """The positions of the highest code that is not 0, one bit each."""
    return sum(1 << i for i, code in enumerate(codes) if code and code == max(codes))


def tally(kinds, digested):
    """How many choices of nothing, one thing and several, and a digest of them all."""
    counts = {name: kinds.count(i) for i, name in enumerate(("none", "unique", "ties"))}
    return counts | {"digest": sha256(digested).hexdigest()}


def choices(objects, ranked, levels):
    """What to choose for each weak order of a shape; 2 in `standing` is a ranked object."""
    orders = [o for o in product(range(levels), repeat=ranked) if len(set(o)) == levels]
    masks = bytearray()
    for standing in product(range(3), repeat=objects):
        bits = [1 << i for i, how in enumerate(standing) if how == 2]
        for order in orders if len(bits) == ranked else ():
            masks.append(sum(b for b, o in zip(bits, order, strict=True) if o == levels - 1))
    kinds = [min(mask.bit_count(), 2) for mask in masks]
    return {"ranked": ranked, "levels": levels} | tally(kinds, masks)


def situations(objects, affordances, cells, codes, action):
    """What to choose, and to read, in every scene for every affordance of a learning scenario."""
    lines, kinds = [], []
    for scene, f in product(range(2 ** len(objects)), range(len(affordances))):
        asked = [i * len(affordances) + f for i in range(len(objects)) if scene >> i & 1]
        tops = best([codes[cell] for cell in asked])
        if not tops:  # then rules about absent objects are read, to say what would do
            asked = range(f, len(objects) * len(affordances), len(affordances))
        tied = [cells[cell][0] for i, cell in enumerate(asked) if tops >> i & 1]
        grasps = [i for i, (o, _, c) in enumerate(cells) if [o] == tied[:1] and c == action]
        parts, read = best([codes[i] for i in grasps]), {i for i in [*asked, *grasps] if codes[i]}
        mask = sum(1 << objects.index(o) for o in tied)
        lines.append(f"{scene} {f} {mask} {parts} {sum(1 << i for i in read)}\n")
        kinds.append(min(len(tied), 2))
    return {"codes": codes} | tally(kinds, "".join(lines).encode())


def expected(found, chosen=choices):
    """The certificate as it has to be, for the names and the seed of the one that was found."""
    names = {key: found[key] for key in ("objects", "affordances", "parts", "levels")}
    objects, affordances, n = found["objects"], found["affordances"], len(found["objects"])
    seed = int(found["seed"])
    cells = [(o, f, "") for o in objects for f in affordances]
    cells += [(o, p, c) for o in objects for c in GRASPING for p in found["parts"][o]]

    def sentence(o, argument, c, level):
        if c:
            return f"To {GRASPING[c]} a {o} {level} grab the {o} by the {argument}"
        return f"{'an' if o[0] in 'aeiou' else 'a'} {o} is {level} used for {argument}"

    def drawn(number):
        rng = Random(seed + number)  # noqa: S311 - scenarios, not secrets
        return [rng.randrange(16) if seed + number else 15 for _ in cells]

    def row(shift, i):
        c = cells[i][2]
        codes = [(shift + j) % 16 for j in range(len(cells))]
        same = (2, 0) if c else (2, 1)  # of the object and context; without any, of the affordance
        near = [j for j in range(len(cells)) if all(cells[j][k] == cells[i][k] for k in same)]
        near = near if c or not codes[i] else [i]
        read = sum(1 << j for j in near if codes[j])
        return [*score(codes[i]), 1 << i if codes[i] else 0, read]

    def taught(number):
        rules = sum(bin(code).count("1") for code in drawn(number))
        held = [drawn(number)] * 3  # told in order, shuffled, and everything twice
        return {"codes": drawn(number), "held": held, "told": [rules, rules, 2 * rules]}

    return names | {
        "format": 1,
        "contexts": list(GRASPING),
        "actions": list(ACTIONS),
        "seed": seed,
        "threshold": 0.005,
        "tolerance": 1e-9,
        "sentences": [
            [sentence(*cell, level), i, (1000 - left) / 1000, 1.0]
            for i, cell in enumerate(cells)
            for level, left in zip(found["levels"], LEFT_OPEN, strict=True)
        ],
        "commands": [
            [f"{words} something used for {f}", i, j]
            for i, words in enumerate(ACTIONS.values())
            for j, f in enumerate(affordances)
        ],
        "scenes": list(range(2**n)),
        "scores": [[row(shift, i) for i in range(len(cells))] for shift in range(16)],
        "choices": [chosen(n, k, m) for k in range(n + 1) for m in range(min(k, 1), k + 1)],
        "grasps": [[[best([a, b])] * (2 * n) for b in range(16)] for a in range(16)],
        "teaching": [taught(i) for i in range(max(2, len(found["teaching"])))],
        "situations": [
            situations(objects, affordances, cells, drawn(i), action)
            for i in range(max(2, len(found["situations"]) // 3))
            for action in ACTIONS
        ],
    }


def differences(found, wanted, where="certificate"):
    """Where two documents differ; numbers must be equal to the last digit."""
    wanted = Decimal(str(wanted)) if isinstance(wanted, float) else wanted
    if type(found) is not type(wanted) or not isinstance(found, dict | list):
        if type(found) is not type(wanted) or found != wanted:
            yield f"{where}: {found!r}, not {wanted!r}"
    elif len(found) != len(wanted) or (isinstance(found, dict) and found.keys() != wanted.keys()):
        yield f"{where}: other keys, or another number of them"
    else:
        for key in found if isinstance(found, dict) else range(len(found)):
            yield from differences(found[key], wanted[key], f"{where}[{key}]")


def main(path):
    """Say whether a certificate is right and what follows, or where it first differs."""
    with open(path, encoding="utf-8") as file:
        found = json.load(file, parse_float=Decimal)
    wrong = next(differences(found, expected(found)), None)
    rules, scenes, commands = (len(found[key]) for key in ("sentences", "scenes", "commands"))
    claim = f"right for all {scenes * commands} * 2^{rules} situations and learning scenarios"
    print(f"{path}: {wrong or claim}.")
    return wrong is not None


if __name__ == "__main__":
    sys.exit(main(sys.argv[1]))
