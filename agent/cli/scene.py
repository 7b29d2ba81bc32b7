"""Commands about scenes: scene show."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from ...sim.installation import check_simulator
from ..config import AgentConfig
from .common import print_json, spinner, terminal
from .options import SCENE, AsJson, app, example, with_config

if TYPE_CHECKING:
    from ...sim.body import Body

scene_app = typer.Typer(help="Show scenes.", rich_markup_mode=None)
app.add_typer(scene_app, name="scene")


@scene_app.command(epilog=example("scene show --scene random:7 --out table.png"))
@with_config(*SCENE, "robot")
def show(
    *,
    config: AgentConfig,
    out: Annotated[Path, typer.Option(help="The picture, .png or .jpg.")] = Path("out/scene.png"),
    names: Annotated[
        bool, typer.Option("--names", help="Write the names of the objects into the picture.")
    ] = False,
    as_json: AsJson = False,
) -> None:
    """Render a picture of a scene with the robot, and list its objects with their positions."""
    check_simulator()
    from ...sim.media.pictures import check_writable
    from ..execution.embodiment import Embodiment

    check_writable(out)
    embodiment = Embodiment.from_config(config)
    with spinner("Loading the scene"), embodiment.open_body() as body:
        _picture(body, out, names=names)
        things = _things(body)
    if as_json:
        print_json({"picture": str(out), "things": things})
        return
    for thing in things:
        place = ", ".join(f"{round(x, 2) + 0.0:.2f}" for x in thing["at"])
        within = f"   in {thing['within']}" if thing["within"] else ""
        terminal().print(f"{thing['name']:<14} {place} m{within}")
    terminal().print(f"Picture written to {out}.")


def _picture(body: Body, path: Path, *, names: bool) -> None:
    from ...sim.media.pictures import OVERVIEW, draw_names, save_picture, take_picture

    picture = take_picture(body.world.engine)
    if names:
        places = {name: body.world.top(name) for name in body.world.kinds}
        picture = draw_names(picture, OVERVIEW, places)
    save_picture(picture, path)


def _things(body: Body) -> list[dict[str, Any]]:
    world = body.world
    return [
        {
            "name": name,
            "object": kind.name,
            "at": [round(float(x), 3) + 0.0 for x in world.pose(name)[:3, 3]],
            "within": world.supports.get(name),
        }
        for name, kind in world.kinds.items()
    ]
