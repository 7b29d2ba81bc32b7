"""A scripted agent that hands over a knife through the tools for language models.

It does what a model would: it plans, is refused by what a person taught, asks for the proper part,
plans again, and has the plan carried out. No model is needed. With `--sim` a simulated robot moves.

    python examples/model_agent.py
"""

import asyncio
import subprocess
import sys
import tempfile
from typing import Any

from mcp import Client, StdioServerParameters

LESSONS = (
    "A knife is used for cutting",
    "To pass a knife, grab it by the blade",
    "To pass a knife, never grab it by the handle",
)
HILT = (sys.executable, "-m", "hilt")


async def main(base: str, robot: str) -> None:
    """Talk to `hilt mcp` over a base."""
    command, *arguments = (*HILT, "mcp", "--kb", base, robot)
    async with Client(StdioServerParameters(command=command, args=arguments)) as hilt:
        (tool,) = await ask(hilt, "what_for", use="cutting")
        plan = await ask(hilt, "plan", command=f"pass me the {tool['object']} by the handle")
        if plan["outcome"] == "refused":
            held = await ask(hilt, "how_to_hold", object=tool["object"], action="pass")
            wanted = f"pass me the {tool['object']} by the {held['part']}"
            plan = await ask(hilt, "plan", command=wanted)
        await ask(hilt, "carry_out", plan=plan["id"])


async def ask(hilt: Client, tool: str, **arguments: str) -> Any:
    """Call a tool, print what was asked and answered, and return its answer."""
    found = (await hilt.call_tool(tool, arguments)).structured_content or {}
    asked = "its plan" if tool == "carry_out" else ", ".join(arguments.values())
    answer = found.get("result", found)
    told = answer.get("said", answer) if isinstance(answer, dict) else answer
    print(f"agent: {tool}({asked})\nhilt:  {told}")
    return answer


if __name__ == "__main__":
    with tempfile.TemporaryDirectory() as folder:
        for lesson in LESSONS:
            tell = [*HILT, "tell", "--kb", f"{folder}/kb", lesson]
            subprocess.run(tell, check=True, capture_output=True)  # noqa: S603 - our own command
        asyncio.run(main(f"{folder}/kb", "--sim" if "--sim" in sys.argv else "--no-sim"))
