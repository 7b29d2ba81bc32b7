"""Commands about scenes, clouds and objects: scene show, grasp, object import."""

from pathlib import Path
from typing import Annotated, Any, Literal

import typer

from ...ontology.errors import check_simulator
from ..config import AgentConfig
from .common import announce, exit_with, print_json, spinner, terminal
from .options import SCENE, AsJson, app, example, with_config

scene_app = typer.Typer(help="Show scenes.", rich_markup_mode=None)
object_app = typer.Typer(help="Make objects of files.", rich_markup_mode=None)
app.add_typer(scene_app, name="scene")
app.add_typer(object_app, name="object")
_PART = "What a link, or named geom, is in the object; may be repeated."


@scene_app.command(epilog=example("scene show --scene random:7 --out table.png"))
@with_config(*SCENE, "robot")
def show(
    *,
    config: AgentConfig,
    out: Annotated[Path, typer.Option(help="The picture, .png or .jpg.")] = Path("out/scene.png"),
    names: Annotated[bool, typer.Option("--names", help="Write names into the picture.")] = False,
    as_json: AsJson = False,
) -> None:
    """Render a picture of a scene with the robot, and list its objects with their positions."""
    check_simulator()
    from ...sim.media import pictures
    from ..documents import things_as_json
    from ..execution.embodiment import Embodiment

    pictures.check_writable(out)
    with spinner("Loading the scene"), Embodiment.from_config(config).open_body() as body:
        picture = pictures.take_picture(body.world.engine)
        if names:
            places = {name: body.world.top(name) for name in body.world.kinds}
            picture = pictures.draw_names(picture, pictures.OVERVIEW, places)
        pictures.save_picture(picture, out)
        things = things_as_json(body)
    if as_json:
        print_json({"picture": str(out), "things": things})
        return
    for thing in things:
        place = ", ".join(f"{round(x, 2) + 0.0:.2f}" for x in thing["at"])
        within = f"   in {thing['within']}" if thing["within"] else ""
        terminal().print(f"{thing['name']:<14} {place} m{within}")
    terminal().print(f"Picture written to {out}.")


@object_app.command(name="import", epilog=example("object import brush.urdf --out mine.yaml"))
def import_(
    file: Annotated[Path, typer.Argument(help="A URDF or MJCF file.")],
    *,
    out: Annotated[Path, typer.Option(help="The file of objects to write, .yaml.")],
    part: Annotated[list[str] | None, typer.Option(metavar="PART=LINK", help=_PART)] = None,
    role: Annotated[list[str] | None, typer.Option(metavar="PART=ROLE", help="Its role.")] = None,
    name: Annotated[str, typer.Option(help="What it is called; by default as the file.")] = "",
    is_a: Annotated[str, typer.Option(help="The kind of object.")] = "artifact",
    picture: Annotated[Path, typer.Option(help="A picture of it.")] = Path("out/object.png"),
    as_json: AsJson = False,
) -> None:
    """Make an object of a file: each link, or named geom, is a part. `--objects` reads it."""
    check_simulator()
    from ...sim.media.pictures import closeup, save_picture, take_picture
    from ...sim.models.object_import import import_object
    from ..execution.embodiment import Embodiment

    name = name or file.stem.lower()
    links = {link: label for label, _, link in (each.partition("=") for each in part or ())}
    roles = {label: given for label, _, given in (each.partition("=") for each in role or ())}
    import_object(file, out, links, roles, name=name, is_a=is_a)
    config = AgentConfig(objects=out, scene=f"objects:{name}")
    with spinner("Loading the object"), Embodiment.from_config(config).open_body() as body:
        camera = closeup(body.world.points(name).mean(axis=0))
        save_picture(take_picture(body.world.engine, camera), picture)
        parts = {each.name: each.mass for each in body.world.kinds[name].parts.values()}
    document = {"object": name, "parts": parts, "file": str(out), "picture": str(picture)}
    announce(document, f"{name}: {', '.join(parts)}. See {out} and {picture}.", as_json=as_json)


@app.command(epilog=example("grasp --cloud mug.npz --part handle --table 0"))
@with_config("robot", "seed")
def grasp(
    *,
    config: AgentConfig,
    cloud: Annotated[Path, typer.Option(help="The points: an .npz or .ply file.")],
    part: Annotated[str | None, typer.Option(help="The label to grasp by; by default any.")] = None,
    other: Annotated[list[str] | None, typer.Option(help="A label of other things.")] = None,
    table: Annotated[float | None, typer.Option(metavar="Z", help="Height of the table.")] = None,
    base_from_camera: Annotated[Path | None, typer.Option(help="A file of 4 x 4 numbers.")] = None,
    frame: Annotated[Literal["base", "camera"], typer.Option(help="Frame of the grasps.")] = "base",
    top: Annotated[int, typer.Option(min=1, help="How many grasps, best first.")] = 10,
    as_json: AsJson = False,
) -> None:
    """Rank grasps of an object in a point cloud: where the hand closes, and how wide it opens."""
    check_simulator()
    from ...sim.grasping.cloud_grasps import grasps_on_cloud, read_cloud
    from ...sim.poses import inverse, translation

    given: dict[str, Any] = {**read_cloud(cloud, base_from_camera), "others": other or ()}
    with spinner("Planning grasps"):
        plan = grasps_on_cloud(
            **given, part=part, table=table, robot=config.robot, seed=config.seed
        )
    at = given.get("base_from_camera")
    turn = translation(0, 0, 0) if at is None or frame == "base" else inverse(at)
    placed = [((turn @ g.world_from_grip).round(6) + 0.0).tolist() for g in plan.grasps[:top]]
    numbers = [[round(x, 6) for x in (g.width, g.opening, g.score)] for g in plan.grasps[:top]]
    grasps = [
        {"part": part, "pose": pose, "width_m": width, "opening_m": opening, "score": score}
        for pose, (width, opening, score) in zip(placed, numbers, strict=True)
    ]
    reach = {"frame": "points" if at is None else frame, "reach_checked": at is not None}
    if as_json:
        print_json({**reach, "grasps": grasps, "rejected": dict(plan.rejected)})
    else:
        for pose, (width, _, score) in zip(placed, numbers, strict=True):
            at, ahead = (" ".join(f"{row[axis]:6.3f}" for row in pose[:3]) for axis in (3, 2))
            number = f"[bold green]{score:.2f}[/]  {1000 * width:3.0f} mm wide"
            terminal().print(f"{number}  at {at} m  ahead {ahead}")
        limits = "within reach" if reach["reach_checked"] else "z is up, and reach is not checked"
        rejected = ", ".join(f"{count} {reason}" for reason, count in plan.rejected.items())
        text = f"Frame: {reach['frame']}; {limits}. Rejected: {rejected or 'none'}."
        terminal().print(f"[dim]{text}[/]")
    exit_with(bool(plan.grasps))
