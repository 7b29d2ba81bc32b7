"""Commands of the service: serve, mcp, token add, token list, token remove."""

import re
from datetime import timedelta
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from ...ontology.errors import extra_required
from ..config import AgentConfig, default_location
from . import options
from .common import announce, open_agent, print_json
from .options import AsJson, Kb, Speaker, app, example, with_config

if TYPE_CHECKING:
    from ..web.tokens import TokenFile

token_app = typer.Typer(help="Who may use the service.", rich_markup_mode=None)
app.add_typer(token_app, name="token")
_UNITS = {"d": "days", "h": "hours", "m": "minutes"}
_NO_AUTH = "Ask for no key; on this machine only."
_BARE = "Serve a plain store, without the laws of a base."
_BEHIND_PROXY = "A proxy does TLS and passes requests on."
_ALLOW_ORIGIN = "A site whose pages may ask, with tokens."
_PACE = "How fast the robot moves while somebody looks; 0: as it can."


@app.command(epilog=example("serve --no-browser"))
@with_config(*options.EVERY)
def serve(
    *,
    config: AgentConfig,
    kb: Kb = None,
    host: Annotated[str, typer.Option(help="The address to listen at.")] = "127.0.0.1",
    port: Annotated[int, typer.Option(min=0, max=65535, help="The port; 0: a free one.")] = 8765,
    speaker: Speaker = "sam",
    browser: Annotated[bool, typer.Option(help="Open the page in a browser.")] = True,
    no_auth: Annotated[bool, typer.Option("--no-auth", help=_NO_AUTH)] = False,
    bare: Annotated[bool, typer.Option("--bare", help=_BARE)] = False,
    certificate: Annotated[Path | None, typer.Option(help="A certificate (PEM), for TLS.")] = None,
    key: Annotated[Path | None, typer.Option(help="Its private key (PEM).")] = None,
    behind_proxy: Annotated[bool, typer.Option("--behind-proxy", help=_BEHIND_PROXY)] = False,
    name: Annotated[list[str] | None, typer.Option(help="A host name of the service.")] = None,
    allow_origin: Annotated[list[str] | None, typer.Option(help=_ALLOW_ORIGIN)] = None,
    pace: Annotated[float, typer.Option(min=0, help=_PACE)] = 1.0,
    as_json: AsJson = False,
) -> None:
    """Talk, watch and query in a browser, and answer programs over HTTP, until Ctrl-C."""
    with extra_required("serve", "fastapi"):
        from ..web import server
    from ...kb.stores.base import MEMORY

    def ready(url: str, once: str | None, bound: int) -> None:
        if no_auth or bare:
            typer.echo("Without keys: every program of this machine may do everything.", err=True)
        announce({"url": url, "key": once, "port": bound}, f"Hilt is at {url}", as_json=as_json)
        if browser and not as_json:
            typer.launch(url)

    place = (host, port, tuple(name or ()), tuple(allow_origin or ()), certificate, key)
    chosen = server.ServiceSettings(*place, behind_proxy, not no_auth, speaker, pace=pace)
    tokens = server.tokens_beside(kb or str(default_location()))
    if bare:
        server.serve_bare(kb or MEMORY, chosen, ready)  # never the user's own base unasked
    else:
        server.serve(open_agent(kb, config), chosen, tokens, ready)


@app.command(epilog=example("mcp --no-sim"))
@with_config(*options.EVERY)
def mcp(*, config: AgentConfig, kb: Kb = None, speaker: Speaker = "sam") -> None:
    """Offer tools to a language-model agent on stdin and stdout (Model Context Protocol)."""
    with extra_required("mcp", "mcp"), extra_required("serve", "fastapi"):
        from ..web.mcp_server import make_mcp
        from ..web.service import Service
        from ..web.tokens import Caller

    caller = Caller("owner", speaker, frozenset({"admin"}))
    with open_agent(kb, config) as agent:
        make_mcp(Service(agent), lambda _: caller).run("stdio")


@token_app.command(epilog=example("token add tablet --speaker anna --role teacher --expires 30d"))
def add(
    name: Annotated[str, typer.Argument(help="What the token is for.")],
    *,
    speaker: Annotated[str, typer.Option(help="For whom it speaks.")],
    role: Annotated[list[str], typer.Option(help="reader, teacher, operator, admin; repeated.")],
    expires: Annotated[str | None, typer.Option(help="How long: 30d, 12h, 15m.")] = None,
    kb: Kb = None,
    as_json: AsJson = False,
) -> None:
    """Make a token, which is shown this once; it stands for a speaker and roles."""
    if (found := re.fullmatch(r"(\d{1,5})([dhm])", expires or "0d")) is None:
        raise typer.BadParameter(f'"{expires}" is no duration: expected 30d, 12h or 15m.')
    lasts = timedelta(**{_UNITS[found[2]]: int(found[1])}) if expires else None
    made, secret = _tokens(kb).add(name, speaker, role, lasts)
    announce(made.as_json() | {"token": secret}, secret, as_json=as_json)


@token_app.command("list", epilog=example("token list --json"))
def list_tokens(*, kb: Kb = None, as_json: AsJson = False) -> None:
    """List the tokens: for whom, what they may do, until when, and when they were used."""
    found = _tokens(kb).tokens()
    if as_json:
        print_json([each.as_json() for each in found])
        return
    for each in found:
        ends = f"{each.expires or 'no end'}  {each.used or 'never used'}"
        typer.echo(f"{each.id}  {each.name}  {each.speaker}  {','.join(each.roles)}  {ends}")


@token_app.command(epilog=example("token remove tablet"))
def remove(
    token: Annotated[str, typer.Argument(help="Its id or its name.")],
    *,
    kb: Kb = None,
    as_json: AsJson = False,
) -> None:
    """Remove a token; who uses it is out at once."""
    gone = _tokens(kb).remove(token)
    announce(gone.as_json(), f"Removed {gone.id} ({gone.name}).", as_json=as_json)


def _tokens(kb: str | None) -> "TokenFile":
    with extra_required("serve", "fastapi"):
        from ..web import server
        from ..web.tokens import TokenFile
    return TokenFile(server.tokens_beside(kb or str(default_location())))
