# SPDX-License-Identifier: Apache-2.0
"""The state of a world in one short word, to tell whether two runs came to the same bit for bit."""

from __future__ import annotations

from hashlib import sha256

import numpy as np

from .body import Body

LENGTH = 16  # letters; by chance two of them are alike once in 2^64


def fingerprint(body: Body) -> str:
    """A hash of where everything is: all poses, the joints of the robot, and how much time passed.

    Two runs with the same fingerprint do not differ in the last bit of any of these numbers.
    """
    numbers = [body.world.pose(name) for name in body.world.kinds]
    numbers += [body.robot.joints, np.array(body.world.engine.steps)]
    return sha256(b"".join(each.tobytes() for each in numbers)).hexdigest()[:LENGTH]
