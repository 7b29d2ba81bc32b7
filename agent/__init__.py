"""The composition root: knowledge base, language, inference and robot joined into one agent.

agent      knowledge base, language, inference and body, joined
config     what an agent starts with: scene, robot, language, inference
dialogue   asserts what it is told, carries out what it is asked, answers questions
goal       the predicate of a command; the goal manager executes its action tree
step       one node of that execution, with its four operations
decision   why this object and why this part, with every candidate
reply      the answer to one utterance, with all results
episode    a command and its result, as it is kept in the graph

>>> from hilt.agent import Agent, AgentConfig
>>> with Agent.open("memory:", AgentConfig(simulate=False)) as agent:
...     agent.hear("A knife is used for cutting").said
'I learned: a knife is used for cutting.'
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
