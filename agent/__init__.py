"""The composition root: knowledge base, language, inference and robot joined into one agent.

>>> from hilt.agent import Agent, AgentConfig
>>> with Agent.open("memory:", AgentConfig(simulate=False)) as agent:
...     agent.hear("A knife is used for cutting").said
'I learned: a knife is used for cutting.'
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
