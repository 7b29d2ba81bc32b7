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
NUMBERS = {"teaching": 50, "situations": 3, "growth": 8}  # of learning scenarios and orders


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


def node(cells, i):
    """The cells whose rules are at the same node: of an affordance, or of an action."""
    _, argument, context = cells[i]
    same = [j for j, cell in enumerate(cells) if cell[2] == context]
    return same if context else [j for j in same if cells[j][1] == argument]


def chosen(found, cells, codes, asked):
    """The objects and parts to choose, and the cells to read and to meet, one bit each."""
    mask, action, f = asked
    every = node(cells, f)
    asked = [cell for i, cell in enumerate(every) if mask >> i & 1]
    tops = best([codes[cell] for cell in asked])
    if not tops:  # then rules about absent objects are read, to say what would do
        asked = every
    tied = [cells[cell][0] for i, cell in enumerate(asked) if tops >> i & 1]
    grasps = [i for i, (o, _, c) in enumerate(cells) if [o] == tied[:1] and c == action]
    met = {*every, *(node(cells, grasps[0]) if grasps else ())}
    sets = [sum(1 << i for i in each if codes[i]) for each in ({*asked, *grasps}, met)]
    objects = sum(1 << found["objects"].index(o) for o in tied)
    return [objects, best([codes[i] for i in grasps]), *sets]


def digest(lines):
    """A digest of lines of numbers."""
    return sha256("".join(f"{' '.join(map(str, line))}\n" for line in lines).encode()).hexdigest()


def situations(found, cells, codes, action):
    """What to choose in every scene for every affordance of a learning scenario."""
    asked = product(range(2 ** len(found["objects"])), range(len(found["affordances"])))
    lines = [[m, f, *chosen(found, cells, codes, (m, action, f))] for m, f in asked]
    kinds = [min(line[2].bit_count(), 2) for line in lines]
    return {"codes": codes} | tally(kinds, b"") | {"digest": digest(lines)}


def taught(found, cells, seed, number):
    """What to hold and to choose when a random set of rules was taught, or all of them."""
    rng = Random(f"{seed}/{number}")  # noqa: S311 - scenarios, not secrets
    share = (4 * len(cells)) ** (rng.random() - 1)
    codes = drawn(cells, rng, share if number else 1.0)
    sizes = (2 ** len(found["objects"]), len(ACTIONS), len(found["affordances"]))
    asked = [[int(size * rng.random()) for size in sizes] for _ in range(5)]
    choices = [
        [m, a, f, *chosen(found, cells, codes, (m, [*ACTIONS][a], f))[:2]] for m, a, f in asked
    ]
    told = 2 * sum(code.bit_count() for code in codes)  # each sentence twice
    return {"codes": codes, "held": codes, "told": told, "choices": choices}


def drawn(cells, rng, share):
    """The codes of a random set of rules."""
    return [sum(bit for bit in (1, 2, 4, 8) if rng.random() < share) for _ in cells]


def grown(cells, seed, number):
    """The scores of the cells of a node after each rule, when all are taught in a random order."""
    rng = Random(f"{seed}/{number}")  # noqa: S311 - orders, not secrets
    order = sorted(range(4 * len(cells)), key=lambda _: rng.random())
    codes, scores, lines = [0] * len(cells), [score(code) for code in range(16)], []
    for index in order:
        codes[index // 4] |= 8 >> index % 4
        lines += [scores[codes[i]] for i in node(cells, index // 4)]
    return {"order": order, "digest": digest(lines)}


def expected(found, weak=choices):
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

    def row(shift, i):
        codes = [(shift + j) % 16 for j in range(len(cells))]
        near = node(cells, i)
        met = sum(1 << j for j in near if codes[j])
        if cells[i][2]:  # the parts of the object
            near = [j for j in near if cells[j][0] == cells[i][0]]
        read = sum(1 << j for j in near if codes[j] and (cells[i][2] or j == i or not codes[i]))
        return [*score(codes[i]), 1 << i if codes[i] else 0, read, met]

    def half(number):
        return drawn(cells, Random(f"{seed}/{number}"), 0.5 if number else 1.0)  # noqa: S311

    return names | {
        "format": 2,
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
        "choices": [weak(n, k, m) for k in range(n + 1) for m in range(min(k, 1), k + 1)],
        "grasps": [[[best([a, b])] * (2 * n) for b in range(16)] for a in range(16)],
        "teaching": [taught(found, cells, seed, i) for i in range(NUMBERS["teaching"])],
        "situations": [
            situations(found, cells, half(i), action)
            for i in range(NUMBERS["situations"])
            for action in ACTIONS
        ],
        "growth": [grown(cells, seed, i) for i in range(NUMBERS["growth"])],
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
