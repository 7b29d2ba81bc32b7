"""Whether the packages of the simulator, which are an extra of Hilt, are installed."""

from importlib.util import find_spec

from ..ontology.errors import MissingExtraError

PACKAGES = {  # module -> the package of the extra "sim" that has it
    "pybullet": "pybullet",
    "pybullet_data": "pybullet",
    "PIL": "pillow",
    "imageio": "imageio",
    "scipy": "scipy",
    "shapely": "shapely",
    "trimesh": "trimesh",
    "coacd": "coacd",
}


def check_simulator() -> None:
    """Check that the packages of the simulator are installed; none of them is imported.

    MissingExtraError if one of them is not.
    """
    for module, package in PACKAGES.items():
        if find_spec(module) is None:
            raise MissingExtraError("sim", package, ", or decide without a robot: --no-sim")
