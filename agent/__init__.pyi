from .agent import Agent
from .config import AgentConfig
from .dialogue.reply import Reply
from .protocols import Motion, Vision

__all__ = ["Agent", "AgentConfig", "Motion", "Reply", "Vision"]
